// An off-axis dish: the paraboloid z = r^2/(4 f) above the disc of radius 150 around x = 300, with
// 19 round actuators on its back, on a grid of triangles of pitch 58; lengths in mm.
SetFactory("OpenCASCADE");
f = 500;
For i In {0 : 10}
  r = 50 * i;
  Point(i + 1) = {r, 0, r * r / (4 * f)};
EndFor
Spline(1) = {1 : 11};
turned() = Extrude {{0, 0, 1}, {0, 0, 0}, 2 * Pi} { Curve{1}; };
Cylinder(1) = {300, 0, -10, 0, 0, 300, 150};
dish() = BooleanIntersection{ Surface{turned(1)}; Delete; }{ Volume{1}; Delete; };
n = 0;
For j In {-2 : 2}
  For i In {-2 : 2}
    If (i + j >= -2 && i + j <= 2)
      Cylinder(10 + n) = {300 + 58 * (i + j / 2), 58 * j * Sqrt(3) / 2, -10, 0, 0, 300, 20};
      n += 1;
    EndIf
  EndFor
EndFor
patches() = {};
For k In {0 : n - 1}
  patches() += BooleanIntersection{ Surface{dish()}; }{ Volume{10 + k}; };
EndFor
rest() = BooleanDifference{ Surface{dish()}; Delete; }{ Volume{10 : 9 + n}; Delete; };
BooleanFragments{ Surface{rest(), patches()}; Delete; }{}
For k In {0 : n - 1}
  Physical Surface(Sprintf("disc_%g", k + 1)) = {patches(k)};
EndFor
Physical Surface("dish") = {rest()};
rim() = CombinedBoundary{ Surface{rest(), patches()}; };
Physical Curve("rim") = {rim()};
Mesh.MeshSizeMin = 26;
Mesh.MeshSizeMax = 26;
Mesh.Algorithm = 6;
Mesh.RecombineAll = 1;
Mesh.SubdivisionAlgorithm = 1;
