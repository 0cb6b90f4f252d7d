/* SPDX-License-Identifier: BSD-2-Clause */
/* An element, or a part of one, as a quadrilateral in the plane of the outlines of electrodes. */
#ifndef OUTLINE_CELL_H
#define OUTLINE_CELL_H

#include "../data/polygon.h"
#include "scene.h"

/* Coordinates of a corner: x, y, z, theta1, theta2; the last two are 0 on a mesh from a file. */
enum { OUTLINE_AXES = 5 };

typedef struct outline_cell {
    double at[4][OUTLINE_AXES]; /* corners (-,-) (+,-) (+,+) (-,+) */
    double quad[4][2];          /* the same in the plane, counterclockwise */
    double centre[2];           /* mean of the corners in the plane */
    double ratio[3];            /* area of the surface over that of the plane at the centre, and its
                                   derivatives along the two coordinates of the plane */
    double plane_area;          /* area in the plane */
    double area;                /* area of the surface by `ratio` */
    polygon_box box;            /* in the plane */
    bool is_mirrored;           /* the surface is seen from behind: quad has the reverse order */
    bool is_steep;              /* the surface stands at more than 84 degrees to the plane */
} outline_cell;

/* Number of elements of a scene. */
int outline_elements(const scene *scene);

/* The cell of an element. */
void outline_cell_of(const scene *scene, outline_plane plane, int element, outline_cell *cell);

/*
 * Part [low, high] x [low, high] of a cell in natural coordinates.
 *   low, high [2] in  from -1 to 1
 */
void outline_cell_part(const outline_cell *whole, outline_plane plane, const double low[2],
                       const double high[2], outline_cell *part);

/*
 * Moves of a cell by full turns along closed coordinates, by which an outline beyond the ends of
 * theta1 or theta2 meets it. k: number of the move, from 0 (no move) to OUTLINE_MOVES - 1. Returns
 * whether the scene has this move.
 */
enum { OUTLINE_MOVES = 9 };
bool outline_cell_move(const scene *scene, outline_plane plane, int k, double shift[2]);

/* Move a cell in the plane. */
void outline_cell_shift(outline_cell *cell, const double shift[2]);

/* Coordinates at a point of a cell. natural [2] in, at [OUTLINE_AXES] out */
void outline_cell_at(const outline_cell *cell, const double natural[2], double at[OUTLINE_AXES]);

/* The same as the variables of a formula; where the scene has a surface, the point lies on it. */
expr_point outline_cell_point(const scene *scene, const outline_cell *cell,
                              const double natural[2]);

/* Natural coordinates of a point of the plane inside the cell. */
void outline_cell_natural(const outline_cell *cell, outline_plane plane, const double point[2],
                          double natural[2]);

/* Area of the surface per area of natural coordinates at a point of the cell. */
double outline_cell_stretch(const outline_cell *cell, const double natural[2]);

#endif
