/* SPDX-License-Identifier: BSD-2-Clause */
/* Products and inverses of small dense matrices and vectors. */
#ifndef DENSE_H
#define DENSE_H

#include <stdbool.h>
#include <stddef.h>

/* Return the scalar product of two vectors [count]. */
double dense_dot(const double *x, const double *y, size_t count);

/*
 * Multiply two matrices: out = a b, or the transpose of a times b if `transposed` is true.
 *   a, b [order][order] in   factors
 *   out  [order][order] out  product, in other memory than a and b
 */
void dense_multiply(double *out, const double *a, const double *b, size_t order, bool transposed);

/* Replace a matrix [order][order] by the mean of the matrix and its transpose. */
void dense_symmetrise(double *a, size_t order);

/*
 * Invert a matrix by Gauss-Jordan elimination with partial pivoting: x = inverse of a.
 *   a [order][order] in   overwritten
 *   x [order][order] out  inverse
 * Returns 0, or -1 where the matrix is singular.
 */
int dense_invert(double *a, double *x, size_t order);

#endif
