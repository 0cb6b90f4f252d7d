/* Primitives of the drawings: a picture, colour scales, a projection of space. */
#ifndef REPORT_DRAW_H
#define REPORT_DRAW_H

#include <stdio.h>
#include "../mesh/mesh.h"

/*
 * Every picture opens with what it shows, in words. A group's texts are read out too. A chart is a
 * group that on a narrow page scrolls in a box of its own before its texts become too small to
 * read.
 */
void draw_begin(FILE *file, double width, double height, const char *title);
void draw_begin_group(FILE *file, double width, double height, const char *title);
void draw_end(FILE *file);
void draw_begin_chart(FILE *file, double width, double height, const char *title);
void draw_end_chart(FILE *file);

/* Values to colours: signed around zero, or a size from zero; `most` is the end of the scale. */
typedef struct draw_scale {
    int is_signed;
    double most;
    const char *unit;
} draw_scale;

/* Level of a value from 0, or -1 for NaN. */
int draw_level(const draw_scale *scale, double value);

/* Start of a path of that level's colour, grey for -1; the caller goes on with its points and
 * closes it. */
void draw_path(FILE *file, const draw_scale *scale, int level);

/* A disc in the colour of a value. */
void draw_disc(FILE *file, const draw_scale *scale, double value, const double at[2]);

/* A block of the page: the scale with its ends. */
void draw_legend(FILE *file, const draw_scale *scale);

/* A parallel projection of space, z up, fitted to points. */
typedef struct draw_view {
    double axis[3][3];      /* right, up, towards the eye */
    double low[2], high[2]; /* of what is included, right and up */
    double zoom, width, height;
} draw_view;

/* Look down from where the outer side shows most; include every point to be seen; fit into a
 * picture of a width and a largest height. */
void draw_view_begin(draw_view *view, const mesh *mesh);
void draw_view_include(draw_view *view, const double x[3]);
void draw_view_fit(draw_view *view, double width, double height);

/* Place in the picture of a point in space. */
void draw_project(const draw_view *view, const double x[3], double at[2]);

/* Position of a node moved by factor times vector [nodes][3]; vector may be NULL. */
void draw_place(const mesh *mesh, int node, const double *vector, double factor, double x[3]);

/* Lines to skip so that at most that many parts are drawn; the next line, the last one included. */
int draw_stride(int elements, int most);
int draw_next(int k, int step, int last);

/* Value at (s, t) of 0..1 between four corners in element order. */
double draw_between(const double corner[4], double s, double t);

/* Has the node at line i of theta1 and j of theta2 a value that no element around it can show, for
 * others have none? value [nodes] */
int draw_is_lone(const mesh *mesh, const double *value, int i, int j);

/* Unit vector along a component at a point of the surface, in x, y, z. */
void draw_direction(const surface_point *p, scene_component component, double along[3]);

double draw_dot3(const double a[3], const double b[3]);

#endif
