/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Polygons of a plane: their areas, their parts inside quadrilaterals, and the area that two of
 * them have in common. An area is positive where the points run counterclockwise.
 */
#ifndef POLYGON_H
#define POLYGON_H

#include <stdbool.h>
#include <stddef.h>

typedef struct polygon {
    size_t count;       /* number of points */
    double (*point)[2]; /* [count] */
} polygon;

/* Smallest rectangle along the axes that contains a polygon. */
typedef struct polygon_box {
    double low[2], high[2];
} polygon_box;

/* Integrals of 1 and of the distances from an origin over a polygon. */
typedef struct polygon_sums {
    double area, moment[2];
} polygon_sums;

/* What makes a list of points unfit as the outline of an area. */
typedef enum polygon_fault {
    POLYGON_GOOD,
    POLYGON_FEW,      /* fewer than three points */
    POLYGON_INFINITE, /* a coordinate is not a finite number */
    POLYGON_REPEATED, /* two neighbouring points are equal */
    POLYGON_CROSSED,  /* two sides cross or touch each other */
    POLYGON_FLAT      /* the area is 0 */
} polygon_fault;

/* Number of points that polygon_clip needs for its results. */
#define POLYGON_ROOM(count) (6 * (count) + 16)

polygon_sums polygon_sums_of(const double (*point)[2], size_t count, const double origin[2]);
polygon_box polygon_box_of(const double (*point)[2], size_t count);

/* Whether two boxes have an area in common. */
bool polygon_boxes_meet(const polygon_box *one, const polygon_box *other);

/*
 * Part of a polygon inside a convex quadrilateral, by Sutherland and Hodgman's method.
 *   point [count]               in   any simple polygon
 *   quad                        in   corners counterclockwise
 *   work [POLYGON_ROOM(count)]  work
 *   out [POLYGON_ROOM(count)]   out  where the part has several pieces they are joined by sides
 *                                    that run to and fro and enclose no area
 * Returns the number of points of the part; 0: nothing lies inside.
 */
size_t polygon_clip(const double (*point)[2], size_t count, const double (*quad)[2],
                    double (*work)[2], double (*out)[2]);

/* Area that two counterclockwise polygons have in common; NAN where memory runs out. */
double polygon_common_area(const polygon *one, const polygon *other);

/*
 * Check an outline that a user has given.
 *   at [2] out  numbers, from 1, of the points or of the first points of the sides at fault
 */
polygon_fault polygon_check(const double (*point)[2], size_t count, size_t at[2]);

#endif
