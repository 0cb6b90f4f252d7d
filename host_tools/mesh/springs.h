/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Springs and stack actuators of a scene, each as a sparse row over the free dof that gives its
 * elongation: the displacement of its point along its direction, minus that of its other end.
 * Without a named face, a point moves with the mean of both faces. Distributed springs are lumped
 * at the nodes.
 */
#ifndef SPRINGS_H
#define SPRINGS_H

#include "mesh.h"

/*
 * Compute the unit vector of a direction in space; a direction along an axis of the local triad
 * (e1, e2, normal) is taken at the given surface point.
 */
void springs_direction(const surface_point *point, const scene_direction *direction,
                       double vector[3]);

/*
 * Compute the rotation of a node about an axis as weights of its dof. With the normal D and the
 * difference beta of both faces' displacements over the thickness, the rotation vector is D x beta.
 *   weight  [7] out  weight of each dof of the node
 * Returns 0, or -1 if the axis is normal to the surface: a shell has no rotation about it.
 */
int springs_rotation(const surface_point *point, const scene_direction *axis, double weight[7]);

/*
 * List the springs and stacks of a scene: stiffness, and elongation per unit of each free dof. The
 * dof must be numbered and the element types built. The caller then widens mesh.first_column for
 * the rows. Release the list with mesh_springs_free, also after an error.
 *   springs in/out  in: empty; out: the list
 * Returns 0, or -1 with error filled.
 */
int springs_list(mesh *mesh, mesh_springs *springs, char *error);

/*
 * Return the index of an actuator in the array mesh_springs.first. This array has one entry for
 * each item of the scene's list `springs`, then one for each actuator. An entry is the number of
 * the first spring or stack of its item in the list of all springs and stacks.
 */
int springs_item(const scene *scene, int actuator);

/*
 * Return the elongation (m) of the spring with index `row` in the list of all springs, under the
 * displacements [free_dof].
 */
double springs_elongation(const mesh_springs *springs, int row, const double *displacement);

/*
 * Add the elongation of a spring per unit of each free dof, times a factor, to a vector over the
 * free dof (dense [free_dof] in/out).
 */
void springs_add(const mesh_springs *springs, int row, double factor, double *dense);

#endif
