/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Corner tables of an element type (members of pzs_element_type).
 *   s, t            3 x 3 matrices: the derivative of the displacement along one direction of the
 *       element at a corner is s times the displacement of the corner plus t times that of its
 *       neighbour
 *   g_mean, g_diff  base vectors; their products with the derivative are the strains at the corner:
 *       mean of both faces, and difference between them
 */
#ifndef CORNER_TABLES_H
#define CORNER_TABLES_H

#include <stdbool.h>
#include "pzs.h"
#include "../scene/surface.h"

/*
 * Geometry of an element from which its corner tables are computed: the matrices and base vectors
 * that map the displacements of the four corners to the strains there.
 */
typedef struct corner_data {
    const surface_point *point[4]; /* surface points of the corners, in the order (-,-) (+,-) (+,+)
                                      (-,+) of the signs of xi1 and xi2 */
    bool is_cartesian; /* true: strains are computed from differences of displacement vectors
                          between corners; false: from derivatives of components in local axes that
                          turn with the surface */
    double range[2];   /* ranges of the surface coordinates theta1 and theta2 in the element (m or
                          rad); not used if is_cartesian is true */
    double length[2];  /* lengths by which differences of displacements along the directions 1 and 2
                          of the element are divided (m); 0: the straight distance between the
                          corners of each edge */
    double middle; /* height of the middle of the laminate above the reference surface of the shell
                      (m) */
} corner_data;

/*
 * Compute the members s, t, g_mean and g_diff of an element type, the corner tables: matrices and
 * base vectors that map the displacements of the four corners to the strains there. The other
 * members of the element type keep their values.
 */
void corner_tables_fill(const corner_data *data, pzs_element_type *type);

#endif
