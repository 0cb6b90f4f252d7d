/* SPDX-License-Identifier: BSD-2-Clause */
/* Inverse of a small positive definite matrix. */
#ifndef INVERT_H
#define INVERT_H

/*
 * Invert a positive definite matrix a [n][stride] in place by Gauss-Jordan elimination. Returns 0,
 * or -1 at a pivot that is not positive.
 */
int invert(double *matrix, int rows, int stride);

#endif
