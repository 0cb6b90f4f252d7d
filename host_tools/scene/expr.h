/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Functions of coordinates in scenes: formulas, interpolation between values at scattered points,
 * and lists of values in the order of a target's rows. Formulas have numbers, pi, the operators + -
 * * / ^, parentheses, common functions, and
 *   x, y, z               coordinates in space
 *   theta1, theta2        surface coordinates
 *   zernike(j, rho, phi)  Zernike polynomial of Noll index j, 1 to 1000 (else NaN), with root mean
 *       square 1 over the unit disc
 */
#ifndef EXPR_H
#define EXPR_H

#include <stddef.h>

typedef struct expr expr;

typedef struct expr_point {
    double x, y, z, theta1, theta2;
} expr_point;

/*
 * Compile the text of a formula.
 *   column  out  position of the fault in the text, counted from 1
 *   error   out  description of the fault, a constant string
 * Returns NULL on a fault or when memory runs out, else the expression, which expr_free releases.
 */
expr *expr_compile(const char *text, int *column, const char **error);

/*
 * Number of coordinates of a point in expr_point, whose indices follow the order x, y, z (in
 * space), theta1, theta2 (on the surface).
 */
enum { EXPR_AXES = 5 };

/*
 * Build a function that interpolates values given at scattered points (scatter.h in
 * host_tools/data).
 *   text                 in  description for reports
 *   axes                 in  number of coordinates of a point, 1 to 3
 *   axis  [axes]         in  index of each coordinate among x, y, z (in space), theta1, theta2
 *   point [count][axes]  in  coordinates of the points, finite
 *   value [count]        in  values at the points, finite
 * Returns NULL when memory runs out.
 */
expr *expr_from_points(const char *text, int axes, const int *axis, size_t count,
                       const double *point, const double *value);

/*
 * Build a function from a list of values, one for each row of a target: one controlled
 * displacement, or one output of a measured influence matrix.
 *   text   in           description for reports
 *   value  [count]  in  values in the order of the rows
 * Returns NULL when memory runs out.
 */
expr *expr_from_list(const char *text, size_t count, const double *value);

/*
 * Return the value of a function for one row of a target (one controlled displacement): entry `row`
 * of a list of values (expr_from_list), NAN if there is none; other functions are evaluated at the
 * point.
 *   at   in  coordinates of the point of the controlled displacement
 *   row  in  index of the row, from 0; negative: no row
 */
double expr_row_value(const expr *expression, const expr_point *at, int row);

/*
 * Return the length of the list of values from which expr_from_list made a function, or -1 for any
 * other function.
 */
int expr_rows(const expr *expression);

/*
 * Return how far a point lies from the data of an interpolated function: the distance to the
 * nearest scattered point, in multiples of the usual spacing of those points; 0 for any other
 * function.
 */
double expr_gap(const expr *expression, const expr_point *at);

/*
 * Return the value of a function at a point. The value is not finite where the function is
 * undefined, as 1/0 or sqrt(-1); the caller must check.
 */
double expr_value(const expr *expression, const expr_point *at);

/* Return the text that a function was compiled from, or its description for reports. */
const char *expr_text(const expr *expression);

/* Return 1 if a function depends on none of the coordinates x, y, z, theta1 and theta2, else 0. */
int expr_is_constant(const expr *expression);

/* Return 1 if a function depends on a surface coordinate (theta1 or theta2), else 0. */
int expr_uses_theta(const expr *expression);

void expr_free(expr *expression);

#endif
