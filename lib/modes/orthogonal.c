/* SPDX-License-Identifier: BSD-2-Clause */
/* Gram-Schmidt orthogonalisation (orthogonal.h). */
#include "orthogonal.h"
#include "../core/linalg.h"

#if PZS_MODES

/*
 * Number of rows whose scalar products one loop computes: these sums do not depend on each other,
 * so that the processor computes them at the same time.
 */
enum { GROUP = 4 };

/*
 * Subtract the components along GROUP rows.
 *   part [GROUP] out  the components
 */
static void remove_group(const pzs_real *row, uint32_t length, const pzs_real *weighted,
                         pzs_real *vector, pzs_real *part)
{
    pzs_real sum[GROUP] = {0};
    for (uint32_t k = 0; k < length; k++)
        for (uint32_t i = 0; i < GROUP; i++)
            sum[i] += row[(size_t)i * length + k] * weighted[k];
    for (uint32_t k = 0; k < length; k++)
        for (uint32_t i = 0; i < GROUP; i++)
            vector[k] -= sum[i] * row[(size_t)i * length + k];
    for (uint32_t i = 0; i < GROUP; i++)
        part[i] = sum[i];
}

/* Subtract the component along one row, and return it. */
static pzs_real remove_row(const pzs_real *row, uint32_t length, const pzs_real *weighted,
                           pzs_real *vector)
{
    const pzs_real sum = pzs_linalg_inner(row, weighted, length);
    for (uint32_t k = 0; k < length; k++)
        vector[k] -= sum * row[k];
    return sum;
}

void pzs_orthogonalise(const pzs_real *basis, uint32_t rows, uint32_t length,
                       const pzs_real *weighted, pzs_real *vector, pzs_real *part)
{
    for (uint32_t first = 0; first < rows;) {
        const uint32_t count = first + GROUP <= rows ? GROUP : 1;
        const pzs_real *row = basis + (size_t)first * length;
        pzs_real removed[GROUP];
        if (count == GROUP)
            remove_group(row, length, weighted, vector, removed);
        else
            removed[0] = remove_row(row, length, weighted, vector);
        for (uint32_t i = 0; i < count && part; i++)
            part[first + i] += removed[i];
        first += count;
    }
}

#endif
