/* SPDX-License-Identifier: BSD-2-Clause */
/* Areas that belong to scattered points: the weights of an integral over the points. */
#ifndef POINT_AREA_H
#define POINT_AREA_H

#include <stddef.h>

/*
 * Area of the part of the convex hull of the points, seen along z, that is nearer to each point
 * than to any other (its Voronoi cell). On a rectangular grid with its border, inner points have
 * the area of a cell of the grid, points of the border half and corners a quarter of it. Where all
 * points lie on a line, `area` is the length instead. Points at the same place share their area.
 *   place [count][3]  in   x, y, z
 *   area [count]      out
 * Returns 0, or -1 where memory runs out.
 */
int point_areas(size_t count, double (*place)[3], double *area);

#endif
