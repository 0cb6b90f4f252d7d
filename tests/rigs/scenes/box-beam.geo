// A thin-walled box beam, open at its ends; its walls near the root are sets
// of their own, for patches; lengths in mm.
Point(1) = {0, -15, -25}; Point(2) = {0, 15, -25}; Point(3) = {0, 15, 25}; Point(4) = {0, -15, 25};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Transfinite Curve{1, 3} = 4; Transfinite Curve{2, 4} = 6;
near() = Extrude {200, 0, 0} { Curve{1 : 4}; Layers{8}; Recombine; };
far() = Extrude {300, 0, 0} { Curve{near(0), near(4), near(8), near(12)}; Layers{12}; Recombine; };
For k In {0 : 3}
  Physical Surface(Sprintf("near_%g", k + 1)) = {near(4 * k + 1)};
EndFor
Physical Surface("wall") = {near(1), near(5), near(9), near(13), far(1), far(5), far(9), far(13)};
Physical Curve("root") = {1 : 4};
Physical Curve("tip") = {far(0), far(4), far(8), far(12)};
