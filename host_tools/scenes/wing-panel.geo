// A skin panel of a tapered, swept wing with a cut-out and eight bonded patches; lengths in mm.
// gmsh -2 wing-panel.geo -format msh41 -o wing-panel.msh
// Stations along the span (j) and fractions of the chord (i); the cells between them are ruled
// surfaces. The cell in the middle is cut out; eight cells around it carry a patch.
fraction() = {0, 0.12, 0.34, 0.44, 0.56, 0.66, 0.88, 1};
span() = {0, 60, 160, 220, 330, 390, 490, 550};
divisions_i() = {1, 3, 1, 2, 1, 3, 1};
divisions_j() = {2, 3, 2, 4, 2, 3, 2};

For j In {0 : 7}
  For i In {0 : 7}
    chord = 420 - 0.25 * span(j);
    x = 0.35 * span(j) + chord * fraction(i);
    z = 0.32 * chord * fraction(i) * (1 - fraction(i)) * (1 - 0.25 * fraction(i));
    Point(8 * j + i + 1) = {x, span(j), z};
    If (i < 7)
      f = (fraction(i) + fraction(i + 1)) / 2;
      z = 0.32 * chord * f * (1 - f) * (1 - 0.25 * f);
      Point(500 + 8 * j + i) = {0.35 * span(j) + chord * f, span(j), z};
    EndIf
  EndFor
EndFor
For j In {0 : 7}
  l = 100 + 20 * j;
  For i In {0 : 6}
    Spline(l + i) = {8 * j + i + 1, 500 + 8 * j + i, 8 * j + i + 2};
    Transfinite Curve{l + i} = divisions_i(i) + 1;
  EndFor
EndFor
For i In {0 : 7}
  For j In {0 : 6}
    Line(300 + 20 * i + j) = {8 * j + i + 1, 8 * j + i + 9};
    Transfinite Curve{300 + 20 * i + j} = divisions_j(j) + 1;
  EndFor
EndFor
patch = 0;
skin() = {};
For j In {0 : 6}
  For i In {0 : 6}
    If (!(i == 3 && j == 3))
      s = 1000 + 10 * j + i;
      Curve Loop(s) = {100 + 20 * j + i, 300 + 20 * (i + 1) + j, -(120 + 20 * j + i), -(300 + 20 * i + j)};
      Surface(s) = {s};
      Transfinite Surface{s};
      skin() += s;
      If ((i == 1 || i == 5) && (j == 1 || j == 5))
        patch += 1;
        Physical Surface(Sprintf("mfc_%g", patch)) = {s};
      EndIf
      If ((i == 1 || i == 5) && j == 3)
        patch += 1;
        Physical Surface(Sprintf("mfc_%g", patch)) = {s};
      EndIf
      If (i == 3 && (j == 1 || j == 5))
        patch += 1;
        Physical Surface(Sprintf("mfc_%g", patch)) = {s};
      EndIf
    EndIf
  EndFor
EndFor
Physical Surface("skin") = skin();
root() = {100 : 106};
Physical Curve("root") = root();
tip() = {240 : 246};
Physical Curve("tip") = tip();
Physical Curve("hole") = {163, 183, 363, 383};
Mesh.RecombineAll = 1;
