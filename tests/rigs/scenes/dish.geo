// An off-axis dish: the paraboloid z = r^2/(4 f) above the disc of radius 150 around x = 300, with
// seven round actuators on its back; lengths in mm.
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
For k In {0 : 6}
  x = 300; y = 0;
  If (k > 0)
    x = 300 + 90 * Cos(k * Pi / 3); y = 90 * Sin(k * Pi / 3);
  EndIf
  Cylinder(10 + k) = {x, y, -10, 0, 0, 300, 30};
EndFor
patches() = {};
For k In {0 : 6}
  patches() += BooleanIntersection{ Surface{dish()}; }{ Volume{10 + k}; };
EndFor
rest() = BooleanDifference{ Surface{dish()}; Delete; }{ Volume{10 : 16}; Delete; };
BooleanFragments{ Surface{rest(), patches()}; Delete; }{}
For k In {0 : 6}
  Physical Surface(Sprintf("disc_%g", k + 1)) = {patches(k)};
EndFor
Physical Surface("dish") = {rest()};
rim() = CombinedBoundary{ Surface{rest(), patches()}; };
Physical Curve("rim") = {rim()};
Mesh.MeshSizeMin = 40;
Mesh.MeshSizeMax = 40;
Mesh.Algorithm = 6;
Mesh.RecombineAll = 1;
Mesh.SubdivisionAlgorithm = 1;
