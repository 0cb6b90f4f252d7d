/* SPDX-License-Identifier: BSD-2-Clause */
/* Products of matrices and vectors for hosts with the vector unit AVX2 (product_wide.h). */
#include "product_wide.h"
#include <string.h>
#include "product_inline.h"
#include "unrolled.h"

#if PZS_WIDE

#define AVX2 __attribute__((target("avx2")))
#define AVX512 __attribute__((target("avx512f")))
#define IN_VECTOR 4u /* number of reals in a vector register of the processor */
#define VECTORS 8u   /* number of vector registers in which sums of a matrix product are kept */
#define SPREAD (IN_VECTOR * VECTORS)
#define ROWS 8u /* number of matrix rows that one loop of a matrix product reads together */

/*
 * Number of columns from which on a table is read as it lies in memory: ROWS rows at a time, from
 * the first column to the last. A table with fewer columns is read in groups of SPREAD columns,
 * whose sums stay in registers: each group from the first row to the last.
 */
#define LEAST_WIDE 64u

typedef pzs_real whole_vector __attribute__((vector_size(IN_VECTOR * sizeof(pzs_real))));
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

/* One bit pattern for each entry of a vector register: all bits are 1 if the entry is used. */
typedef long long lane_mask __attribute__((vector_size(IN_VECTOR * sizeof(long long))));

/* Return the mask of the entries in use of the last, perhaps incomplete, vector of `cols` columns.
 */
AVX2 static inline lane_mask last_mask(size_t cols)
{
    const long long used = (long long)((cols - 1u) % IN_VECTOR);
    return (lane_mask){0, 1, 2, 3} <= used;
}

AVX2 static inline wide_vector load_some(const pzs_real *from, lane_mask mask)
{
    return (wide_vector)__builtin_ia32_maskloadpd256((const whole_vector *)(const void *)from,
                                                     mask);
}

/*
 * Store the entries in use of the last vector of `cols` columns. Processors take longer for a store
 * with a mask than for a few stores of one number.
 */
AVX2 static inline void store_some(pzs_real *to, size_t cols, wide_vector entries)
{
    const size_t used = (cols - 1u) % IN_VECTOR + 1u;
    if (used == IN_VECTOR) {
        *(wide_vector *)to = entries;
        return;
    }
    to[0] = entries[0];
    if (used > 1u)
        to[1] = entries[1];
    if (used > 2u)
        to[2] = entries[2];
}

/*
 * Define a function that sums `rows` rows of a table, each multiplied by its factor, in COUNT
 * vector registers. It may read beyond the end of every row except the last; what it reads there is
 * not used.
 *   cols in  number of columns; they fill COUNT registers, the last one at least in part
 */
#define SUM_VECTORS(COUNT)                                                                         \
    AVX2 static void sum_vectors_##COUNT(                                                          \
        pzs_real *restrict product, const pzs_real *restrict table, size_t stride,                 \
        const pzs_real *restrict vector, size_t rows, size_t cols)                                 \
    {                                                                                              \
        const lane_mask mask = last_mask(cols);                                                    \
        wide_vector sum[COUNT];                                                                    \
        size_t i = 0;                                                                              \
        UNROLLED                                                                                   \
        for (unsigned k = 0; k < (COUNT); k++)                                                     \
            sum[k] = (wide_vector){0};                                                             \
        UNROLLED_TWICE                                                                             \
        for (; i + 1u < rows; i++, table += stride) {                                              \
            UNROLLED                                                                               \
            for (unsigned k = 0; k < (COUNT); k++)                                                 \
                sum[k] += vector[i] * ((const wide_vector *)table)[k];                             \
        }                                                                                          \
        for (; i < rows; i++) {                                                                    \
            UNROLLED                                                                               \
            for (unsigned k = 0; k + 1u < (COUNT); k++)                                            \
                sum[k] += vector[i] * ((const wide_vector *)table)[k];                             \
            sum[(COUNT)-1u] += vector[i] * load_some(table + ((COUNT)-1u) * IN_VECTOR, mask);      \
        }                                                                                          \
        UNROLLED                                                                                   \
        for (unsigned k = 0; k + 1u < (COUNT); k++)                                                \
            ((wide_vector *)product)[k] = sum[k];                                                  \
        store_some(product + ((COUNT)-1u) * IN_VECTOR, cols, sum[(COUNT)-1u]);                     \
    }

SUM_VECTORS(1)
SUM_VECTORS(2)
SUM_VECTORS(3)
SUM_VECTORS(4)
SUM_VECTORS(5)
SUM_VECTORS(6)
SUM_VECTORS(7)
SUM_VECTORS(8)

typedef void sum_vectors(pzs_real *restrict product, const pzs_real *restrict table, size_t stride,
                         const pzs_real *restrict vector, size_t rows, size_t cols);

/*
 * Compute the sum of the rows of a table, each multiplied by its factor, for up to SPREAD columns,
 * as many as fit into the registers.
 */
