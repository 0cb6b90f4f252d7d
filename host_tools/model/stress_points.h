/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Values at nodes from values of elements: the mean of the elements at a node, weighted with their
 * areas. Elements with other plies or other voltages, and those beyond a fold, are averaged
 * separately, so that a node on the border of a patch has a point for each side.
 */
#ifndef STRESS_POINTS_H
#define STRESS_POINTS_H

#include "stress_field.h"

typedef struct stress_points {
    int count;        /* number of points, at least that of the nodes of the elements */
    int *node;        /* [count] node of each point */
    int (*corner)[4]; /* [elements] points of the four corners of each element */
    double *area;     /* [count] sum of the areas of the elements of each point (m2) */
} stress_points;

/*
 * Find the points of all elements. Returns 0, or -1 if memory runs out; the points must be freed in
 * both cases.
 */
int stress_points_make(stress_points *points, const stress_field *field);
void stress_points_free(stress_points *points);

/*
 * Average values of elements at the points, weighted with the areas of the elements.
 *   of_element [elements][components] in
 *   of_point   [count][components]    out
 */
void stress_points_average(const stress_points *points, const stress_field *field,
                           const double *of_element, int components, double *of_point);

#endif
