/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Products of sparse matrices and vectors (product.h). The terms of each sum run in the order of
 * the products of full matrices. The terms that are left out are zeros, which change no bit of a
 * sum.
 */
#include <string.h>
#include "product.h"
#include "product_inline.h"

/*
 * Scalar product of a sparse row of `count` entries with a vector: one sum in ascending order of
 * the columns.
 */
static pzs_real short_row(const uint16_t *column, const pzs_real *value, size_t count,
                          const pzs_real *vector)
{
    pzs_real sum = 0;
    for (size_t k = 0; k < count; k++)
        sum += value[k] * vector[column[k]];
    return sum;
}

/*
 * Scalar product of a sparse row of `count` entries with a vector of at least PRODUCT_LONG_ROW
 * entries (`cols`). The column of an entry selects the partial sum to which its product is added,
 * as in pzs_product_dot, so that the result has the bits of the full row.
 */
static pzs_real long_row(const uint16_t *column, const pzs_real *value, size_t count,
                         const pzs_real *vector, size_t cols)
{
    const size_t grouped = cols / PRODUCT_LANES * PRODUCT_LANES,
                 half = cols - grouped >= 4u ? grouped + 4u : grouped;
    pzs_real sum[PRODUCT_LANES] = {0};
    size_t k = 0;
    for (; k < count && column[k] < half; k++)
        sum[column[k] % PRODUCT_LANES] += value[k] * vector[column[k]];
    for (; k < count; k++)
        sum[0] += value[k] * vector[column[k]];
    return PRODUCT_ADD_LANES(sum);
}

void pzs_product_sparse(pzs_real *restrict product, const pzs_rows *rows,
                        const pzs_real *restrict vector, size_t cols)
{
    for (size_t i = 0; i < rows->count; i++) {
        const uint32_t first = rows->start[i], count = rows->start[i + 1u] - first;
        const uint16_t *column = rows->dof + first;
        const pzs_real *value = rows->value + first;
        product[i] = cols < PRODUCT_LONG_ROW ? short_row(column, value, count, vector)
                                             : long_row(column, value, count, vector, cols);
    }
}

void pzs_product_sum_sparse(pzs_real *restrict product, const pzs_rows *rows,
                            const pzs_real *restrict vector, size_t cols)
{
    memset(product, 0, cols * sizeof *product);
    for (size_t i = 0; i < rows->count; i++) {
        const uint32_t first = rows->start[i], count = rows->start[i + 1u] - first;
        const uint16_t *column = rows->dof + first;
        const pzs_real *value = rows->value + first, factor = vector[i];
        for (uint32_t k = 0; k < count; k++)
            product[column[k]] += factor * value[k];
    }
}
