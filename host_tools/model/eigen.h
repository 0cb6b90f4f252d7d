/* SPDX-License-Identifier: BSD-2-Clause */
/* Spectral radius of small dense matrices. */
#ifndef EIGEN_H
#define EIGEN_H

#include <stdbool.h>
#include <stddef.h>

/*
 * Return the spectral radius of a square matrix A by repeated squaring, |A^k|^(1/k) with k =
 * 2^squarings (Gelfand's formula). It is too large by a factor of at most about (condition of the
 * eigenvectors)^(1/k).
 *   a    [n][n] in/out  matrix A; overwritten
 *   work [n][n] out  work array
 */
double eigen_radius(double *a, double *work, size_t n, int squarings);

/*
 * Return whether the spectral radius of a matrix A is below 1. The test ends early if a power A^k
 * has a norm below 1, or eigenvalues whose mean has a magnitude above 1.
 *   a    [n][n] in/out  matrix A; overwritten
 *   work [n][n] out     work array
 *   squarings   in      largest number of squarings, each of which doubles the exponent k
 */
bool eigen_decays(double *a, double *work, size_t n, int squarings);

#endif
