/* SPDX-License-Identifier: BSD-2-Clause */
/* One picture of a mesh, and where it is drawn. */
#ifndef REPORT_PICTURE_H
#define REPORT_PICTURE_H

#include "report_draw.h"

/*
 * Picture of the parameter plane. theta1 increases downwards and theta2 to the right, as the rows
 * and columns of a printed table of voltages do. A polar plate is drawn in its true form, a disc or
 * a sector, with theta2 anticlockwise from the right.
 */
typedef struct shell_plane {
    double low[2], range[2]; /* lowest value and range of theta1 and theta2 */
    double x0, y0, width, height, picture_height;
    bool is_polar;
    double zoom; /* pixels per length unit of a polar plate, whose centre is at x0 + centre[0], y0 +
                    centre[1] */
    double centre[2];
    draw_view flat; /* mesh from a file: the view of its maps */
} shell_plane;

enum { SHELL_PLANE_WIDTH = 320 };

/*
 * One picture of a mesh. With a view: the surface in space, displaced by factor * vector
 * [nodes][3]. Without one (NULL): the map over the parameter plane.
 */
typedef struct shell {
    FILE *file;
    const mesh *m;
    const draw_view *view;
    const double *vector;
    double factor;
    shell_plane plane;
} shell;

#endif
