// A clamped disc with 37 hexagonal electrodes; lengths in mm.
// gmsh -2 hex-mirror.geo -format msh41 -o hex-mirror.msh
radius = 30; // of the disc
side = 4.2;  // of a hexagon
parts = 2;   // elements on a side of each third of a hexagon

hexagon() = {};
thirds() = {};
For q In {-3 : 3}
  For r In {-3 : 3}
    If (Fabs(q + r) <= 3)
      x = side * Sqrt(3) * (q + r / 2);
      y = side * 1.5 * r;
      p = newp;
      Point(p) = {x, y, 0};
      For i In {0 : 5}
        Point(p + 1 + i) = {x + side * Sin(i * Pi / 3), y + side * Cos(i * Pi / 3), 0};
      EndFor
      l = newl;
      For i In {0 : 5}
        Line(l + i) = {p + 1 + i, p + 1 + (i + 1) % 6};
      EndFor
      For i In {0 : 2}
        Line(l + 6 + i) = {p, p + 1 + 2 * i};
      EndFor
      s = news;
      For i In {0 : 2}
        Curve Loop(s + i) = {l + 6 + i, l + 2 * i, l + 2 * i + 1, -(l + 6 + (i + 1) % 3)};
        Plane Surface(s + i) = {s + i};
        thirds() += s + i;
      EndFor
      hexagon() += s;
    EndIf
  EndFor
EndFor
Coherence;
For k In {0 : #hexagon() - 1}
  s = hexagon(k);
  Physical Surface(Sprintf("hex_%g", k + 1)) = {s, s + 1, s + 2};
EndFor
Physical Surface("hexagons") = thirds();
Transfinite Curve{:} = parts + 1;
Transfinite Surface{:};

inner() = Abs(CombinedBoundary{ Surface{thirds()}; });
c = newp;
Point(c) = {0, 0, 0};
For i In {0 : 3}
  Point(c + 1 + i) = {radius * Cos(i * Pi / 2), radius * Sin(i * Pi / 2), 0};
EndFor
l = newl;
For i In {0 : 3}
  Circle(l + i) = {c + 1 + i, c, c + 1 + (i + 1) % 4};
EndFor
Curve Loop(l + 10) = {l : l + 3};
Curve Loop(l + 11) = inner();
Plane Surface(l + 12) = {l + 10, l + 11};
Physical Surface("border") = {l + 12};
Physical Curve("rim") = {l : l + 3};

Mesh.MeshSizeMax = 1.6 * side / parts;
Mesh.Algorithm = 6;
Mesh.RecombineAll = 1;
Mesh.RecombinationAlgorithm = 1;
