/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Arithmetic expressions of scenes: numbers, x y z theta1 theta2 pi, + - * / ^ ( ), common
 * functions, and zernike(j, rho, phi): Zernike's polynomial of Noll's number j, of root mean square
 * 1 over the unit disc; NaN where j is no whole number from 1 to 1000.
 */
#ifndef EXPR_H
#define EXPR_H

typedef struct expr expr;

typedef struct expr_point {
    double x, y, z, theta1, theta2;
} expr_point;

/*
 * Compile text to an expression.
 *   column  out  column from 1 of the fault
 *   error   out  what is wrong there, a constant string
 * Returns NULL on a fault or when memory runs out.
 */
expr *expr_compile(const char *text, int *column, const char **error);

/* Value at a point; not finite where the expression has none (1/0, sqrt(-1)): the caller checks. */
double expr_value(const expr *expression, const expr_point *at);

/* The text that it was compiled from. */
const char *expr_text(const expr *expression);

/* Does it use none of x y z theta1 theta2? */
int expr_is_constant(const expr *expression);

/* Does it use theta1 or theta2? */
int expr_uses_theta(const expr *expression);

void expr_free(expr *expression);

#endif
