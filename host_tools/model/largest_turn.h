/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Places at which a deformed shell bends most sharply within an element, and turns furthest from
 * its undeformed normal.
 */
#ifndef LARGEST_TURN_H
#define LARGEST_TURN_H

#include "../mesh/mesh.h"

/*
 * Largest change, over the sides of all elements, of the angle between the lines through the
 * thickness at the two nodes of a side (degrees). Where a sharp fold moves through elements that
 * turn by more than about 15 degrees, the mesh adds limit points that the shell does not have.
 *   displacement [free_dof] in   displacement vector of the structure
 *   element                 out  index of the element with that side
 */
double largest_turn(const mesh *mesh, const double *displacement, int *element);

/*
 * Largest angle, over all nodes, between the line through the thickness of the deformed shell and
 * the normal of the undeformed shell (degrees). The seventh degree of freedom of a node acts along
 * this normal, and has no stiffness left where the angle is 90 degrees.
 *   displacement [free_dof] in   displacement vector of the structure
 *   node                    out  index of the node with that angle
 */
double largest_tilt(const mesh *mesh, const double *displacement, int *node);

#endif
