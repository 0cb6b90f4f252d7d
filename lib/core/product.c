/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Products of matrices and vectors whose results have the same bits at any vector width
 * (product.h).
 */
#include <string.h>
#include "product.h"
#include "lane.h"
#include "product_inline.h"
#include "product_vfp.h"
#include "product_wide.h"
#include "unrolled.h"

/*
 * Numbers of matrix columns that one loop over the matrix rows processes, chosen so that the
 * partial sums fit into the registers.
 *   FOURS  groups of four columns
 *   FEW    groups of four columns, where fewer than FOURS groups are left
 *   MANY   tiles of PZS_TILE columns
 *   SOME   tiles of PZS_TILE columns, where fewer than MANY tiles are left
 */
#define FOURS PZS_BY_BITS(7, 3)
#define FEW PZS_BY_BITS(3, 2)
#define MANY PZS_BY_BITS(7, PZS_BY_TILE(3, 7, 7))
#define SOME PZS_BY_TILE(PZS_BY_BITS(3, 2), 4, 4)

#if !PZS_VFP

/* ---- table times vector ----------------------------------------------------- */

/*
 * Whether column k of a group of COUNT matrix columns exists. Only the last three columns of a
 * group can be missing, so the compiler compares only these with the number of columns `cols`.
 */
#define IS_COLUMN(k, COUNT) ((k) < (COUNT)-3u || (k) < cols)

/*
 * Define a function that computes product [rows] = from [rows] + table [rows][cols] times vector
 * [cols], for at most COUNT columns, with the vector in registers. `from` is one number for all
 * rows (step = 0) or has an entry for each row (step = 1).
 */
#define MULTIPLY(name, COUNT)                                                                      \
    static void name(pzs_real *product, const pzs_real *from, size_t step, const pzs_real *table,  \
                     size_t stride, const pzs_real *vector, size_t rows, size_t cols)              \
    {                                                                                              \
        pzs_real part[COUNT];                                                                      \
        UNROLLED                                                                                   \
        for (unsigned k = 0; k < (COUNT); k++)                                                     \
            part[k] = vector[k];                                                                   \
        for (size_t i = 0; i < rows; i++, table += stride, from += step) {                         \
            pzs_real sum = *from;                                                                  \
            UNROLLED                                                                               \
            for (unsigned k = 0; k < (COUNT); k++)                                                 \
                if (IS_COLUMN(k, COUNT))                                                           \
                    sum += table[k] * part[k];                                                     \
            product[i] = sum;                                                                      \
        }                                                                                          \
    }

MULTIPLY(multiply_many, 4u * FOURS)
MULTIPLY(multiply_some, 4u * FEW)
MULTIPLY(multiply_four, 4u)

/*
 * Compute product [rows] = from + table [rows][cols] times vector [cols], one group of columns
 * after the other. `from` is one number for all rows (step = 0) or has [rows] entries (step = 1).
 */
static void multiply(pzs_real *product, const pzs_real *from, size_t step, const pzs_real *table,
                     const pzs_real *vector, size_t rows, size_t cols)
{
    for (size_t j = 0, now; j < cols; j += now) {
        const size_t left = cols - j, fours = (left + 3u) / 4u;
        now = 4u;
        if (fours >= FOURS)
            now = 4u * FOURS;
        else if (fours >= FEW)
            now = 4u * FEW;
        now = now < left ? now : left;
        if (fours >= FOURS)
            multiply_many(product, from, step, table + j, cols, vector + j, rows, now);
        else if (fours >= FEW)
            multiply_some(product, from, step, table + j, cols, vector + j, rows, now);
        else
            multiply_four(product, from, step, table + j, cols, vector + j, rows, now);
        from = product;
        step = 1;
    }
}

/* ---- sums of rows -------------------------------------------------------------- */

#if PZS_TILE == 4

/*
 * Define a function that computes product [cols] = sum over the rows i of vector_i times row i of
 * the table, for COUNT tiles of four columns; only the last tile may be incomplete.
 */
#define SUM_TILES(name, COUNT)                                                                     \
    static void name(pzs_real *restrict product, const pzs_real *restrict table, size_t stride,    \
                     const pzs_real *restrict vector, size_t rows, size_t cols)                    \
    {                                                                                              \
        pzs_real sum[4 * (COUNT)];                                                                 \
        UNROLLED                                                                                   \
        for (unsigned k = 0; k < 4u * (COUNT); k++)                                                \
            sum[k] = 0;                                                                            \
        for (size_t i = 0; i < rows; i++, table += stride) {                                       \
            const pzs_real factor = vector[i];                                                     \
            UNROLLED                                                                               \
            for (unsigned k = 0; k < 4u * (COUNT); k++)                                            \
                if (IS_COLUMN(k, 4u * (COUNT)))                                                    \
                    sum[k] += factor * table[k];                                                   \
        }                                                                                          \
        UNROLLED                                                                                   \
        for (unsigned k = 0; k < 4u * (COUNT); k++)                                                \
            if (IS_COLUMN(k, 4u * (COUNT)))                                                        \
                product[k] = sum[k];                                                               \
    }

