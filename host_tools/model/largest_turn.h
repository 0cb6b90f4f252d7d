/* SPDX-License-Identifier: BSD-2-Clause */
/* Place at which a deformed shell bends most sharply within an element. */
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

#endif
