/* SPDX-License-Identifier: BSD-2-Clause */
/* Drawing layer of the report: pictures, lines, colours, axes, a view of space. Pixels, y down. */
#ifndef REPORT_DRAW_H
#define REPORT_DRAW_H

#include <stdbool.h>
#include <stdio.h>
#include "../mesh/mesh.h"
#include "report_put.h"

/* ---- pictures and styles ---------------------------------------------- */

/* A group's own titles are read out; a chart is a group that scrolls where a page is narrow. */
typedef enum draw_type { DRAW_IMAGE, DRAW_GROUP, DRAW_CHART } draw_type;

/* Every picture opens with its title and a description, plain text. */
void draw_begin(FILE *file, draw_type type, double width, double height, const char *title,
                const char *description);
void draw_end(FILE *file, draw_type type);

/* Style sheets, light and dark: of a page, of a picture in a file of its own. */
void draw_page_style(FILE *file);
void draw_picture_style(FILE *file);

/* ---- lines and discs: places that are not finite are left out --------- */

void draw_path(FILE *file, const char *style);
void draw_step(FILE *file, bool *is_drawing, const double at[2]);
void draw_line(FILE *file, const double from[2], const double to[2]);
void draw_polygon(FILE *file, const double (*at)[2], int count);
void draw_path_end(FILE *file);
void draw_disc(FILE *file, const char *style, const double at[2], double radius);

/* ---- colour scales ---------------------------------------------------- */

/* Levels of a scale; classes s0.. (signed: blue, neutral, orange) and v0.. (size: viridis). */
enum { DRAW_LEVELS = 33, DRAW_LEGEND_WIDTH = 330 };

/* Signed around zero, or a size from zero; `most` is the end of the scale. */
typedef struct draw_scale {
    bool is_signed;
    double most;
    const char *unit;
} draw_scale;

/* Colour of a value: its level, or -1 for no value; the style class of a level. */
int draw_level(const draw_scale *scale, double value);
const char *draw_class(const draw_scale *scale, int level);

/* Style of a text on the colour of a value: "mild" near the page's colour, "strong" far from it. */
const char *draw_tone(const draw_scale *scale, double value);

/* The scale with its numbers, in a picture (30 high) or as a block of the page. */
void draw_legend_at(FILE *file, const draw_scale *scale, double x, double y);
void draw_legend(FILE *file, const draw_scale *scale);

/* ---- axes ------------------------------------------------------------- */

typedef struct draw_axis {
    double low, high; /* values at its ends */
    double from, to;  /* places of its ends */
    bool is_log;
    const char *format; /* of a value in the unit, for put */
    put_unit unit;
} draw_axis;

double draw_on(const draw_axis *axis, double value);

/* Lines and numbers at 1, 2, 5 times powers of ten: of x (is_x) or y, across the other axis. */
void draw_grid(FILE *file, const draw_axis *x, const draw_axis *y, bool is_x);

/* The number 1, 2, 5 or 10 times a power of ten nearest to a positive value. */
double draw_round(double value);

/* ---- space ------------------------------------------------------------ */

/* A parallel projection, z up, fitted to the points that it includes. */
typedef struct draw_view {
    double axis[3][3];      /* right, up, towards the eye */
    double low[2], high[2]; /* of what is included, right and up */
    double zoom, width, height;
} draw_view;

/* Look down from where the outer side shows most; include points; fit into a width and a height. */
void draw_view_begin(draw_view *view, const mesh *mesh);
void draw_view_include(draw_view *view, const double x[3]);
void draw_view_fit(draw_view *view, double width, double height);
void draw_project(const draw_view *view, const double x[3], double at[2]);

/* Position of a node moved by factor times vector [nodes][3], which may be NULL. */
void draw_place(const mesh *mesh, int node, const double *vector, double factor, double x[3]);

/* Include the undeformed and the moved mesh. */
void draw_view_mesh(draw_view *view, const mesh *mesh, const double *vector, double factor);

/* Factor that draws the largest displacement (most) at about a share of the structure's size. */
double draw_magnification(const mesh *mesh, double most, double share);

/* Unit vector along a component at a point of the surface, in x, y, z. */
void draw_component(const surface_point *p, scene_component component, double along[3]);
double draw_dot3(const double a[3], const double b[3]);

/* Mesh lines to skip so that at most that many remain; the next line, the last one included. */
int draw_stride(int elements, int most);
int draw_next(int line, int stride, int last);

#endif
