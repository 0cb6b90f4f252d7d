/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Parallel projections to a picture: of a mesh in space, and of the map of a mesh, on which the
 * values at its nodes are shown.
 *
 * The map of a mesh along lines of curvature is its parameter plane, with theta1 downwards and
 * theta2 to the right, as the rows and columns of a printed table of voltages are. A polar plate
 * and a mesh of points are seen with x to the right and y upwards. A mesh from a file is seen along
 * its mean normal; a closed surface, which has no mean normal, from above.
 */
#ifndef REPORT_VIEW_H
#define REPORT_VIEW_H

#include <stdbool.h>
#include "../mesh/mesh.h"

/*
 * A projection, scaled so that all included points fit into the picture. Points have three
 * coordinates: x, y, z in space, or theta1, theta2 and 0 on a parameter plane.
 */
typedef struct view {
    double axis[3][3];      /* directions to the right, up and towards the viewer */
    double low[2], high[2]; /* range of the included points, to the right and up */
    double zoom;            /* pixels per length unit */
    double width, height;   /* size of the picture in pixels */
} view;

/* Whether the map of a mesh is its parameter plane. */
bool view_has_parameters(const mesh *mesh);

/*
 * Begin a view that includes no points yet: a view in space of the outer side of a shell, or the
 * map of the shell.
 */
void view_begin(view *view, const mesh *mesh, bool is_map);

/* Make a point visible in the view. */
void view_include(view *view, const double point[3]);

/* Fit the included points into a picture of a size in pixels, at least `least` pixels high. */
void view_fit(view *view, double width, double height, double least);

/* Compute the pixel coordinates of a point. */
void view_project(const view *view, const double point[3], double at[2]);

/*
 * Magnification, a round number, with which the displacement `most` is drawn as about the fraction
 * `share` of the largest dimension of the mesh.
 */
double view_magnification(const mesh *mesh, double most, double share);

#endif
