/* SPDX-License-Identifier: BSD-2-Clause */
/* Inverse of a small positive definite matrix. */
#ifndef INVERT_H
#define INVERT_H

/*
 * Invert a positive definite matrix in place by Gauss-Jordan elimination. The matrix has `rows`
 * rows and columns and is stored by rows, `stride` numbers apart. Returns 0, or -1 if a pivot is
 * not positive; the matrix is then destroyed.
 */
int invert(double *matrix, int rows, int stride);

#endif