AVX2 static void sum_few(pzs_real *restrict product, const pzs_real *restrict table, size_t stride,
                         const pzs_real *restrict vector, size_t rows, size_t cols)
{
    static sum_vectors *const sum[VECTORS] = {sum_vectors_1, sum_vectors_2, sum_vectors_3,
                                              sum_vectors_4, sum_vectors_5, sum_vectors_6,
                                              sum_vectors_7, sum_vectors_8};
    sum[(cols - 1u) / IN_VECTOR](product, table, stride, vector, rows, cols);
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
    for (size_t j = 0; cols < LEAST_WIDE && j < cols; j += SPREAD)
        sum_few(product + j, table + j, stride, vector, rows,
                cols - j < SPREAD ? cols - j : SPREAD);
    if (cols < LEAST_WIDE)
        return;
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
 * Define a function for pzs_wide_update_whole: set columns of a matrix to zero, then subtract from
 * each entry i, j the sum over q of column_q[i] * row_q[j]. It updates neighbouring columns that
 * fill COUNT vector registers.
 *   column in  column_q[0], the first entries of the vectors, `stride` reals apart
 *   row    in  row_q[j] for the first of the columns, `stride` reals apart
 *   zero   in  [count] indices of the columns to be set to zero, counted from the first column
 */
#define UPDATE_VECTORS(COUNT)                                                                      \
    AVX2 static void update_vectors_##COUNT(                                                       \
        pzs_real *restrict matrix, size_t stride, size_t rows, const pzs_real *restrict column,    \
        const pzs_real *restrict row, const long long *restrict zero, size_t count)                \
    {                                                                                              \
        lane_mask kept[COUNT];                                                                     \
        UNROLLED                                                                                   \
        for (unsigned k = 0; k < (COUNT); k++)                                                     \
            kept[k] = (lane_mask){-1, -1, -1, -1};                                                 \
        for (size_t q = 0; q < count; q++) {                                                       \
            UNROLLED                                                                               \
            for (unsigned k = 0; k < (COUNT); k++)                                                 \
                kept[k] &= (lane_mask){0, 1, 2, 3} + (long long)(IN_VECTOR * k) != zero[q];        \
        }                                                                                          \
        for (size_t i = 0; i < rows; i++, matrix += stride) {                                      \
            wide_vector sum[COUNT];                                                                \
            UNROLLED                                                                               \
            for (unsigned k = 0; k < (COUNT); k++)                                                 \
                sum[k] = (wide_vector)((lane_mask)((const wide_vector *)matrix)[k] & kept[k]);     \
            const pzs_real *factor = column + i;                                                   \
            const wide_vector *entry = (const wide_vector *)row;                                   \
            UNROLLED_TWICE                                                                         \
            for (size_t q = 0; q < count; q++) {                                                   \
                UNROLLED                                                                           \
                for (unsigned k = 0; k < (COUNT); k++)                                             \
                    sum[k] -= *factor * entry[k];                                                  \
                factor += stride;                                                                  \
                entry += stride / IN_VECTOR;                                                       \
            }                                                                                      \
            UNROLLED                                                                               \
            for (unsigned k = 0; k < (COUNT); k++)                                                 \
                ((wide_vector *)matrix)[k] = sum[k];                                               \
        }                                                                                          \
    }

UPDATE_VECTORS(1)
UPDATE_VECTORS(2)
UPDATE_VECTORS(3)
UPDATE_VECTORS(4)
UPDATE_VECTORS(5)
UPDATE_VECTORS(6)
UPDATE_VECTORS(7)
UPDATE_VECTORS(8)

typedef void update_vectors(pzs_real *restrict matrix, size_t stride, size_t rows,
                            const pzs_real *restrict column, const pzs_real *restrict row,
                            const long long *restrict zero, size_t count);

void pzs_wide_update_whole(pzs_real *restrict matrix, size_t stride, size_t rows,
                           const pzs_real *restrict column, const pzs_real *restrict row,
                           long long *restrict zero, size_t count)
{
    static update_vectors *const update[VECTORS] = {
        update_vectors_1, update_vectors_2, update_vectors_3, update_vectors_4,
        update_vectors_5, update_vectors_6, update_vectors_7, update_vectors_8};
    for (size_t j = 0; j < stride; j += SPREAD) {
        const size_t cols = stride - j < SPREAD ? stride - j : SPREAD;
        update[cols / IN_VECTOR - 1u](matrix + j, stride, rows, column, row + j, zero, count);
        for (size_t q = 0; q < count; q++)
            zero[q] -= (long long)SPREAD;
    }
}

/*
 * Define a function that subtracts chosen rows of a table, each multiplied by its factor, from a
 * vector that fills COUNT registers, the last one at least in part.
 *   cols in  number of entries of the vector
 */
