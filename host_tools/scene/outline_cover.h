/* SPDX-License-Identifier: BSD-2-Clause */
/* Area of an element, or of a part of one, that the polygons of an electrode cover. */
#ifndef OUTLINE_COVER_H
#define OUTLINE_COVER_H

#include "outline_cell.h"

/* Memory for clipping polygons. */
typedef struct clip_room {
    double (*work)[2], (*out)[2];
} clip_room;

/* Area in the plane of the outlines, and area of the surface. */
typedef struct outline_area {
    double plane_area, area;
} outline_area;

/* Most points of a polygon of an electrode, at least 4. */
size_t outline_most_points(const scene_outline *outline);

/* Allocate memory for polygons of a number of points. Returns 0, or -1: close it in either case. */
int clip_room_open(clip_room *room, size_t points);
void clip_room_close(clip_room *room);

/* Area that the polygons of an electrode cover in a cell. */
outline_area outline_cover(const scene *scene, outline_plane plane, const outline_cell *cell,
                           const scene_outline *outline, clip_room *room);

/* Area of all polygons of an electrode in the plane, on the surface or beside it. */
double outline_plane_area(const scene_outline *outline);

#endif
