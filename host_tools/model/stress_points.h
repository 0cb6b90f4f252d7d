/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Values at nodes from values of elements: the value at an averaging point is the mean over its
 * elements, weighted with their areas. A node has several points where plies or voltages of its
 * elements differ or a fold separates them, such as one for each side of a patch's border.
 */
#ifndef STRESS_POINTS_H
#define STRESS_POINTS_H

#include "stress_field.h"

typedef struct stress_points {
    int count; /* number of averaging points (groups of elements at a node whose values are
                  averaged): at least one for each node of the mesh that has elements */
    int *node; /* [count] number of the node of each averaging point (group of elements at a node
                  whose values are averaged) */
    int (*corner)[4]; /* [elements] numbers of the averaging points (groups of elements at a node
                         whose values are averaged) at the four corners of each element */
    double *area; /* [count] total area of the elements of each averaging point, a group of elements
                     at a node whose values are averaged (m2) */
} stress_points;

/*
 * Find the averaging points (groups of elements at a node whose values are averaged) at the corners
 * of all elements. Returns 0, or -1 if memory runs out; the memory of the points must be freed in
 * both cases.
 */
int stress_points_make(stress_points *points, const stress_field *field);
void stress_points_free(stress_points *points);

/*
 * Average the values of the elements of each averaging point (group of elements at a node),
 * weighted with the areas of the elements.
 *   of_element [elements][components] in   values of the elements
 *   of_point   [count][components]    out  averages at the averaging points
 */
void stress_points_average(const stress_points *points, const stress_field *field,
                           const double *of_element, int components, double *of_point);

#endif
