/* SPDX-License-Identifier: BSD-2-Clause */
/* Products and inverses of small dense matrices and vectors (dense.h). */
#include "dense.h"
#include <math.h>
#include <string.h>

double dense_dot(const double *x, const double *y, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += x[i] * y[i];
    return sum;
}

void dense_multiply(double *out, const double *a, const double *b, size_t order, bool transposed)
{
    memset(out, 0, order * order * sizeof *out);
    for (size_t i = 0; i < order; i++)
        for (size_t k = 0; k < order; k++) {
            const double factor = transposed ? a[k * order + i] : a[i * order + k];
            for (size_t j = 0; j < order && factor != 0; j++)
                out[i * order + j] += factor * b[k * order + j];
        }
}

void dense_symmetrise(double *a, size_t order)
{
    for (size_t i = 0; i < order; i++)
        for (size_t j = 0; j < i; j++)
            a[i * order + j] = a[j * order + i] = (a[i * order + j] + a[j * order + i]) / 2;
}

static void exchange_rows(double *a, size_t order, size_t i, size_t k)
{
    for (size_t j = 0; j < order && i != k; j++) {
        const double kept = a[i * order + j];
        a[i * order + j] = a[k * order + j];
        a[k * order + j] = kept;
    }
}

static size_t pivot_row(const double *a, size_t order, size_t column)
{
    size_t best = column;
    for (size_t i = column + 1; i < order; i++)
        if (fabs(a[i * order + column]) > fabs(a[best * order + column]))
            best = i;
    return best;
}

int dense_invert(double *a, double *x, size_t order)
{
    memset(x, 0, order * order * sizeof *x);
    for (size_t i = 0; i < order; i++)
        x[i * order + i] = 1;
    for (size_t p = 0; p < order; p++) {
        const size_t row = pivot_row(a, order, p);
        exchange_rows(a, order, p, row);
        exchange_rows(x, order, p, row);
        const double pivot = a[p * order + p];
        if (!(fabs(pivot) > 0) || !isfinite(pivot))
            return -1;
        for (size_t j = 0; j < order; j++) {
            a[p * order + j] /= pivot;
            x[p * order + j] /= pivot;
        }
        for (size_t i = 0; i < order; i++) {
            const double factor = i == p ? 0 : a[i * order + p];
            for (size_t j = 0; j < order && factor != 0; j++) {
                a[i * order + j] -= factor * a[p * order + j];
                x[i * order + j] -= factor * x[p * order + j];
            }
        }
    }
    return 0;
}
