/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Outlines of electrodes as polygons: circles, and patterns of cells that touch each other. An
 * electrode is its cell with all sides moved inwards by half of the gap. A circle is a polygon of
 * 720 sides or more with the same area; the distance between both is at most 7e-6 of the radius.
 */
#ifndef OUTLINE_PATTERNS_H
#define OUTLINE_PATTERNS_H

#include "outline.h"

/*
 * Limits of electrode patterns. OUTLINE_RINGS: largest number of rings. OUTLINE_CELLS: largest
 * number of cells of a grid along one coordinate. OUTLINE_MOST: largest number of electrodes.
 */
enum { OUTLINE_RINGS = 64, OUTLINE_CELLS = 1000, OUTLINE_MOST = 4096 };

/*
 * Pattern of a hexagon in the middle and rings of hexagons around it. The first electrode is the
 * hexagon in the middle; the hexagons of each ring follow, from the inner to the outer ring, in
 * each ring counterclockwise from the direction `angle`.
 */
typedef struct hexagon_pattern {
    double centre[2];
    double pitch; /* distance of the centres of neighbouring hexagons (length) */
    double gap;   /* distance between neighbouring electrodes (length) */
    double angle; /* direction from the middle of the pattern to the first hexagon of each ring
                     (degrees) */
    int rings;
} hexagon_pattern;

/*
 * Pattern of electrodes: a rectangle that is divided into equal cells. The electrodes are numbered
 * with the second coordinate fastest.
 */
typedef struct grid_pattern {
    double from[2], to[2]; /* corners of the rectangle that the grid of electrodes divides, before
                              its rotation by `angle`: `from` has the smallest coordinates, `to` the
                              largest */
    double gap, angle; /* gap: distance between neighbouring electrodes (length); angle: rotation of
                          the whole grid about the middle of the rectangle that it divides (degrees)
                        */
    int count[2]; /* number of cells of the pattern along the first and the second coordinate */
} grid_pattern;

/*
 * Pattern of rings that are divided into sectors of equal angle, in the shape of keystones. The
 * electrodes are numbered from the inner to the outer ring, in each ring counterclockwise from the
 * direction `angle` (degrees).
 */
typedef struct ring_pattern {
    double centre[2], gap, angle;
    int rings;
    double radius[OUTLINE_RINGS + 1]; /* [rings + 1] radii that bound the rings of the pattern,
                                         ascending; the first may be 0 (length) */
    int sectors[OUTLINE_RINGS];       /* [rings] number of sectors of each ring of the pattern */
} ring_pattern;

/*
 * Append the electrodes of a circle or of a pattern of cells to a list. Each function returns 0, or
 * -1 where memory runs out. The caller checks before, with outline_hexagon_size, outline_grid_size
 * or outline_ring_size, that the smallest width of an electrode is positive.
 */
int outline_circle(scene_outlines *outlines, const double centre[2], double radius, scene_at at);
int outline_hexagons(scene_outlines *outlines, const hexagon_pattern *pattern, scene_at at);
int outline_grid(scene_outlines *outlines, const grid_pattern *pattern, scene_at at);
int outline_rings(scene_outlines *outlines, const ring_pattern *pattern, scene_at at);
double outline_hexagon_size(const hexagon_pattern *pattern);
double outline_grid_size(const grid_pattern *pattern);
double outline_ring_size(const ring_pattern *pattern);

#endif
