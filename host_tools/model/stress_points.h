/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Values at nodes from values of elements. Each node has one or more averaging points. The value at
 * a point is the mean over the elements of the point, weighted with their areas. Elements at the
 * same node belong to different points if their plies or voltages differ or a fold separates them,
 * so that a node on the border of a patch has a point for each side.
 */
#ifndef STRESS_POINTS_H
#define STRESS_POINTS_H

#include "stress_field.h"

typedef struct stress_points {
    int count;        /* number of averaging points: at least one for each node of the mesh that has
                         elements */
    int *node;        /* [count] number of the node of each averaging point */
    int (*corner)[4]; /* [elements] numbers of the averaging points at the four corners of each
                         element */
    double *area;     /* [count] total area of the elements of each averaging point (m2) */
} stress_points;

/*
 * Find the averaging points at the corners of all elements. Returns 0, or -1 if memory runs out;
 * the memory of the points must be freed in both cases.
 */
int stress_points_make(stress_points *points, const stress_field *field);
void stress_points_free(stress_points *points);

/*
 * Average values of elements at the averaging points, weighted with the areas of the elements.
 *   of_element [elements][components] in   values of the elements
 *   of_point   [count][components]    out  values at the points
 */
void stress_points_average(const stress_points *points, const stress_field *field,
                           const double *of_element, int components, double *of_point);

#endif
