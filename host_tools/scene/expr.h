/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Arithmetic expressions in scenes, with numbers, the variables x, y, z, theta1, theta2, the
 * constant pi, the operators + - * / ^ and parentheses, common functions, and zernike(j, rho, phi).
 * The last is the Zernike polynomial of Noll index j with root mean square 1 over the unit disc; it
 * is NaN unless j is an integer from 1 to 1000.
 */
#ifndef EXPR_H
#define EXPR_H

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
