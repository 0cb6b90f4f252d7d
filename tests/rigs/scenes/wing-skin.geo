// A cambered wing skin of 200 (chord, x) by 400 (span, y) with a round cut-out of diameter 50 and
// eight piezo composite patches of 57 by 56; lengths in mm.
SetFactory("OpenCASCADE");
For i In {0 : 10}
  f = i / 10;
  Point(i + 1) = {200 * f, 0, 64 * f * (1 - f) * (1 - f / 4)};
EndFor
Spline(1) = {1 : 11};
skin() = Extrude {0, 400, 0} { Curve{1}; };
Cylinder(1) = {100, 200, -10, 0, 0, 100, 25};
For k In {0 : 7}
  Box(10 + k) = {15 + 113 * (k % 2), 25 + 91 * Floor(k / 2) + 21 * Floor(k / 4), -10, 57, 56, 100};
EndFor
patches() = {};
For k In {0 : 7}
  patches() += BooleanIntersection{ Surface{skin(1)}; }{ Volume{10 + k}; };
EndFor
rest() = BooleanDifference{ Surface{skin(1)}; Delete; }{ Volume{1, 10 : 17}; Delete; };
BooleanFragments{ Surface{rest(), patches()}; Delete; }{}
For k In {0 : 7}
  Physical Surface(Sprintf("mfc_%g", k + 1)) = {patches(k)};
EndFor
Physical Surface("skin") = {rest()};
root() = Curve In BoundingBox{-1, -0.1, -1, 201, 0.1, 100};
tip() = Curve In BoundingBox{-1, 399.9, -1, 201, 400.1, 100};
Physical Curve("root") = {root()};
Physical Curve("tip") = {tip()};
Mesh.MeshSizeMin = 36;
Mesh.MeshSizeMax = 36;
Mesh.Algorithm = 6;
Mesh.RecombineAll = 1;
Mesh.SubdivisionAlgorithm = 1;
