/* SPDX-License-Identifier: BSD-2-Clause */
/* Static response of a linear structure to its inputs (influence_sum.h). */
#include "influence_sum.h"

void influence_sum(const double *influence, const double *input, size_t rows, size_t inputs,
                   double *sum)
{
    for (size_t i = 0; i < rows; i++, influence += inputs) {
        sum[i] = 0;
        for (size_t k = 0; k < inputs; k++)
            sum[i] += influence[k] * input[k];
    }
}
