// An octant of a sphere of radius 10.
Point(1) = {0, 0, 0}; Point(2) = {10, 0, 0}; Point(3) = {0, 10, 0}; Point(4) = {0, 0, 10};
Circle(1) = {2, 1, 3}; Circle(2) = {3, 1, 4}; Circle(3) = {4, 1, 2};
Curve Loop(1) = {1, 2, 3};
Surface(1) = {1} In Sphere {1};
Physical Curve("rim") = {1}; Physical Curve("plane_x") = {2}; Physical Curve("plane_y") = {3};
Physical Point("pole") = {4}; Physical Point("pull") = {2}; Physical Point("push") = {3};
Physical Surface("shell") = {1};
Mesh.MeshSizeMin = 2.4; Mesh.MeshSizeMax = 2.4;
Mesh.Algorithm = 6; Mesh.RecombineAll = 1; Mesh.SubdivisionAlgorithm = 1;
