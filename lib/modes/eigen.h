/* SPDX-License-Identifier: BSD-2-Clause */
/* Eigenvalues and eigenvectors of small dense symmetric matrices. */
#ifndef PZS_LIB_EIGEN_H
#define PZS_LIB_EIGEN_H

#include "pzs_base.h"

/*
 * Compute eigenvalues and eigenvectors of a symmetric matrix by Jacobi's method with cyclic sweeps,
 * which end when all entries beside the diagonal are negligible.
 *   a [n][n]   in/out  the matrix; out: eigenvalues on the diagonal, not sorted
 *   v [n][n]   out     eigenvectors as columns
 *   sweeps     in      largest number of sweeps
 *   negligible in      entries of at most this size count as 0
 */
void pzs_eigen_symmetric(pzs_real *a, pzs_real *v, size_t n, int sweeps, pzs_real negligible);

#endif