#define SUBTRACT_CHOSEN(COUNT)                                                                     \
    AVX2 static void subtract_chosen_##COUNT(                                                      \
        pzs_real *restrict vector, const pzs_real *restrict table, size_t stride,                  \
        const uint16_t *index, const pzs_real *restrict factor, size_t count, size_t cols)         \
    {                                                                                              \
        const lane_mask mask = last_mask(cols);                                                    \
        wide_vector sum[COUNT];                                                                    \
        UNROLLED                                                                                   \
        for (unsigned k = 0; k + 1u < (COUNT); k++)                                                \
            sum[k] = ((const wide_vector *)vector)[k];                                             \
        sum[(COUNT)-1u] = load_some(vector + ((COUNT)-1u) * IN_VECTOR, mask);                      \
        for (size_t q = 0; q < count; q++) {                                                       \
            const pzs_real *row = table + index[q] * stride;                                       \
            UNROLLED                                                                               \
            for (unsigned k = 0; k + 1u < (COUNT); k++)                                            \
                sum[k] -= factor[q] * ((const wide_vector *)row)[k];                               \
            sum[(COUNT)-1u] -= factor[q] * load_some(row + ((COUNT)-1u) * IN_VECTOR, mask);        \
        }                                                                                          \
        UNROLLED                                                                                   \
        for (unsigned k = 0; k + 1u < (COUNT); k++)                                                \
            ((wide_vector *)vector)[k] = sum[k];                                                   \
        store_some(vector + ((COUNT)-1u) * IN_VECTOR, cols, sum[(COUNT)-1u]);                      \
    }

SUBTRACT_CHOSEN(1)
SUBTRACT_CHOSEN(2)
SUBTRACT_CHOSEN(3)
SUBTRACT_CHOSEN(4)
SUBTRACT_CHOSEN(5)
SUBTRACT_CHOSEN(6)
SUBTRACT_CHOSEN(7)
SUBTRACT_CHOSEN(8)

typedef void subtract_chosen(pzs_real *restrict vector, const pzs_real *restrict table,
                             size_t stride, const uint16_t *index, const pzs_real *restrict factor,
                             size_t count, size_t cols);

void pzs_wide_subtract_rows(pzs_real *restrict vector, const pzs_real *restrict table,
                            size_t stride, const uint16_t *index, const pzs_real *restrict factor,
                            size_t count, size_t cols)
{
    static subtract_chosen *const subtract[VECTORS] = {
        subtract_chosen_1, subtract_chosen_2, subtract_chosen_3, subtract_chosen_4,
        subtract_chosen_5, subtract_chosen_6, subtract_chosen_7, subtract_chosen_8};
    for (size_t j = 0; j < cols; j += SPREAD) {
        const size_t some = cols - j < SPREAD ? cols - j : SPREAD;
        subtract[(some - 1u) / IN_VECTOR](vector + j, table + j, stride, index, factor, count,
                                          some);
    }
}

AVX2 pzs_real pzs_wide_dot(const pzs_real *left, const pzs_real *right, size_t count)
{
    return product_dot(left, right, count);
}

AVX2 pzs_real pzs_wide_weigh(pzs_real *restrict weighted_difference,
                             const pzs_real *restrict weight, const pzs_real *restrict left,
                             const pzs_real *restrict right, size_t count)
{
    return product_weigh(weighted_difference, weight, left, right, count);
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
 * Part of pzs_wide_update_rows: update four rows of a block of WIDE_BLOCK columns by rank-one
 * products. From each entry i, j of the block the sum over k of column_k[i] * row_k[j] is
 * subtracted, for `count` pairs of vectors column_k and row_k.
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
 * Subtract the products of the entries of `count` vectors from a block of WIDE_BLOCK rows and
 * columns, as a part of pzs_wide_update_rows.
 */
AVX512 static void update_eight_rows(pzs_real *block, size_t stride, const pzs_real *column,
                                     const pzs_real *row, size_t count)
{
    widest_vector sum[WIDE_BLOCK];
    UNROLLED
    for (unsigned line = 0; line < WIDE_BLOCK; line++) {
        sum[line] = *(const widest_vector *)(block + line * stride);
        // Fetch the next block but one of the matrix row into the cache ahead of its use.
        __builtin_prefetch(block + line * stride + 2 * WIDE_BLOCK, 1);
    }
    for (size_t k = 0; k < count; k++, column += WIDE_BLOCK, row += WIDE_BLOCK) {
        const widest_vector entries = *(const widest_vector *)row;
        UNROLLED
        for (unsigned line = 0; line < WIDE_BLOCK; line++) {
            // Keep the product in a variable of its own. The compiler could otherwise fuse
            // multiplication and subtraction into one instruction, which rounds only once and
            // changes the bits of the result.
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
 * Update a block at the end of a symmetric matrix, with fewer rows or columns than WIDE_BLOCK, by
 * products of vectors (part of pzs_wide_update_rows). The block is copied into a larger array of
 * WIDE_BLOCK x WIDE_BLOCK entries, updated there, and copied back.
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
