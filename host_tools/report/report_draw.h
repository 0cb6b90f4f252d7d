/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Functions that draw the SVG pictures of reports. Coordinates are in pixels, with y pointing down.
 */
#ifndef REPORT_DRAW_H
#define REPORT_DRAW_H

#include <stdbool.h>
#include <stdio.h>
#include "report_put.h"

/*
 * Type of a picture. A screen reader announces DRAW_IMAGE as one image, and reads the titles inside
 * a DRAW_GROUP one by one. DRAW_CHART is a group that can be scrolled sideways on a page too narrow
 * for the picture.
 */
typedef enum draw_type { DRAW_IMAGE, DRAW_GROUP, DRAW_CHART } draw_type;

/*
 * draw_begin begins an SVG picture with a size in pixels, a title and a description in plain text;
 * draw_end ends the picture.
 */
void draw_begin(FILE *file, draw_type type, double width, double height, const char *title,
                const char *description);
void draw_end(FILE *file, draw_type type);

/* Write the light and dark style sheet of an HTML page, or of an SVG picture in its own file. */
void draw_page_style(FILE *file);
void draw_picture_style(FILE *file);

/*
 * SVG path:
 *   draw_path      begins a path with a style class
 *   draw_step      appends a point to a line
 *   draw_polygon   appends a polygon, or a straight line through 2 points
 *   draw_path_end  ends the path
 * Points that are not finite are left out, with the polygon they belong to.
 */
void draw_path(FILE *file, const char *style);
void draw_step(FILE *file, bool *is_drawing, const double at[2]);
void draw_polygon(FILE *file, const double (*at)[2], int count);
void draw_path_end(FILE *file);

/* Draw a disc with a centre and a radius in pixels, unless the centre is not finite. */
void draw_disc(FILE *file, const char *style, const double at[2], double radius);

/*
 * draw_text writes a text with the directives of the function put at x, y in pixels. draw_name
 * writes the name of a row of a diagram to the left of x, in a font that fits the row's height.
 */
void draw_text(FILE *file, const char *style, double x, double y, const char *format, ...);
void draw_name(FILE *file, double x, double top, double height, const char *name);

/*
 * Number of colours of a scale, and width of its legend in pixels. Style classes of the colours are
 * s0 to s32 on a signed scale (blue, neutral, orange), v0 to v32 on a scale from zero (viridis).
 */
enum { DRAW_LEVELS = 33, DRAW_LEGEND_WIDTH = 330 };

/* A colour scale for values from -most to most (is_signed), or from 0 to most, in a unit. */
typedef struct draw_scale {
    bool is_signed;
    double most;
    const char *unit;
} draw_scale;

/*
 * draw_scale_of returns a colour scale whose range contains `count` values; draw_extend extends the
 * range of a scale so that it contains `count` values.
 */
draw_scale draw_scale_of(bool is_signed, const char *unit, const double *value, int count);
void draw_extend(draw_scale *scale, const double *value, int count);

/*
 * Colours on a scale:
 *   draw_level   index of the colour of a value, -1 if the value is not finite
 *   draw_class   style class of the colour with an index
 *   draw_colour  style class of the colour of a value
 *   draw_tone    style class of a text on the colour of a value: "strong" on dark or saturated
 *       colours near the ends of the scale, "mild" on others
 */
int draw_level(const draw_scale *scale, double value);
const char *draw_class(const draw_scale *scale, int level);
const char *draw_colour(const draw_scale *scale, double value);
const char *draw_tone(const draw_scale *scale, double value);

/*
 * Draw the legend of a colour scale with its numbers, 30 pixels high. draw_legend_at draws it
 * inside a picture at x, y (pixels); draw_legend makes a picture of it.
 */
void draw_legend_at(FILE *file, const draw_scale *scale, double x, double y);
void draw_legend(FILE *file, const draw_scale *scale);

/*
 * An axis of a diagram: values (low, high) and pixel coordinates (from, to) of its two ends,
 * whether it is logarithmic, and the format and unit of its numbers.
 */
typedef struct draw_axis {
    double low, high, from, to;
    bool is_log;
    const char *format; /* format of the numbers at the axis, with a directive of the function put
                         */
    put_unit unit;
} draw_axis;

/*
 * draw_on returns the pixel coordinate of a value on an axis. draw_widen widens the range of an
 * axis so that it contains values, on a logarithmic axis those that are positive.
 */
double draw_on(const draw_axis *axis, double value);
void draw_widen(draw_axis *axis, const double *value, int count);

/*
 * Draw a curve through `count` points: along [count] are their values on axis x, value [count]
 * those on axis y. If along is NULL, the points are the middles of equal parts of axis x.
 */
typedef struct draw_series {
    const char *style;
    const double *along, *value;
    int count;
} draw_series;
void draw_curve(FILE *file, const draw_axis *x, const draw_axis *y, const draw_series *series);

/*
 * Draw the grid lines of a diagram, with their numbers, for values of x (is_x) or of y. They lie at
 * multiples of a round step (1, 2 or 5 times a power of ten), on a logarithmic axis at such
 * numbers themselves.
 */
void draw_grid(FILE *file, const draw_axis *x, const draw_axis *y, bool is_x);

/* Round a positive value to the nearest of the numbers 1, 2, 5 or 10 times a power of ten. */
double draw_round(double value);

#endif
