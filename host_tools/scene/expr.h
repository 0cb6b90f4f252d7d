/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Functions of the coordinates in scenes: formulas, values interpolated between scattered points,
 * and lists of values in the order of the rows of a target.
 *
 * Formulas have numbers, the variables x, y, z, theta1, theta2, the
 * constant pi, the operators + - * / ^ and parentheses, common functions, and zernike(j, rho, phi).
 * The last is the Zernike polynomial of Noll index j with root mean square 1 over the unit disc; it
 * is NaN unless j is an integer from 1 to 1000.
 */
#ifndef EXPR_H
#define EXPR_H

#include <stddef.h>

typedef struct expr expr;

typedef struct expr_point {
    double x, y, z, theta1, theta2;
} expr_point;

/*
 * Compile a text to an expression.
 *   column  out  column of the fault, counted from 1
 *   error   out  description of the fault, a constant string
 * Returns NULL on a fault or when memory runs out.
 */
expr *expr_compile(const char *text, int *column, const char **error);

/* Coordinates by number, in the order of expr_point: x, y, z, theta1, theta2. */
enum { EXPR_AXES = 5 };

/*
 * Function through values at scattered points (scatter.h in host_tools/data).
 *   text                   in  description for reports
 *   axes, axis [axes]      in  number of coordinates of a point, 1 to 3, and which they are
 *   point [count][axes]    in  finite
 *   value [count]          in  finite
 * Returns NULL when memory runs out.
 */
expr *expr_from_points(const char *text, int axes, const int *axis, size_t count,
                       const double *point, const double *value);

/*
 * Function given by a list of values, one for each row of a target. value [count] in. Returns NULL
 * when memory runs out.
 */
expr *expr_from_list(const char *text, size_t count, const double *value);

/*
 * Return the value at a row of a target, whose coordinates are `at`. Lists need the row; their
 * value is NAN for a row that they do not have.
 */
double expr_row_value(const expr *expression, const expr_point *at, int row);

/* Return the number of values of a list, or -1 for other functions. */
int expr_rows(const expr *expression);

/*
 * Return the distance from a point to the nearest of the scattered points, in multiples of their
 * usual spacing; 0 for other functions.
 */
double expr_gap(const expr *expression, const expr_point *at);

/*
 * Return the value of an expression at a point. The value is not finite where the expression is
 * undefined, as in 1/0 or sqrt(-1); the caller must check.
 */
double expr_value(const expr *expression, const expr_point *at);

/* Return the text from which an expression was compiled. */
const char *expr_text(const expr *expression);

/* Return 1 if an expression uses none of x, y, z, theta1 and theta2, otherwise 0. */
int expr_is_constant(const expr *expression);

/* Return 1 if an expression uses theta1 or theta2, otherwise 0. */
int expr_uses_theta(const expr *expression);

void expr_free(expr *expression);

#endif
