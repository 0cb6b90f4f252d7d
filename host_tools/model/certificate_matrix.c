/* SPDX-License-Identifier: BSD-2-Clause */
/* Bars of the margin against errors of the influence matrix (certificate_matrix.h). */
#include "certificate_matrix.h"
#include <math.h>

double certificate_matrix_bar(const certificate_matrix *matrix)
{
    const double bar = matrix->is_measured ? CERTIFICATE_MATRIX_BAR : CERTIFICATE_MODEL_BAR;
    return fmax(bar, matrix->stated);
}

bool certificate_matrix_refuses(const certificate_matrix *matrix)
{
    return matrix->is_made && matrix->is_measured &&
           (matrix->is_unstable || matrix->margin < matrix->stated);
}
