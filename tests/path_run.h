/* Scenes run on the nonlinear path, for CMocka programs: a scene that does not open or settle fails the test. */
#ifndef PATH_RUN_H
#define PATH_RUN_H

#include "scene_run.h"

/* Changes of a scene, each ended. */
#define SOURCE "element=source;"
#define CORRECTED "element=corrected;"
#define METRIC_OFF "element={kinematics: cartesian, metric: off};"
#define MESH(n1, n2) "mesh.theta1.elements=" #n1 ";mesh.theta2.elements=" #n2 ";"
#define HALF_TURN "actuators.v.applied=4*0.05^2*(pi/10)/(3*1e-6);"
#define BASE_100 "contact.body={type: cylinder, point: [200.5, 0, 0], axis: [0, 0, 1], radius: 100};"
#define BASE_FLAT "contact.body={type: plane, point: [100.5, 0, 0], normal: [-1, 0, 0]};"

#define COUNT(a) (sizeof(a) / sizeof *(a))

void open_run(scene_run *r, const char *scene, const char *changes);
void solve_run(scene_run *r, const char *scene, const char *changes);

pzs_path *path_of(scene_run *r);
size_t dof_of(const scene_run *r);

double largest(const double *x, size_t n);
/* Largest difference of two vectors over the largest entry of the second; infinite where one entry of x is. */
double apart(const double *x, const double *y, size_t n);

#endif