#else

/*
 * Index of the first of the IN_LANE matrix columns whose sums are in vector register k, in a loop
 * over COUNT tiles of PZS_TILE columns. The last tile begins with column `last` and ends with the
 * last column. It may overlap the tile before it; both then compute the same sums in the shared
 * columns.
 */
#define LANE_AT(k, COUNT)                                                                          \
    ((k) / IN_TILE + 1u < (COUNT) ? (k)*IN_LANE : last + (k) % IN_TILE * IN_LANE)

/*
 * Define a function that computes product [cols] = sum over the rows i of vector_i times row i of
 * the table. The sums of `cols` columns, in COUNT tiles of PZS_TILE columns, stay in vector
 * registers.
 */
#define SUM_TILES(name, COUNT)                                                                     \
    static void name(pzs_real *restrict product, const pzs_real *restrict table, size_t stride,    \
                     const pzs_real *restrict vector, size_t rows, size_t cols)                    \
    {                                                                                              \
        lane sum[(COUNT)*IN_TILE];                                                                 \
        const size_t last = cols - PZS_TILE;                                                       \
        UNROLLED                                                                                   \
        for (unsigned k = 0; k < (COUNT)*IN_TILE; k++)                                             \
            sum[k] = (lane){0};                                                                    \
        for (size_t i = 0; i < rows; i++, table += stride) {                                       \
            UNROLLED                                                                               \
            for (unsigned k = 0; k < (COUNT)*IN_TILE; k++)                                         \
                sum[k] += vector[i] * *(const lane *)(table + LANE_AT(k, COUNT));                  \
        }                                                                                          \
        UNROLLED                                                                                   \
        for (unsigned k = 0; k < (COUNT)*IN_TILE; k++)                                             \
            *(lane *)(product + LANE_AT(k, COUNT)) = sum[k];                                       \
    }

#endif

SUM_TILES(sum_many, MANY)
SUM_TILES(sum_some, SOME)
SUM_TILES(sum_one, 1)

/*
 * Compute product [cols] = sum over the rows i of vector_i times row i of the table, for fewer than
 * PZS_TILE columns.
 */
static void sum_few(pzs_real *restrict product, const pzs_real *restrict table, size_t stride,
                    const pzs_real *restrict vector, size_t rows, size_t cols)
{
    for (size_t j = 0; j < cols; j++) {
        product[j] = 0;
        for (size_t i = 0; i < rows; i++)
            product[j] += vector[i] * table[i * stride + j];
    }
}

/*
 * Compute product [cols] = sum over the rows i of vector[i] times row i of the table, one group of
 * columns after the other. The rows of the table are `stride` numbers apart.
 */
static void sum_rows(pzs_real *restrict product, const pzs_real *restrict table, size_t stride,
                     const pzs_real *restrict vector, size_t rows, size_t cols)
{
    if (PZS_TILE > 4 && cols < PZS_TILE) {
        sum_few(product, table, stride, vector, rows, cols);
        return;
    }
    for (size_t j = 0, end; j < cols; j = end) {
        const size_t tiles = (cols - j + PZS_TILE - 1u) / PZS_TILE;
        size_t now = 1u;
        if (tiles >= MANY)
            now = MANY;
        else if (tiles >= SOME)
            now = SOME;
        end = j + now * PZS_TILE < cols ? j + now * PZS_TILE : cols;
        const size_t from = PZS_TILE == 4 || now > 1u ? j : end - PZS_TILE;
        if (now == MANY)
            sum_many(product + from, table + from, stride, vector, rows, end - from);
        else if (now == SOME)
            sum_some(product + from, table + from, stride, vector, rows, end - from);
        else
            sum_one(product + from, table + from, stride, vector, rows, end - from);
    }
}

#endif

/* ---- matrices ------------------------------------------------------------------- */

/*
 * Whether all entries of a vector are zero. Many controllers start with zero voltages, for which
 * the product with a matrix need not be computed.
 */
static bool is_zero(const pzs_real *vector, size_t count)
{
    size_t i = 0;
    while (i < count && vector[i] <= 0 && vector[i] >= 0)
        i++;
    return i == count;
}

