/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Strains of elements at their centres, and strains at nodes as outputs of a scene. The strain at a
 * node is the mean over the elements at the node in which the layer of the output is present,
 * weighted with the areas of the elements.
 */
#ifndef STRAIN_H
#define STRAIN_H

#include <stdbool.h>
#include "../mesh/mesh.h"

/*
 * Numbers that describe the strains of an element at its centre: mean and difference of both faces
 * for the strains 11, 22, 33 and 12; the strains 13 and 23 (dimensionless); then the parts of the
 * strains 11, 22 and 12 that are quadratic in the height (1/m2).
 */
enum { STRAIN_QUADRATIC = 10, STRAIN_COUNT = 13 };

/*
 * Compute the strains at the centre of an element from the displacements of its nodes.
 *   displacement [4 dof_per_node] in  displacements of the four nodes of the element
 *   is_nonlinear in   true: Green's strains, quadratic in the displacement; false: their linear
 *       part
 *   strain [13]  out  mean and difference of both faces for the strains 11, 22, 33 and 12; strains
 *       13 and 23; coefficients of the squared height in the strains 11, 22 and 12 (1/m2). The
 *       linear part of these coefficients follows from the matrices in laminate_heights
 */
void strain_of_element(const mesh *mesh, int element, const double *displacement, bool is_nonlinear,
                       double strain[STRAIN_COUNT]);

/*
 * Compute the strains of an element at height z above the reference surface in the shell axes,
 * without transverse shear (Voigt order 11 22 33 23 13 12).
 *   strain [13] in   strains of the element, in the order of STRAIN_COUNT
 *   at_z   [6]  out  engineering strains
 */
void strain_at_height(const mesh *mesh, int element, const double strain[STRAIN_COUNT], double z,
                      double at_z[6]);

/*
 * Components of a stress, or of a strain, in axes that are turned by an angle (rad) about axis 3.
 * strain_turn_stress is for stresses, strain_turn for strains with engineering shears.
 *   stress, strain [6] in   components in the original axes, in the order 11 22 33 23 13 12
 *   turned         [6] out  components in the turned axes; may be the same array
 */
void strain_turn_stress(const double stress[6], double angle, double turned[6]);
void strain_turn(const double strain[6], double angle, double turned[6]);

/*
 * Return the strain that an output of the scene measures in an element: the strain component of the
 * output, at the height of the output, in axes turned by the angle of the output.
 *   strain [13] in  strains of the element from strain_of_element
 */
double strain_of_output(const mesh *mesh, const scene_output *output, int element,
                        const double strain[STRAIN_COUNT]);

/*
 * Return whether an element contributes to an output that is a strain or stress at a node. The node
 * must be a corner of the element, and the layer of the output must be present in the element.
 */
bool strain_is_in(const mesh *mesh, const scene_output *output, int element, int node);

/*
 * Return the total area of the elements that contribute to an output that is a strain or stress at
 * a node (m2).
 */
double strain_area(const mesh *mesh, const scene_output *output, int node);

/*
 * Add the strain that an output of the scene has at a node to a linear function of the
 * displacements: the strain per unit of each free dof is added to dense [free_dof].
 */
void strain_row(const mesh *mesh, const scene_output *output, int node, double *dense);

/*
 * Check that at least one element at a node contains the layer whose strain or stress an output of
 * the scene measures there. Returns 0, or -1 with a message in `error`.
 */
int strain_check(const mesh *mesh, const scene_output *output, int node, char *error);

#endif
