/* SPDX-License-Identifier: BSD-2-Clause */
/* Spectral radius of small dense matrices by repeated squaring (eigen.h). */
#include "eigen.h"
#include <math.h>
#include <string.h>

/* Divide a matrix a [n][n] by its Frobenius norm. Returns the norm. */
static double normalise(double *a, size_t n)
{
    double sum = 0;
    for (size_t i = 0; i < n * n; i++)
        sum += a[i] * a[i];
    const double norm = sqrt(sum);
    for (size_t i = 0; i < n * n && norm > 0; i++)
        a[i] /= norm;
    return norm;
}

/*
 * Compute the square of a matrix a [n][n]: out = a a.
 *   out [n][n] out  square, in other memory than a
 */
static void square(const double *a, double *out, size_t n)
{
    memset(out, 0, n * n * sizeof *out);
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < n; k++) {
            const double factor = a[i * n + k];
            for (size_t j = 0; j < n && factor != 0; j++)
                out[i * n + j] += factor * a[k * n + j];
        }
}

/*
 * Replace a matrix a [n][n] of Frobenius norm 1 by its square, scaled to norm 1 again.
 *   work [n][n] out     work array
 *   log_norm    in/out  logarithm of the product of all scalings: exp(log_norm) times `a` is
 *       a power of the original matrix
 * Returns the norm of the square before it was scaled.
 */
static double square_scaled(double *a, double *work, size_t n, double *log_norm)
{
    square(a, work, n);
    memcpy(a, work, n * n * sizeof *a);
    const double norm = normalise(a, n);
    *log_norm = 2 * *log_norm + log(norm);
    return norm;
}

double eigen_radius(double *a, double *work, size_t n, int squarings)
{
    double norm = normalise(a, n), log_norm = log(norm), power = 1;
    for (int k = 0; k < squarings && norm > 0; k++) {
        norm = square_scaled(a, work, n, &log_norm);
        power *= 2;
    }
    return norm > 0 ? exp(log_norm / power) : norm;
}

/* Return the magnitude of the mean of the eigenvalues of a matrix a [n][n], from its trace. */
static double mean_eigenvalue(const double *a, size_t n)
{
    double trace = 0;
    for (size_t i = 0; i < n; i++)
        trace += a[i * n + i];
    return fabs(trace) / (double)n;
}

bool eigen_decays(double *a, double *work, size_t n, int squarings)
{
    double norm = normalise(a, n), log_norm = log(norm);
    for (int k = 0; k < squarings && norm > 0 && !(log_norm < 0); k++) {
        if (log(mean_eigenvalue(a, n)) + log_norm > 0)
            return false;
        norm = square_scaled(a, work, n, &log_norm);
    }
    return norm == 0 || log_norm < 0;
}
