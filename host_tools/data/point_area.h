/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Areas that belong to scattered points. With these areas as weights, a sum over the points
 * approximates an integral over the area that they cover.
 */
#ifndef POINT_AREA_H
#define POINT_AREA_H

#include <stddef.h>

/*
 * Compute the area of each point's Voronoi cell: the part of the convex hull, seen along z, that is
 * nearer to this point than to any other. On a rectangular grid with its border, inner points have
 * the area of a grid cell, points on the border half of it and corners a quarter of it. If all
 * points lie on a line, the area is a length instead. Points at the same place share their area.
 *   place  [count][3] in  coordinates x, y, z
 *   area   [count] out  area that belongs to each point
 * Returns 0, or -1 when memory runs out.
 */
int point_areas(size_t count, double (*place)[3], double *area);

#endif
