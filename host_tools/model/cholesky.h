/* SPDX-License-Identifier: BSD-2-Clause */
/* Cholesky factor of small dense matrices, and linear systems solved with it. */
#ifndef CHOLESKY_H
#define CHOLESKY_H

#include <stdbool.h>
#include <stddef.h>

/*
 * Replace the lower triangle of a symmetric matrix by its Cholesky factor.
 *   a [n][n] in/out  the matrix; the part above the diagonal is neither read nor written
 * Returns whether the matrix is positive definite; if not, `a` is partly overwritten.
 */
bool cholesky_factor(double *a, size_t n);

/*
 * Solve a linear system, given the Cholesky factor of its matrix.
 *   l [n][n] in  the factor, in the lower triangle
 *   x [n] in/out  right-hand side; out: solution
 */
void cholesky_solve(const double *l, size_t n, double *x);

#endif
