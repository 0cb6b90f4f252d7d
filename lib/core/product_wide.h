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
 * Smallest number of columns for which the loops with AVX2 instructions are faster than the
 * portable ones.
 */
#define WIDE_COLUMNS 48u
#define WIDE_BLOCK                                                                                 \
    8u /* number of columns of a block of the optimiser's pivoted matrix that pzs_wide_update      \
          updates */

/* Return whether products of rows of `cols` entries use the loops with AVX2 instructions. */
static inline bool product_is_wide(size_t cols)
{
    return PZS_WIDE && cols >= WIDE_COLUMNS && pzs_linalg_has_wide();
}

#if PZS_WIDE

/*
 * Sum of the rows of a table, each multiplied by its factor, with AVX2 instructions; arguments and
 * result are those of pzs_product_sum_rows.
 */
void pzs_wide_sum_rows(pzs_real *restrict product, const pzs_real *restrict table, size_t stride,
                       const pzs_real *restrict vector, size_t rows, size_t cols);

/*
 * Subtraction of chosen rows of a table, each multiplied by its factor, from a vector, with AVX2
 * instructions; arguments and result are those of pzs_product_subtract_rows.
 */
void pzs_wide_subtract_rows(pzs_real *restrict vector, const pzs_real *restrict table,
                            size_t stride, const uint16_t *index, const pzs_real *restrict factor,
                            size_t count, size_t cols);

/*
 * Add the products of two vectors to eight partial sums: product i is added to sum i modulo 8. The
 * count is a multiple of 8.
 */
void pzs_wide_dot(pzs_real sum[8], const pzs_real *left, const pzs_real *right, size_t count);

/*
 * Subtract from a block of four rows and WIDE_BLOCK columns the products of the entries of `count`
 * vectors.
 *   block                      in/out  entries of the block, rows `stride` reals apart
 *   column [count][WIDE_BLOCK] in      the first four of each eight: entries of the vectors that
 *                                      belong to the rows
 *   row    [count][WIDE_BLOCK] in      entries of the vectors that belong to the columns
 *   sign   [count]             in      factor of each vector; factors are sign_stride reals apart
 */
void pzs_wide_update(pzs_real *block, size_t stride, const pzs_real *column, const pzs_real *row,
                     const pzs_real *sign, size_t sign_stride, size_t count);

#else

/*
 * In a build without AVX2 loops, product_is_wide returns false, so that no code calls the
 * functions with AVX2 instructions.
 */
#define pzs_wide_sum_rows(...) ((void)0)
#define pzs_wide_subtract_rows(...) ((void)0)
#define pzs_wide_dot(sum, left, right, count) ((void)(sum), (void)(left), (void)(right))
#define pzs_wide_update(block, stride, column, row, sign, sign_stride, count)                      \
    ((void)(block), (void)(column), (void)(row), (void)(count))

#endif
#endif
