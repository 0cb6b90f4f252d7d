/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Drawing layer of the report: SVG pictures, lines, colour scales, axes and a parallel projection
 * from space. Coordinates in a picture are in pixels, with y pointing down.
 */
#ifndef REPORT_DRAW_H
#define REPORT_DRAW_H

#include <stdbool.h>
#include <stdio.h>
#include "../mesh/mesh.h"
#include "report_put.h"

/* ---- pictures and styles ---------------------------------------------- */

/*
 * Type of a picture. A screen reader announces DRAW_IMAGE as one image, and reads the titles inside
 * a DRAW_GROUP one by one. DRAW_CHART is a group that can be scrolled sideways on a page too narrow
 * for it.
 */
typedef enum draw_type { DRAW_IMAGE, DRAW_GROUP, DRAW_CHART } draw_type;

/*
 * Begin and end a picture of a width and a height in pixels. It starts with its title and its
 * description, both plain text.
 */
void draw_begin(FILE *file, draw_type type, double width, double height, const char *title,
                const char *description);
void draw_end(FILE *file, draw_type type);

/*
 * Write the style sheet of a whole page, or that of a picture in a file of its own. Each contains
 * the colours for light and for dark display.
 */
void draw_page_style(FILE *file);
void draw_picture_style(FILE *file);

/* ---- lines and discs: points that are not finite are left out --------- */

void draw_path(FILE *file, const char *style);
void draw_step(FILE *file, bool *is_drawing, const double at[2]);
void draw_line(FILE *file, const double from[2], const double to[2]);
void draw_polygon(FILE *file, const double (*at)[2], int count);
void draw_path_end(FILE *file);
void draw_disc(FILE *file, const char *style, const double at[2], double radius);

/* ---- colour scales ---------------------------------------------------- */

/*
 * Number of colours of a scale, and the width of its legend in pixels. The style classes of the
 * colours are s0 to s32 on a signed scale (blue, neutral, orange), and v0 to v32 on a scale from
 * zero (viridis).
 */
enum { DRAW_LEVELS = 33, DRAW_LEGEND_WIDTH = 330 };

/* A colour scale: from -most to most if is_signed, else from 0 to most, in the given unit. */
typedef struct draw_scale {
    bool is_signed;
    double most;
    const char *unit;
} draw_scale;

/*
 * draw_level returns the index of the colour of a value, or -1 if the value is not finite.
 * draw_class returns the style class of that index.
 */
int draw_level(const draw_scale *scale, double value);
const char *draw_class(const draw_scale *scale, int level);

/*
 * Style class of a text written on the colour of a value: "strong" for the colours at the two ends
 * of the scale, "mild" for those around its middle.
 */
const char *draw_tone(const draw_scale *scale, double value);

/*
 * Draw a colour scale with its numbers: at a place inside a picture, 30 pixels high, or as a
 * separate block of the page.
 */
void draw_legend_at(FILE *file, const draw_scale *scale, double x, double y);
void draw_legend(FILE *file, const draw_scale *scale);

/* ---- axes ------------------------------------------------------------- */

typedef struct draw_axis {
    double low, high; /* values at both ends of the axis */
    double from, to;  /* pixel coordinates of both ends */
    bool is_log;
    const char *format; /* format of a value in the unit, as the function put takes it */
    put_unit unit;
} draw_axis;

double draw_on(const draw_axis *axis, double value);

/*
 * Draw grid lines with their numbers at 1, 2 and 5 times powers of ten, for the values of x (is_x)
 * or of y, over the whole length of the other axis.
 */
void draw_grid(FILE *file, const draw_axis *x, const draw_axis *y, bool is_x);

/* Round a positive value to the nearest of the numbers 1, 2, 5 or 10 times a power of ten. */
double draw_round(double value);

/* ---- space ------------------------------------------------------------ */

/*
 * A parallel projection from space to a picture, with z pointing up, scaled so that all included
 * points fit into the picture.
 */
typedef struct draw_view {
    double axis[3][3];      /* unit vectors to the right, up and towards the viewer */
    double low[2], high[2]; /* range of the included points, to the right and up */
    double zoom, width, height;
} draw_view;

/*
 * draw_view_begin chooses the viewing direction, from above, in which the outer side of the shell
 * shows most. draw_view_include adds a point that must be visible, and draw_view_fit scales the
 * view to a width and a height in pixels. draw_project then gives the pixel coordinates of a point
 * in space.
 */
void draw_view_begin(draw_view *view, const mesh *mesh);
void draw_view_include(draw_view *view, const double x[3]);
void draw_view_fit(draw_view *view, double width, double height);
void draw_project(const draw_view *view, const double x[3], double at[2]);

/*
 * Position in space of a node displaced by factor * vector[node].
 *   vector [nodes][3]  in   displacement, or NULL: none
 *   x                  out
 */
void draw_place(const mesh *mesh, int node, const double *vector, double factor, double x[3]);

/* Include the undeformed mesh in a view, and the mesh displaced by factor * vector. */
void draw_view_mesh(draw_view *view, const mesh *mesh, const double *vector, double factor);

/*
 * Magnification at which the largest displacement `most` is drawn at about the fraction `share` of
 * the size of the structure.
 */
double draw_magnification(const mesh *mesh, double most, double share);

/* Cartesian unit vector of a displacement component at a point of the surface. */
void draw_component(const surface_point *p, scene_component component, double along[3]);
double draw_dot3(const double a[3], const double b[3]);

/*
 * draw_stride returns the number of elements per drawn cell so that at most `most` cells are drawn.
 * draw_next returns the next drawn mesh line after `line`; the line `last` is always drawn.
 */
int draw_stride(int elements, int most);
int draw_next(int line, int stride, int last);

#endif
