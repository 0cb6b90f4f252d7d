/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Areas that belong to scattered points. With these areas as weights, a sum over the points
 * approximates an integral over the area that they cover.
 */
#ifndef POINT_AREA_H
#define POINT_AREA_H

#include <stddef.h>

/*
 * Compute the area of each point's Voronoi cell in the convex hull of all points, seen along z. On
 * a rectangular grid it is a grid cell for inner points, half at the border, a quarter at corners.
 * For points on a line it is a length. Points at the same place share their area.
 *   place  [count][3] in   coordinates x, y, z
 *   area   [count]    out  area that belongs to each point
 * Returns 0, or -1 when memory runs out.
 */
int point_areas(size_t count, double (*place)[3], double *area);

#endif
