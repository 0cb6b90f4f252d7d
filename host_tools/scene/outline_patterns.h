/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Outlines of electrodes as polygons: circles and patterns of cells. In a pattern the cells touch
 * each other, and each electrode is its cell with all sides moved inwards by half the gap.
 *
 * An arc is a polygon with 720 sides or more on the full circle, with corners moved outwards so
 * that its area is that of the circle; its sides leave the circle by 5e-6 of the radius at most.
 */
#ifndef OUTLINE_PATTERNS_H
#define OUTLINE_PATTERNS_H

#include "outline.h"

/* Largest numbers of rings of a pattern, of cells in one direction, and of electrodes. */
enum { OUTLINE_RINGS = 64, OUTLINE_CELLS = 1000, OUTLINE_MOST = 4096 };

/*
 * A hexagon in the middle and rings of hexagons around it. The first electrode is the middle; then
 * follow the rings from the inside, each from the direction `angle` counterclockwise.
 */
typedef struct hexagon_pattern {
    double centre[2];
    double pitch; /* distance of the centres of neighbours, and of opposite sides of a cell */
    double gap;   /* distance of neighbouring electrodes */
    double angle; /* direction from the middle to the first hexagon of ring 1 (degrees) */
    int rings;
} hexagon_pattern;

/* A rectangle divided into equal cells; the second index runs fastest. */
typedef struct grid_pattern {
    double from[2], to[2]; /* opposite corners */
    double gap, angle;     /* angle: turn of the rectangle about its middle (degrees) */
    int count[2];          /* cells along the first and the second coordinate */
} grid_pattern;

/*
 * Rings divided into sectors of equal angle, in the shape of keystones. The electrodes are numbered
 * from the inside, in each ring from the direction `angle` counterclockwise.
 */
typedef struct ring_pattern {
    double centre[2], gap, angle;
    int rings;
    double radius[OUTLINE_RINGS + 1]; /* [rings + 1] ascending, the first may be 0 */
    int sectors[OUTLINE_RINGS];       /* [rings] sectors of each ring */
} ring_pattern;

/*
 * Append the electrodes of a shape. Each returns 0, or -1 where memory runs out. A gap as large as
 * a cell or larger must be refused before: outline_hexagon_size, outline_grid_size and
 * outline_ring_size return the smallest size of an electrode across, which is not above 0 then.
 */
int outline_circle(scene_outlines *outlines, const double centre[2], double radius, scene_at at);
int outline_hexagons(scene_outlines *outlines, const hexagon_pattern *pattern, scene_at at);
int outline_grid(scene_outlines *outlines, const grid_pattern *pattern, scene_at at);
int outline_rings(scene_outlines *outlines, const ring_pattern *pattern, scene_at at);
double outline_hexagon_size(const hexagon_pattern *pattern);
double outline_grid_size(const grid_pattern *pattern);
double outline_ring_size(const ring_pattern *pattern);

#endif
