/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Functions that draw the SVG pictures of reports. Coordinates are in pixels, with y pointing down.
 */
#ifndef REPORT_DRAW_H
#define REPORT_DRAW_H

#include <stdbool.h>
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
void draw_style(FILE *file, bool is_page);

/*
 * SVG path:
 *   DRAW_PATH      format of the function put that begins a path, with its style class
 *   draw_line      appends a line, which points that are not finite interrupt. A part of the line
 *       that ends where it begins is a closed polygon
 *   draw_polygon   appends a polygon, or a straight line through 2 points; nothing if a point is
 *       not finite
 *   DRAW_PATH_END  format that ends the path
 */
#define DRAW_PATH "<path class=\"%s\" d=\""
#define DRAW_PATH_END "\"/>\n"
void draw_line(FILE *file, const double (*at)[2], int count);
void draw_polygon(FILE *file, const double (*at)[2], int count);

/* Draw a disc with a centre and a radius in pixels, unless the centre is not finite. */
void draw_disc(FILE *file, const char *style, const double at[2], double radius);

/* Write the name of a row of a diagram to the left of x, in a font that fits the row's height. */
void draw_name(FILE *file, double x, double top, double height, const char *name);

/*
 * A colour scale for values from -most to most (is_signed), or from 0 to most, in a unit. Style
 * classes of its DRAW_LEVELS colours are s0, s1 and so on on a signed scale (blue, neutral,
 * orange), v0, v1 and so on on a scale from zero (viridis).
 */
typedef struct draw_scale {
    bool is_signed;
    double most;
    const char *unit;
} draw_scale;
enum { DRAW_LEVELS = 33, DRAW_LEGEND_WIDTH = 330 }; /* width in pixels */

/*
 * Colour scales:
 *   draw_scale_of  returns a colour scale whose range contains `count` values
 *   draw_extend    extends the range of a scale so that it contains `count` values
 *   draw_colour    returns the style class of the colour of a value, "none" if it is not finite;
 *       the same pointer for the same colour
 *   draw_tone      returns the style class of a text on the colour of a value: "strong" on dark or
 *       saturated colours near the ends of the scale, "mild" on others
 *   draw_legend    draws the legend of a scale with its numbers at x, y (pixels), 30 pixels high
 */
draw_scale draw_scale_of(bool is_signed, const char *unit, const double *value, int count);
void draw_extend(draw_scale *scale, const double *value, int count);
const char *draw_colour(const draw_scale *scale, double value);
const char *draw_tone(const draw_scale *scale, double value);
void draw_legend(FILE *file, const draw_scale *scale, double x, double y);

/*
 * An axis of a diagram: values (low, high) and pixel coordinates (from, to) of its two ends. A
 * logarithmic y axis shows its values with a percent sign.
 */
typedef struct draw_axis {
    double low, high, from, to;
    bool is_log;
    put_unit unit;
} draw_axis;

/*
 * A curve through `count` points: along [count] are their values on axis x, value [count] those on
 * axis y. If along is NULL, the points are the middles of equal parts of axis x.
 */
typedef struct draw_series {
    const char *style;
    const double *along, *value;
    int count;
    const char *name; /* name of the curve, written beside the point `named`; NULL: none */
    int named;
} draw_series;

/* A point of a diagram that is marked with a disc, a name, and its value on axis y. */
typedef struct draw_mark {
    double along, value;
    const char *name;
} draw_mark;

/* A diagram: axes, curves [count], and marked points [marks]. */
typedef struct draw_diagram {
    draw_axis x, y;
    const draw_series *series;
    const draw_mark *mark;
    int count, marks;
} draw_diagram;

/*
 * Diagrams:
 *   draw_on      returns the pixel coordinate of a value on an axis
 *   draw_widen   widens the range of an axis so that it contains values, on a logarithmic axis
 *       those that are positive
 *   draw_fit     widens the axes of a diagram so that they contain its curves
 *   draw_grid    draws grid lines with their numbers for values of x (is_x) or y, at multiples of a
 *       round step (1, 2 or 5 times a power of ten), on a logarithmic axis at such numbers
 *   draw_curve   draws one curve
 *   draw_curves  draws all curves and marked points of a diagram
 */
double draw_on(const draw_axis *axis, double value);
void draw_widen(draw_axis *axis, const double *value, int count);
void draw_fit(draw_diagram *diagram);
void draw_grid(FILE *file, const draw_diagram *diagram, bool is_x);
void draw_curve(FILE *file, const draw_diagram *diagram, const draw_series *series);
void draw_curves(FILE *file, const draw_diagram *diagram);

/* Round a positive value to the nearest of the numbers 1, 2, 5 or 10 times a power of ten. */
double draw_round(double value);

#endif
