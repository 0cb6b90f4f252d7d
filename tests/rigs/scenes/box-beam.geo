// A thin-walled box beam, open at its ends; lengths in mm.
Point(1) = {0, -15, -25}; Point(2) = {0, 15, -25}; Point(3) = {0, 15, 25}; Point(4) = {0, -15, 25};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Transfinite Curve{1, 3} = 4; Transfinite Curve{2, 4} = 6;
beam() = Extrude {500, 0, 0} { Curve{1 : 4}; Layers{20}; Recombine; };
Physical Surface("wall") = {beam(1), beam(5), beam(9), beam(13)};
Physical Curve("root") = {1 : 4};
Physical Curve("tip") = {beam(0), beam(4), beam(8), beam(12)};
