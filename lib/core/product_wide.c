/* SPDX-License-Identifier: BSD-2-Clause */
/* Products of matrices and vectors for hosts with the vector unit AVX2 (product_wide.h). */
#include "product_wide.h"
#include <string.h>
#include "unrolled.h"

#if PZS_WIDE

#define AVX2 __attribute__((target("avx2")))
#define AVX512 __attribute__((target("avx512f")))
#define IN_VECTOR 4u /* number of reals in a vector register of the processor */
#define VECTORS 8u   /* number of vector registers in which sums of a matrix product are kept */
#define SPREAD (IN_VECTOR * VECTORS)
#define ROWS 8u /* number of matrix rows that one loop of a matrix product reads together */

typedef pzs_real wide_vector __attribute__((vector_size(IN_VECTOR * sizeof(pzs_real)),
                                            aligned(sizeof(pzs_real)), may_alias));

/* WIDE_BLOCK neighbouring entries of a matrix row, in one register of a processor with AVX-512. */
typedef pzs_real widest_vector __attribute__((vector_size(WIDE_BLOCK * sizeof(pzs_real)),
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
 * than SPREAD, the number of columns that fit into the registers.
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
 * Subtract chosen rows of a table, each multiplied by its factor, from SPREAD entries of a vector,
 * as many as fit into the registers.
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

/*
 * Copy WIDE_BLOCK entries of a vector to one array, and the entries multiplied by a factor to
 * another.
 *   copy, scaled [WIDE_BLOCK] out  entries, multiplied entries
 */
AVX2 static inline void copy_group(pzs_real *restrict copy, pzs_real *restrict scaled,
                                   const pzs_real *restrict vector, pzs_real factor)
{
    UNROLLED
    for (unsigned k = 0; k < WIDE_BLOCK / IN_VECTOR; k++) {
        const wide_vector entries = ((const wide_vector *)vector)[k];
        ((wide_vector *)copy)[k] = entries;
        ((wide_vector *)scaled)[k] = factor * entries;
    }
}

AVX2 void pzs_wide_group(pzs_real *restrict groups, pzs_real *restrict scaled,
                         const pzs_real *restrict table, size_t stride,
                         const pzs_real *restrict factor, size_t factor_stride, size_t count,
                         size_t columns)
{
    const size_t last = columns - columns % WIDE_BLOCK;
    for (size_t k = 0; k < count; k++, table += stride, factor += factor_stride) {
        size_t at = k * WIDE_BLOCK;
        for (size_t j = 0; j < last; j += WIDE_BLOCK, at += count * WIDE_BLOCK)
            copy_group(groups + at, scaled + at, table + j, *factor);
        if (last < columns) {
            pzs_real end[WIDE_BLOCK] = {0};
            memcpy(end, table + last, (columns - last) * sizeof *end);
            copy_group(groups + at, scaled + at, end, *factor);
        }
    }
}

/*
 * In the update of a symmetric matrix by products of vectors (pzs_wide_update_rows): subtract the
 * products of the entries of `count` vectors from four rows of a block of WIDE_BLOCK columns.
 */
AVX2 static void update_four_rows(pzs_real *block, size_t stride, const pzs_real *column,
                                  const pzs_real *row, size_t count)
{
    wide_vector low[4], high[4];
    UNROLLED
    for (unsigned line = 0; line < 4u; line++) {
        low[line] = *(const wide_vector *)(block + line * stride);
        high[line] = *(const wide_vector *)(block + line * stride + IN_VECTOR);
    }
    for (size_t k = 0; k < count; k++, column += WIDE_BLOCK, row += WIDE_BLOCK) {
        const wide_vector first = *(const wide_vector *)row;
        const wide_vector second = *(const wide_vector *)(row + IN_VECTOR);
        UNROLLED
        for (unsigned line = 0; line < 4u; line++) {
            low[line] -= column[line] * first;
            high[line] -= column[line] * second;
        }
    }
    UNROLLED
    for (unsigned line = 0; line < 4u; line++) {
        *(wide_vector *)(block + line * stride) = low[line];
        *(wide_vector *)(block + line * stride + IN_VECTOR) = high[line];
    }
}

/*
 * In the update of a symmetric matrix by products of vectors (pzs_wide_update_rows): subtract the
 * products of the entries of `count` vectors from a block of WIDE_BLOCK rows and columns. The block
 * to the right of the next one is fetched into the cache. The empty assembler statement keeps the
 * compiler from replacing a multiplication and a subtraction by one instruction that rounds only
 * once.
 */
AVX512 static void update_eight_rows(pzs_real *block, size_t stride, const pzs_real *column,
                                     const pzs_real *row, size_t count)
{
    widest_vector sum[WIDE_BLOCK];
    UNROLLED
    for (unsigned line = 0; line < WIDE_BLOCK; line++) {
        sum[line] = *(const widest_vector *)(block + line * stride);
        __builtin_prefetch(block + line * stride + 2 * WIDE_BLOCK, 1);
    }
    for (size_t k = 0; k < count; k++, column += WIDE_BLOCK, row += WIDE_BLOCK) {
        const widest_vector entries = *(const widest_vector *)row;
        UNROLLED
        for (unsigned line = 0; line < WIDE_BLOCK; line++) {
            widest_vector product = column[line] * entries;
            __asm__("" : "+v"(product));
            sum[line] -= product;
        }
    }
    UNROLLED
    for (unsigned line = 0; line < WIDE_BLOCK; line++)
        *(widest_vector *)(block + line * stride) = sum[line];
}

/*
 * In the update of a symmetric matrix by products of vectors (pzs_wide_update_rows): subtract the
 * products of the entries of `count` vectors from a block of WIDE_BLOCK rows and columns.
 */
static void update_block(pzs_real *block, size_t stride, const pzs_real *column,
                         const pzs_real *row, size_t count)
{
    if (__builtin_cpu_supports("avx512f")) {
        update_eight_rows(block, stride, column, row, count);
        return;
    }
    for (unsigned half = 0; half < WIDE_BLOCK; half += 4u)
        update_four_rows(block + half * stride, stride, column + half, row, count);
}

/* Copy a block of `rows` rows and `columns` columns of a matrix. */
static void copy_block(pzs_real *to, size_t to_stride, const pzs_real *from, size_t from_stride,
                       size_t rows, size_t columns)
{
    for (size_t line = 0; line < rows; line++)
        memcpy(to + line * to_stride, from + line * from_stride, columns * sizeof *to);
}

/*
 * In the update of a symmetric matrix by products of vectors (pzs_wide_update_rows): update a block
 * of at most WIDE_BLOCK rows and columns at the end of the matrix, in a copy with zeros beyond the
 * end.
 */
static void update_last_block(pzs_real *block, size_t stride, size_t rows, size_t columns,
                              const pzs_real *column, const pzs_real *row, size_t count)
{
    pzs_real whole[WIDE_BLOCK * WIDE_BLOCK] = {0};
    copy_block(whole, WIDE_BLOCK, block, stride, rows, columns);
    update_block(whole, WIDE_BLOCK, column, row, count);
    copy_block(block, stride, whole, WIDE_BLOCK, rows, columns);
}

void pzs_wide_update_rows(pzs_real *matrix, size_t stride, size_t size, size_t i,
                          const pzs_real *column, const pzs_real *row, size_t count)
{
    const size_t rows = size - i < WIDE_BLOCK ? size - i : WIDE_BLOCK;
    for (size_t j = 0; j <= i; j += WIDE_BLOCK) {
        pzs_real *block = matrix + i * stride + j;
        if (rows == WIDE_BLOCK)
            update_block(block, stride, column + i * count, row + j * count, count);
        else
            update_last_block(block, stride, rows, j < i ? WIDE_BLOCK : rows, column + i * count,
                              row + j * count, count);
    }
}

/*
 * When the lower triangle of a symmetric matrix is copied to the upper one, few columns are copied
 * at a time, so that the rows to which they go stay in the cache.
 */
void pzs_wide_mirror(pzs_real *matrix, size_t stride, size_t size)
{
    for (size_t first = 0; first < size; first += WIDE_BLOCK)
        for (size_t i = first + 1u; i < size; i++)
            for (size_t j = first; j < i && j < first + WIDE_BLOCK; j++)
                matrix[j * stride + i] = matrix[i * stride + j];
}

#endif
