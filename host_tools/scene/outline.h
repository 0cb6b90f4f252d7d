/* SPDX-License-Identifier: BSD-2-Clause */
/* Electrodes of any outline as data: their areas, and the parts of elements that they cover. */
#ifndef OUTLINE_H
#define OUTLINE_H

#include <stddef.h>
#include "expr.h"
#include "scene_error.h"

/* Plane in which the outlines of electrodes are given. */
typedef enum outline_plane {
    OUTLINE_THETA, /* the parameters theta1, theta2 of the surface */
    OUTLINE_XY,
    OUTLINE_XZ,
    OUTLINE_YZ /* two of the coordinates in space: the surface is seen along the third */
} outline_plane;

struct polygon; /* host_tools/data/polygon.h */

/* Area that one electrode covers: one or several polygons, or where a formula is positive. */
typedef struct scene_outline {
    int polygons;
    struct polygon *polygon; /* [polygons] counterclockwise, without an area in common */
    expr *inside;            /* function that is positive on the electrode; NULL: polygons */
    scene_at at;
} scene_outline;

/*
 * Electrodes of any outline on one layer, and the part of the area of each element that each of
 * them covers. An element may belong to several electrodes.
 */
typedef struct scene_outlines {
    int electrodes;
    int columns;              /* electrodes along the second index of a grid; 1: a list */
    scene_outline *electrode; /* [electrodes] in the order of the scene */
    int elements;
    size_t *start;     /* [elements + 1] first entry of each element */
    int *electrode_of; /* [start[elements]] electrode of each entry, ascending */
    double *share;     /* [start[elements]] covered part of the element, above 0 to 1 */
} scene_outlines;

/* Append an electrode without an area. Returns NULL where memory runs out. */
scene_outline *outline_append(scene_outlines *outlines, scene_at at);

/*
 * Append a polygon of a number of points to an electrode. Returns the points, to be filled, or NULL
 * where memory runs out.
 */
double (*outline_polygon(scene_outline *outline, size_t count))[2];

/* Release all electrodes. */
void outlines_free(scene_outlines *outlines);

/*
 * Function that draws a piece of an electrode in an element: an area of three or more points, or a
 * part of the outline between two points.
 *   at [count][2] in  natural coordinates of the element, -1 to 1
 */
typedef void outline_draw(void *context, int element, const double (*at)[2], size_t count);

#endif
