/* SPDX-License-Identifier: BSD-2-Clause */
/* Products for hosts with the vector unit AVX2 (product_wide.h). */
#include "product_wide.h"
#include "unrolled.h"

#if PZS_WIDE

#define AVX2 __attribute__((target("avx2")))
#define IN_VECTOR 4u /* number of reals in a vector register of the processor */
#define VECTORS 8u   /* number of vector registers in which sums of a matrix product are kept */
#define SPREAD (IN_VECTOR * VECTORS)
#define ROWS 8u /* number of matrix rows that one loop of a matrix product reads together */

typedef pzs_real wide_vector __attribute__((vector_size(IN_VECTOR * sizeof(pzs_real)),
                                            aligned(sizeof(pzs_real)), may_alias));

/*
 * Add `rows` rows of a table, each multiplied by its factor, to SPREAD sums, the number of columns
 * that fit into the registers.
 */
AVX2 static void add_to_many(pzs_real *sums, const pzs_real *table, size_t stride,
                             const pzs_real *vector, size_t rows)
{
    wide_vector sum[VECTORS];
    UNROLLED
    for (unsigned k = 0; k < VECTORS; k++)
        sum[k] = ((const wide_vector *)sums)[k];
    for (size_t i = 0; i < rows; i++, table += stride) {
        UNROLLED
        for (unsigned k = 0; k < VECTORS; k++)
            sum[k] += vector[i] * ((const wide_vector *)table)[k];
    }
    UNROLLED
    for (unsigned k = 0; k < VECTORS; k++)
        ((wide_vector *)sums)[k] = sum[k];
}

/*
 * Add `rows` rows of a table, each multiplied by its factor, to `cols` sums, which must be fewer
 * than SPREAD.
 */
AVX2 static void add_to_few(pzs_real *restrict sums, const pzs_real *restrict table, size_t stride,
                            const pzs_real *restrict vector, size_t rows, size_t cols)
{
    size_t j = 0;
    for (; j + IN_VECTOR <= cols; j += IN_VECTOR) {
        wide_vector sum = *(const wide_vector *)(sums + j);
        for (size_t i = 0; i < rows; i++)
            sum += vector[i] * *(const wide_vector *)(table + i * stride + j);
        *(wide_vector *)(sums + j) = sum;
    }
    for (; j < cols; j++)
        for (size_t i = 0; i < rows; i++)
            sums[j] += vector[i] * table[i * stride + j];
}

void pzs_wide_sum_rows(pzs_real *restrict product, const pzs_real *restrict table, size_t stride,
                       const pzs_real *restrict vector, size_t rows, size_t cols)
{
    for (size_t j = 0; j < cols; j++)
        product[j] = 0;
    for (size_t i = 0; i < rows; i += ROWS) {
        const size_t some = rows - i < ROWS ? rows - i : ROWS;
        size_t j = 0;
        for (; j + SPREAD <= cols; j += SPREAD)
            add_to_many(product + j, table + i * stride + j, stride, vector + i, some);
        add_to_few(product + j, table + i * stride + j, stride, vector + i, some, cols - j);
    }
}

/*
 * Subtract chosen rows of a table, each multiplied by its factor, from SPREAD entries of a vector.
 */
AVX2 static void subtract_from_many(pzs_real *vector, const pzs_real *table, size_t stride,
                                    const uint16_t *index, const pzs_real *factor, size_t count)
{
    wide_vector sum[VECTORS];
    UNROLLED
    for (unsigned k = 0; k < VECTORS; k++)
        sum[k] = ((const wide_vector *)vector)[k];
    for (size_t q = 0; q < count; q++) {
        const wide_vector *row = (const wide_vector *)(table + index[q] * stride);
        UNROLLED
        for (unsigned k = 0; k < VECTORS; k++)
            sum[k] -= factor[q] * row[k];
    }
    UNROLLED
    for (unsigned k = 0; k < VECTORS; k++)
        ((wide_vector *)vector)[k] = sum[k];
}

AVX2 void pzs_wide_subtract_rows(pzs_real *restrict vector, const pzs_real *restrict table,
                                 size_t stride, const uint16_t *index,
                                 const pzs_real *restrict factor, size_t count, size_t cols)
{
    size_t j = 0;
    for (; j + SPREAD <= cols; j += SPREAD)
        subtract_from_many(vector + j, table + j, stride, index, factor, count);
    for (; j + IN_VECTOR <= cols; j += IN_VECTOR) {
        wide_vector sum = *(const wide_vector *)(vector + j);
        for (size_t q = 0; q < count; q++)
            sum -= factor[q] * *(const wide_vector *)(table + index[q] * stride + j);
        *(wide_vector *)(vector + j) = sum;
    }
    for (; j < cols; j++)
        for (size_t q = 0; q < count; q++)
            vector[j] -= factor[q] * table[index[q] * stride + j];
}

AVX2 void pzs_wide_dot(pzs_real sum[8], const pzs_real *left, const pzs_real *right, size_t count)
{
    wide_vector low = *(const wide_vector *)sum, high = *(const wide_vector *)(sum + IN_VECTOR);
    for (size_t i = 0; i < count; i += 2u * IN_VECTOR) {
        low += *(const wide_vector *)(left + i) * *(const wide_vector *)(right + i);
        high += *(const wide_vector *)(left + i + IN_VECTOR) *
                *(const wide_vector *)(right + i + IN_VECTOR);
    }
    *(wide_vector *)sum = low;
    *(wide_vector *)(sum + IN_VECTOR) = high;
}

AVX2 void pzs_wide_update(pzs_real *block, size_t stride, const pzs_real *column,
                          const pzs_real *row, const pzs_real *sign, size_t sign_stride,
                          size_t count)
{
    wide_vector low[4], high[4];
    UNROLLED
    for (unsigned line = 0; line < 4u; line++) {
        low[line] = *(const wide_vector *)(block + line * stride);
        high[line] = *(const wide_vector *)(block + line * stride + IN_VECTOR);
    }
    for (size_t k = 0; k < count;
         k++, column += WIDE_BLOCK, row += WIDE_BLOCK, sign += sign_stride) {
        const wide_vector first = *(const wide_vector *)row;
        const wide_vector second = *(const wide_vector *)(row + IN_VECTOR);
        UNROLLED
        for (unsigned line = 0; line < 4u; line++) {
            const pzs_real factor = *sign * column[line];
            low[line] -= factor * first;
            high[line] -= factor * second;
        }
    }
    UNROLLED
    for (unsigned line = 0; line < 4u; line++) {
        *(wide_vector *)(block + line * stride) = low[line];
        *(wide_vector *)(block + line * stride + IN_VECTOR) = high[line];
    }
}

#endif
