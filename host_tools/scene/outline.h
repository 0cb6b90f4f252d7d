/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Electrodes of any outline as data: the areas that they cover on the surface, and the part of each
 * element that each electrode covers.
 */
#ifndef OUTLINE_H
#define OUTLINE_H

#include <stddef.h>
#include "expr.h"
#include "scene_error.h"

/* Plane in which the corners and lengths of the outlines of electrodes are given. */
typedef enum outline_plane {
    OUTLINE_THETA, /* outlines of electrodes are given in the surface parameters theta1 and theta2
                    */
    OUTLINE_XY,
    OUTLINE_XZ,
    OUTLINE_YZ /* outlines are given in a plane of two coordinates in space (x and y, x and z, or y
                  and z), on which the surface is projected along the third coordinate */
} outline_plane;

struct polygon; /* The C struct `polygon`, a list of points, is declared in
                   host_tools/data/polygon.h. */

/*
 * Area that one electrode covers: one or several polygons, or all points at which a formula is
 * positive.
 */
typedef struct scene_outline {
    int polygons;
    struct polygon *polygon; /* [polygons] counterclockwise polygons that an electrode covers, no
                                two of which overlap */
    expr *inside; /* formula that is positive on the electrode; NULL: the electrode is given by
                     polygons */
    double low[2], high[2]; /* bounding box of the polygons of an electrode in the plane of the
                               outlines */
    scene_at at;
} scene_outline;

/*
 * Electrodes of any outline on one layer, and the area fraction of each element that each of them
 * covers. There is an entry for each pair of an electrode and an element that it covers in full or
 * in part. The entries are sorted by elements.
 */
typedef struct scene_outlines {
    int electrodes;
    int columns; /* number of electrodes along the second index j of a grid of electrodes, which
                    runs fastest. An electrode of a grid is named after its patches, with _i_j
                    appended. 1 for electrodes with a single index _i */
    scene_outline *electrode; /* [electrodes] outline of each electrode, in the order of the scene
                               */
    int elements;
    size_t *start; /* [elements + 1] index, in electrode_of and share, of the first entry of each
                      element; the last number is the count of all entries */
    int *electrode_of; /* [entries] one entry for each pair of an element and an electrode that
                          covers a part of it: index of the electrode. The entries of an element are
                          consecutive and in ascending order of the electrodes */
    double *share; /* [entries] one entry for each pair of an element and an electrode that covers a
                      part of it: area that the electrode covers, divided by the area of the
                      element; above 0 and at most 1 */
} scene_outlines;

/*
 * Append an electrode to a list of electrodes. It covers nothing until polygons or a formula are
 * added. Returns the electrode, or NULL where memory runs out.
 */
scene_outline *outline_append(scene_outlines *outlines, scene_at at);

/*
 * Append a polygon with `count` points to the area that an electrode covers. Returns the points,
 * which the caller fills in, or NULL where memory runs out.
 */
double (*outline_polygon(scene_outline *outline, size_t count))[2];

/* Compute the bounding boxes of all electrodes, after their polygons have been filled in. */
void outlines_find_boxes(scene_outlines *outlines);

/* Release a list of electrodes, which may be NULL. */
void outlines_free(scene_outlines *outlines);

/*
 * Function that draws one piece of an electrode in an element: an area with three or more corners,
 * or a line between two points of the outline.
 *   at  [count][2] in  natural coordinates of the element, from -1 to 1
 */
typedef void outline_draw(void *context, int element, const double (*at)[2], size_t count);

#endif
