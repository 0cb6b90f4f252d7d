/* SPDX-License-Identifier: BSD-2-Clause */
/* Products of matrices and vectors, with results of the same bits at any vector width. */
#ifndef PZS_LIB_PRODUCT_H
#define PZS_LIB_PRODUCT_H

#include "pzs_base.h"

/*
 * Compute product [rows] = table [rows][cols] times vector [cols]; each sum runs in ascending
 * order. The memory of the vector must be readable up to the next multiple of four entries.
 */
void pzs_product_matrix(pzs_real *restrict product, const pzs_real *restrict table,
                        const pzs_real *restrict vector, size_t rows, size_t cols);

/*
 * Compute product [rows] = from [rows] + table [rows][cols] times vector [cols]; each sum runs in
 * ascending order. `from` and `product` must be different arrays. The memory of the vector must be
 * readable up to the next multiple of four entries.
 */
void pzs_product_add(pzs_real *restrict product, const pzs_real *restrict from,
                     const pzs_real *restrict table, const pzs_real *restrict vector, size_t rows,
                     size_t cols);

/*
 * Number of matrix columns from which on a row is too long to be read in groups of columns. Each
 * row is then multiplied as a whole by the vector, as in a scalar product.
 */
#define PRODUCT_LONG_ROW 128u

/*
 * Products with a sparse matrix of `cols` columns, ascending in each row. For finite vectors the
 * results have the same bits as pzs_product_matrix and pzs_product_sum_rows of the full matrix.
 *   pzs_product_sparse      product [rows.count] = matrix times vector [cols]
 *   pzs_product_sum_sparse  product [cols] = sum over the rows i of vector_i times row i
 */
void pzs_product_sparse(pzs_real *restrict product, const pzs_rows *rows,
                        const pzs_real *restrict vector, size_t cols);
void pzs_product_sum_sparse(pzs_real *restrict product, const pzs_rows *rows,
                            const pzs_real *restrict vector, size_t cols);

/*
 * Compute product [cols] = sum over the rows i of vector_i times row i of the table, whose rows are
 * `stride` reals apart.
 */
void pzs_product_sum_rows(pzs_real *restrict product, const pzs_real *restrict table, size_t stride,
                          const pzs_real *restrict vector, size_t rows, size_t cols);

/*
 * Subtract from the vector [cols] the sum over q of factor_q times row index_q of the table, whose
 * rows are `stride` reals apart; each entry is summed in ascending order of q.
 */
void pzs_product_subtract_rows(pzs_real *restrict vector, const pzs_real *restrict table,
                               size_t stride, const uint16_t *index,
                               const pzs_real *restrict factor, size_t count, size_t cols);

/*
 * pzs_product_energy returns the sum over i of (weight[i] vector[i])^2. pzs_product_weigh sets
 * weighted_difference[i] = weight[i]^2 (left[i] - right[i]) and returns the sum over i of
 * (weight[i] (left[i] - right[i]))^2.
 */
pzs_real pzs_product_energy(const pzs_real *weight, const pzs_real *vector, size_t count);
pzs_real pzs_product_weigh(pzs_real *restrict weighted_difference, const pzs_real *restrict weight,
                           const pzs_real *restrict left, const pzs_real *restrict right,
                           size_t count);

/*
 * pzs_product_dot returns the scalar product of two vectors, and pzs_product_dot_size the scalar
 * product of `left` with the absolute values of `right`. pzs_product_largest returns the largest
 * entry of a vector, at least zero, for a `count` that is a multiple of 4.
 */
pzs_real pzs_product_dot(const pzs_real *left, const pzs_real *right, size_t count);
pzs_real pzs_product_dot_size(const pzs_real *left, const pzs_real *right, size_t count);
pzs_real pzs_product_largest(const pzs_real *vector, size_t count);

#endif
