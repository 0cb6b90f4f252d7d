/* SPDX-License-Identifier: BSD-2-Clause */
/* Inverse of a small positive definite matrix (invert.h). */
#include "invert.h"
#include <math.h>

int invert(double *matrix, int rows, int stride)
{
    for (int step = 0; step < rows; step++) {
        const double pivot = matrix[step * stride + step];
        if (!(pivot > 0) || !isfinite(pivot))
            return -1;
        matrix[step * stride + step] = 1;
        for (int j = 0; j < rows; j++)
            matrix[step * stride + j] /= pivot;
        for (int i = 0; i < rows; i++) {
            const double factor = matrix[i * stride + step];
            if (i == step)
                continue;
            matrix[i * stride + step] = 0;
            for (int j = 0; j < rows; j++)
                matrix[i * stride + j] -= factor * matrix[step * stride + j];
        }
    }
    return 0;
}
