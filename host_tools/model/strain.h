/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Strains of elements at their centres, and strains at nodes as outputs of a scene: the mean over
 * those elements at a node in which the layer is present, weighted with their areas.
 */
#ifndef STRAIN_H
#define STRAIN_H

#include <stdbool.h>
#include "../mesh/mesh.h"

/*
 * Compute the strains of the constant mode 00 of an element at a displacement of its nodes.
 *   displacement [4 dof_per_node] in
 *   strain       [10]             out  in the order of pzs_element_type.d
 * The strains are quadratic in the displacement. Linear strains are half the difference of the
 * strains at a small multiple of the displacement and at its negative.
 */
void strain_of_element(const mesh *mesh, int element, const double *displacement, bool is_nonlinear,
                       double strain[10]);

/*
 * Compute the components of a stress in axes that are turned about axis 3 by an angle (rad) against
 * the axes of the given components (Voigt order 11 22 33 23 13 12). strain_turn does this for
 * engineering strains.
 */
void strain_turn_stress(const double stress[6], double angle, double turned[6]);
void strain_turn(const double strain[6], double angle, double turned[6]);

/*
 * Return the strain of an output, along the direction of its angle, in an element that has the
 * given ten strains (strain [10] in).
 */
double strain_of_output(const mesh *mesh, const scene_output *output, int element,
                        const double strain[10]);

/*
 * Return whether an output of a strain or stress at a node takes its value from an element: the
 * node is a corner of the element, and the layer of the output is present in the element.
 */
bool strain_is_in(const mesh *mesh, const scene_output *output, int element, int node);

/*
 * Return the sum of the areas of the elements from which an output at a node takes its value (m2).
 */
double strain_area(const mesh *mesh, const scene_output *output, int node);

/*
 * Add the strain of an output at a node, as a linear function of the dof, to a dense row
 * [free_dof].
 */
void strain_row(const mesh *mesh, const scene_output *output, int node, double *dense);

/*
 * Check that the layer of an output is present in an element at a node. Returns 0, or -1 with error
 * filled.
 */
int strain_check(const mesh *mesh, const scene_output *output, int node, char *error);

#endif
