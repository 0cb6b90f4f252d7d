/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Cell: an element, or a part of an element, as a quadrilateral in the plane of the outlines of
 * electrodes.
 */
#ifndef OUTLINE_CELL_H
#define OUTLINE_CELL_H

#include "../data/polygon.h"
#include "scene.h"

/*
 * Number of coordinates of a corner of an element: x, y, z in space, and the surface coordinates
 * theta1 and theta2, which are 0 on a mesh from a file.
 */
enum { OUTLINE_AXES = 5 };

typedef struct outline_cell {
    double at[4][OUTLINE_AXES]; /* coordinates x, y, z (in space) and theta1, theta2 (on the
                                   surface) of the corners of the cell (element or part of one), in
                                   the order (-,-) (+,-) (+,+) (-,+) */
    double quad[4][2]; /* corners of the cell (element or part of one) in the plane of the electrode
                          outlines, counterclockwise */
    double centre[2]; /* mean of the four corners of a cell (element or part of one) in the plane of
                         the electrode outlines */
    double ratio[3];  /* ratio of two areas in a cell (element or part of one), area of the surface
                         over area in the plane of the electrode outlines: value at the centre of
                         the cell, then derivatives along the two coordinates of the plane */
    double plane_area; /* area of the cell (element or part of one) in the plane of the electrode
                          outlines */
    double area; /* area of the cell (element or part of one) on the surface, from its area in the
                    plane and the ratio of both */
    polygon_box box;  /* bounding box of the cell (element or part of one) in the plane of the
                         electrode outlines */
    bool is_mirrored; /* true where the projection on the plane of the outlines reverses the
                         orientation of the corners, so that the inner face of the surface is seen;
                         `quad` then has the corners in reverse order, to be counterclockwise */
    bool is_steep;    /* true where the surface stands at more than 84 degrees to the plane of the
                         electrode outlines */
} outline_cell;

/* Return the number of elements of a scene, on mesh lines or on a mesh from a file. */
int outline_elements(const scene *scene);

/*
 * Compute the cell of an element: its quadrilateral in the plane of the electrode outlines, and its
 * area on the surface.
 */
void outline_cell_of(const scene *scene, outline_plane plane, int element, outline_cell *cell);

/*
 * Return the area on the surface of a polygon inside a cell (element or part of one).
 *   sums in  area and first moments of the polygon in the plane of the electrode outlines, the
 *            moments about the centre of the cell
 */
double outline_cell_area(const outline_cell *cell, const polygon_sums *sums);

/*
 * Compute the part of a cell (the quadrilateral of an element in the plane of the electrode
 * outlines) between two values of each natural coordinate.
 *   low, high [2] in  from -1 to 1
 */
void outline_cell_part(const outline_cell *whole, outline_plane plane, const double low[2],
                       const double high[2], outline_cell *part);

/*
 * An electrode outline may pass the end of a periodic surface coordinate (theta1 or theta2, period
 * 2 pi). For the comparison with such an outline, a cell (element or part of one) is also moved by
 * full turns. Compute one of these displacements.
 *   k          in   number of the displacement, below OUTLINE_MOVES: 0 for none, else a combination
 *       of 0, +1 and -1 turns of both coordinates
 *   shift  [2] out  displacement in the plane of the electrode outlines
 * Returns whether all coordinates that are moved are periodic on the surface of the scene.
 */
enum { OUTLINE_MOVES = 9 };
bool outline_cell_move(const scene *scene, outline_plane plane, int k, double shift[2]);

/* Move a cell (element or part of one) in the plane of the outlines by shift [2]. */
void outline_cell_shift(outline_cell *cell, const double shift[2]);

/*
 * Return the coordinates at a point of a cell (element or part of one) as the variables of a
 * formula. natural [2] in. Where the scene has a surface, the point lies exactly on the surface.
 */
expr_point outline_cell_point(const scene *scene, const outline_cell *cell,
                              const double natural[2]);

/*
 * Find the natural coordinates of a point in a cell (element or part of one). The point is given in
 * the plane of the electrode outlines.
 */
void outline_cell_natural(const outline_cell *cell, outline_plane plane, const double point[2],
                          double natural[2]);

/*
 * Return the area of the surface per area of natural coordinates at a point of a cell (element or
 * part of one).
 */
double outline_cell_stretch(const outline_cell *cell, const double natural[2]);

#endif
