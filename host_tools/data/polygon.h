/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Polygons in a plane: their areas, their parts inside quadrilaterals, and the area of the
 * intersection of two polygons. Areas are positive if the points run counterclockwise.
 */
#ifndef POLYGON_H
#define POLYGON_H

#include <stdbool.h>
#include <stddef.h>

typedef struct polygon {
    size_t count;       /* number of points of the polygon */
    double (*point)[2]; /* [count] coordinates x, y of the points */
} polygon;

/* Bounding box of a polygon: the smallest rectangle along the axes that contains it. */
typedef struct polygon_box {
    double low[2], high[2];
} polygon_box;

/*
 * Integrals over a polygon: of 1 (its area), and of both coordinates relative to an origin (first
 * moments).
 */
typedef struct polygon_sums {
    double area, moment[2];
} polygon_sums;

/* Faults that make a list of points unfit as the outline of an area. */
typedef enum polygon_fault {
    POLYGON_GOOD,
    POLYGON_FEW,      /* fault of an outline: it has fewer than three points */
    POLYGON_INFINITE, /* fault of an outline: a coordinate of the outline is not a finite number */
    POLYGON_REPEATED, /* fault of an outline: two neighbouring points of the outline are equal */
    POLYGON_CROSSED,  /* fault of an outline: two sides of the outline cross or touch each other */
    POLYGON_FLAT      /* fault of an outline: the area that the outline encloses is 0 */
} polygon_fault;

/*
 * Number of points that the arrays of a caller of polygon_clip must hold if the clipped polygon has
 * `count` points.
 */
#define POLYGON_ROOM(count) (6 * (count) + 16)

polygon_sums polygon_sums_of(const double (*point)[2], size_t count, const double origin[2]);
polygon_box polygon_box_of(const double (*point)[2], size_t count);

/* Return whether two bounding boxes overlap. */
bool polygon_boxes_meet(const polygon_box *one, const polygon_box *other);

/*
 * Compute the part of a polygon inside a convex quadrilateral (Sutherland-Hodgman algorithm).
 *   point  [count] in                 any simple polygon
 *   quad   [4] in                     corners, counterclockwise
 *   work   [POLYGON_ROOM(count)] out  work array
 *   out    [POLYGON_ROOM(count)] out  the part; sides that enclose no area join several pieces
 * Returns the number of points of the part; 0: no area lies inside.
 */
size_t polygon_clip(const double (*point)[2], size_t count, const double (*quad)[2],
                    double (*work)[2], double (*out)[2]);

/*
 * Return the area of the intersection of two counterclockwise polygons, or NAN when memory runs
 * out.
 */
double polygon_common_area(const polygon *one, const polygon *other);

/*
 * Check an outline that a user has given.
 *   at  [2] out  numbers, counted from 1, of the points (or of the first points of the sides) that
 *                are at fault
 * Returns the fault that was found first.
 */
polygon_fault polygon_check(const double (*point)[2], size_t count, size_t at[2]);

#endif
