/* SPDX-License-Identifier: BSD-2-Clause */
/* Inverse of a small positive definite matrix (invert.h). */
#include "invert.h"
#include <math.h>

int invert(double *a, int n, int stride)
{
    for (int p = 0; p < n; p++) {
        const double pivot = a[p * stride + p];
        if (!(pivot > 0) || !isfinite(pivot))
            return -1;
        a[p * stride + p] = 1;
        for (int j = 0; j < n; j++)
            a[p * stride + j] /= pivot;
        for (int i = 0; i < n; i++) {
            const double factor = a[i * stride + p];
            if (i == p)
                continue;
            a[i * stride + p] = 0;
            for (int j = 0; j < n; j++)
                a[i * stride + j] -= factor * a[p * stride + j];
        }
    }
    return 0;
}
