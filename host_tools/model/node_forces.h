/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Displacements and forces at nodes as linear functions of the free dof of a mesh. A displacement
 * is a weighted sum of the dof of a node; the same weights give the nodal forces of a force there.
 * The functions add these weights or forces to a vector with an entry for each free dof.
 */
#ifndef NODE_FORCES_H
#define NODE_FORCES_H

#include "../mesh/mesh.h"

/* Unit vector of a displacement component, in the local axes of a node. */
void node_direction(const surface_point *point, scene_component component, double unit[3]);

/* Height of a face above the middle surface of a shell of a given thickness. */
double node_face_height(scene_face face, double thickness);

/*
 * Weights of the dof of a node in the displacement of a face along a direction [3]. The first three
 * dof are the mean of both faces' displacements, the next three their difference divided by the
 * thickness. The seventh dof has the weight 0.
 */
void node_face_weights(const mesh *mesh, scene_face face, const double direction[3],
                       double weight[7]);

/*
 * Add weights on the dof of a node, multiplied by a factor, to a dense row over the free dof.
 *   weight [dof_per_node] in      weight of each dof
 *   dense  [free_dof]     in/out  row to which the weights are added
 */
void node_add(const mesh *mesh, int node, double factor, const double *weight, double *dense);

/*
 * Return the sum of the dof of a node, multiplied by weights; constrained dof are 0.
 *   weight       [dof_per_node] in  weight of each dof
 *   displacement [free_dof]     in  displacement of the structure
 */
double node_sum(const mesh *mesh, int node, const double *weight, const double *displacement);

/*
 * Add the nodal forces that prescribed stress resultants of one element cause in the reference
 * state to a vector over the free dof.
 *   h0  [10] in  resultants times the area of the element (N m), in the order of the ten strains
 *       (laminate.h)
 *   dense  [free_dof] in/out  nodal forces of the structure
 */
void node_add_resultants(const mesh *mesh, int element, const double h0[LAMINATE_STRAINS],
                         double *dense);

#endif
