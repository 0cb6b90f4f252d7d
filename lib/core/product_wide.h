/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Products of matrices and vectors for hosts with the vector unit AVX2 (option PZS_WIDE). Each sum
 * has the terms of the portable loops in their order (product.h, boxls_tableau.c), so that the bits
 * of the results are the same.
 */
#ifndef PZS_LIB_PRODUCT_WIDE_H
#define PZS_LIB_PRODUCT_WIDE_H

#include "linalg_wide.h"

/*
 * Sizes from which on the functions with AVX2 instructions are faster than the portable functions
 * of product.c:
 *   WIDE_COLUMNS  number of columns of a table whose rows are summed, each times a factor
 *   WIDE_VECTOR   number of entries of a vector from which rows of a table are subtracted
 *   WIDE_DOT      number of entries of the two vectors of a scalar product
 */
#define WIDE_COLUMNS 8u
#define WIDE_VECTOR 17u
#define WIDE_DOT 48u

/*
 * Smallest number of rows and columns of a symmetric matrix of which only the entries up to the
 * diagonal are updated by AVX2 instructions, and mirrored at the end. Smaller ones are updated as a
 * whole, which takes less time.
 */
#define WIDE_HALF 48u

/*
 * Number of rows and of columns of the blocks of a symmetric matrix that pzs_wide_update_rows
 * updates.
 */
#define WIDE_BLOCK 8u

/* Return whether products of tables with rows of `cols` entries use AVX2 instructions. */
static inline bool product_is_wide(size_t cols)
{
    return PZS_WIDE && cols >= WIDE_COLUMNS && pzs_linalg_has_wide();
}

#if PZS_WIDE

/*
 * Compute the sum of the rows of a table, each multiplied by its factor, with AVX2 instructions.
 * The arguments and the bits of the result are those of pzs_product_sum_rows.
 */
void pzs_wide_sum_rows(pzs_real *restrict product, const pzs_real *restrict table, size_t stride,
                       const pzs_real *restrict vector, size_t rows, size_t cols);

/*
 * Subtract chosen rows of a table, each multiplied by its factor, from a vector, with AVX2
 * instructions. The arguments and the bits of the result are those of pzs_product_subtract_rows.
 */
void pzs_wide_subtract_rows(pzs_real *restrict vector, const pzs_real *restrict table,
                            size_t stride, const uint16_t *index, const pzs_real *restrict factor,
                            size_t count, size_t cols);

/*
 * Versions of pzs_product_dot and pzs_product_weigh (product.h) with AVX2 instructions. Arguments
 * are those of the portable functions, and the results have the same bits.
 */
pzs_real pzs_wide_dot(const pzs_real *left, const pzs_real *right, size_t count);
pzs_real pzs_wide_weigh(pzs_real *restrict weighted_difference, const pzs_real *restrict weight,
                        const pzs_real *restrict left, const pzs_real *restrict right,
                        size_t count);

/*
 * Copy vectors, the rows of a table, into groups of WIDE_BLOCK columns for pzs_wide_update_rows.
 * The last group is filled up with zeros.
 *   groups [groups][count][WIDE_BLOCK] out  entries of the vectors
 *   scaled [groups][count][WIDE_BLOCK] out  entries of the vectors times their factors
 *   table  [count][columns]            in   vectors, `stride` reals apart
 *   factor [count]                     in   factors, factor_stride reals apart
 */
void pzs_wide_group(pzs_real *restrict groups, pzs_real *restrict scaled,
                    const pzs_real *restrict table, size_t stride, const pzs_real *restrict factor,
                    size_t factor_stride, size_t count, size_t columns);

/*
 * Update WIDE_BLOCK rows (fewer at the end) of a symmetric matrix [size][size], up to and including
 * the diagonal block: from each entry i, j subtract the sum over k of column_k[i] * row_k[j]. Uses
 * AVX-512 if the processor has it.
 *   matrix                             in/out  rows of the matrix, `stride` reals apart
 *   i                                  in      first row, a multiple of WIDE_BLOCK
 *   column [groups][count][WIDE_BLOCK] in      vectors column_k in groups of WIDE_BLOCK entries
 *   row    [groups][count][WIDE_BLOCK] in      vectors row_k in groups of WIDE_BLOCK entries
 */
void pzs_wide_update_rows(pzs_real *matrix, size_t stride, size_t size, size_t i,
                          const pzs_real *column, const pzs_real *row, size_t count);

/*
 * Set `count` columns of a matrix to zero, then subtract `count` rank-one products: from each entry
 * i, j the sum over q of column_q[i] * row_q[j].
 *   matrix [rows][stride]  in/out  matrix whose rows have a length that is a multiple of four
 *   column [count][stride] in      vectors column_q, of which the first `rows` entries are read
 *   row    [count][stride] in      vectors row_q
 *   zero   [count]         in/out  indices of the columns to be set to zero; overwritten
 */
void pzs_wide_update_whole(pzs_real *restrict matrix, size_t stride, size_t rows,
                           const pzs_real *restrict column, const pzs_real *restrict row,
                           long long *restrict zero, size_t count);

/*
 * Copy the entries below the diagonal of a symmetric matrix [size][size] to those above it.
 *   matrix in/out  rows of the matrix, `stride` reals apart
 */
void pzs_wide_mirror(pzs_real *matrix, size_t stride, size_t size);

#else

/*
 * In a build without AVX2 instructions, product_is_wide returns false, so that the functions with
 * these instructions are never called.
 */
#define pzs_wide_sum_rows(...) ((void)0)
#define pzs_wide_subtract_rows(...) ((void)0)
#define pzs_wide_dot(left, right, count) 0
#define pzs_wide_weigh(weighted_difference, weight, left, right, count) 0
#define pzs_wide_group(groups, scaled, table, stride, factor, factor_stride, count, columns)       \
    ((void)(groups), (void)(scaled), (void)(factor))
#define pzs_wide_update_rows(matrix, stride, size, i, column, row, count)                          \
    ((void)(column), (void)(row), (void)(count))
#define pzs_wide_update_whole(matrix, stride, rows, column, row, zero, count)                      \
    ((void)(column), (void)(zero))
#define pzs_wide_mirror(matrix, stride, size) ((void)0)

#endif
#endif
