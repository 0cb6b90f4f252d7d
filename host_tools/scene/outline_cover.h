/* SPDX-License-Identifier: BSD-2-Clause */
/* Area of an element, or of a part of an element, that the polygons of an electrode cover. */
#ifndef OUTLINE_COVER_H
#define OUTLINE_COVER_H

#include "outline_cell.h"

/* Work memory in which polygons are cut to a cell (element or part of one). */
typedef struct clip_room {
    double (*work)[2], (*out)[2];
} clip_room;

/* Bounding box of the polygons of an electrode in the plane of the outlines. */
polygon_box outline_box(const scene_outline *outline);

/* Area that an electrode covers, measured in the plane of the outlines and on the surface. */
typedef struct outline_area {
    double plane_area, area;
} outline_area;

/* Return the largest number of points of any polygon of an electrode, but at least 4. */
size_t outline_most_points(const scene_outline *outline);

/*
 * Allocate memory for clipping polygons of up to `points` points. Returns 0, or -1 where memory
 * runs out; call clip_room_close in either case.
 */
int clip_room_open(clip_room *room, size_t points);
void clip_room_close(clip_room *room);

/*
 * Return the area of a cell (an element or a part of one) that the polygons of an electrode cover.
 */
outline_area outline_cover(const scene *scene, outline_plane plane, const outline_cell *cell,
                           const scene_outline *outline, clip_room *room);

/*
 * Return the area of all polygons of an electrode in the plane of the outlines, whether they lie on
 * the surface or beside it.
 */
double outline_plane_area(const scene_outline *outline);

#endif
