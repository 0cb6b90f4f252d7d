/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Places at which a deformed shell bends most sharply within an element, and turns furthest from
 * its undeformed normal.
 */
#ifndef LARGEST_TURN_H
#define LARGEST_TURN_H

#include "../mesh/mesh.h"

/*
 * Return the largest change of the angle between the lines through the thickness at both ends of an
 * element's side (degrees). Above about 15 degrees at a moving sharp fold, the mesh adds limit
 * points that the shell does not have.
 *   displacement [free_dof] in   displacement vector of the structure
 *   element                 out  index of the element with that side
 */
double largest_turn(const mesh *mesh, const double *displacement, int *element);

/*
 * Return the largest angle between the line through the thickness of the deformed shell and the
 * normal of the undeformed shell (degrees). At 90 degrees the seventh dof, along this normal, has
 * no stiffness left.
 *   displacement [free_dof] in   displacement vector of the structure
 *   node                    out  index of the node with that angle
 */
double largest_tilt(const mesh *mesh, const double *displacement, int *node);

#endif