void pzs_product_matrix(pzs_real *restrict product, const pzs_real *restrict table,
                        const pzs_real *restrict vector, size_t rows, size_t cols)
{
    static const pzs_real zero = 0;
    if (is_zero(vector, cols)) {
        memset(product, 0, rows * sizeof *product);
        return;
    }
    if (cols < PRODUCT_LONG_ROW)
        multiply(product, &zero, 0, table, vector, rows, cols);
    for (size_t i = 0; cols >= PRODUCT_LONG_ROW && i < rows; i++)
        product[i] = pzs_product_dot(table + i * cols, vector, cols);
}

void pzs_product_add(pzs_real *restrict product, const pzs_real *restrict from,
                     const pzs_real *restrict table, const pzs_real *restrict vector, size_t rows,
                     size_t cols)
{
    if (cols == 0)
        memcpy(product, from, rows * sizeof *product);
    multiply(product, from, 1, table, vector, rows, cols);
}

void pzs_product_sum_rows(pzs_real *restrict product, const pzs_real *restrict table, size_t stride,
                          const pzs_real *restrict vector, size_t rows, size_t cols)
{
    if (product_is_wide(cols))
        pzs_wide_sum_rows(product, table, stride, vector, rows, cols);
    else
        sum_rows(product, table, stride, vector, rows, cols);
}

/*
 * Define a function that subtracts chosen rows of a table, each times its factor, from COUNT
 * entries of type `entry`, which stay in registers.
 */
#define SUBTRACT_ROWS(name, entry, COUNT)                                                          \
    static void name(pzs_real *restrict vector, const pzs_real *restrict table, size_t stride,     \
                     const uint16_t *index, const pzs_real *restrict factor, size_t count)         \
    {                                                                                              \
        entry sum[COUNT];                                                                          \
        UNROLLED                                                                                   \
        for (unsigned k = 0; k < (COUNT); k++)                                                     \
            sum[k] = ((const entry *)vector)[k];                                                   \
        for (size_t q = 0; q < count; q++) {                                                       \
            const entry *row = (const entry *)(table + index[q] * stride);                         \
            const pzs_real times = factor[q];                                                      \
            UNROLLED                                                                               \
            for (unsigned k = 0; k < (COUNT); k++)                                                 \
                sum[k] -= times * row[k];                                                          \
        }                                                                                          \
        UNROLLED                                                                                   \
        for (unsigned k = 0; k < (COUNT); k++)                                                     \
            ((entry *)vector)[k] = sum[k];                                                         \
    }

SUBTRACT_ROWS(subtract_from_one, pzs_real, 1)
#if PZS_TILE > 4
#define SPREAD (8u * IN_LANE)
SUBTRACT_ROWS(subtract_from_many, lane, 8)
#else
#define SPREAD 8u
SUBTRACT_ROWS(subtract_from_many, pzs_real, 8)
#endif

void pzs_product_subtract_rows(pzs_real *restrict vector, const pzs_real *restrict table,
                               size_t stride, const uint16_t *index,
                               const pzs_real *restrict factor, size_t count, size_t cols)
{
    size_t j = 0;
    if (cols >= WIDE_VECTOR && product_is_wide(cols)) {
        pzs_wide_subtract_rows(vector, table, stride, index, factor, count, cols);
        return;
    }
    for (; j + SPREAD <= cols; j += SPREAD)
        subtract_from_many(vector + j, table + j, stride, index, factor, count);
    for (; j < cols; j++)
        subtract_from_one(vector + j, table + j, stride, index, factor, count);
}

/* ---- of two vectors ------------------------------------------------------------- */

pzs_real pzs_product_dot(const pzs_real *left, const pzs_real *right, size_t count)
{
    if (count >= WIDE_DOT && product_is_wide(count))
        return pzs_wide_dot(left, right, count);
    return product_dot(left, right, count);
}

pzs_real pzs_product_dot_size(const pzs_real *left, const pzs_real *right, size_t count)
{
    return product_dot_size(left, right, count);
}

pzs_real pzs_product_energy(const pzs_real *weight, const pzs_real *vector, size_t count)
{
    return product_energy(weight, vector, count);
}

pzs_real pzs_product_weigh(pzs_real *restrict weighted_difference, const pzs_real *restrict weight,
                           const pzs_real *restrict left, const pzs_real *restrict right,
                           size_t count)
{
    if (product_is_wide(count))
        return pzs_wide_weigh(weighted_difference, weight, left, right, count);
    return product_weigh(weighted_difference, weight, left, right, count);
}

pzs_real pzs_product_largest(const pzs_real *vector, size_t count)
{
    return product_largest(vector, count);
}
