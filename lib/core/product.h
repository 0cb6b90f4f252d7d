/* SPDX-License-Identifier: BSD-2-Clause */
/* Products of tables and vectors, with the same bits at any vector width. */
#ifndef PZS_LIB_PRODUCT_H
#define PZS_LIB_PRODUCT_H

#include "pzs_base.h"

/*
 * product [rows] = a x, table [rows][cols], each sum in ascending order. x is read up to the next
 * multiple of four entries.
 */
void pzs_product_matrix(pzs_real *restrict product, const pzs_real *restrict table,
                        const pzs_real *restrict vector, size_t rows, size_t cols);

/* product [rows] = from + a x in the same way, from [rows] not y; it is a copy without columns. */
void pzs_product_add(pzs_real *restrict product, const pzs_real *restrict from,
                     const pzs_real *restrict table, const pzs_real *restrict vector, size_t rows,
                     size_t cols);

/* product [cols] = sum over the rows of x_i times row i of table [rows][stride]. */
void pzs_product_sum_rows(pzs_real *restrict product, const pzs_real *restrict table, size_t stride,
                          const pzs_real *restrict vector, size_t rows, size_t cols);

/* Return |w x|^2; set z [n] = w^2 (x - y) and return |w (x - y)|^2. */
pzs_real pzs_product_energy(const pzs_real *weight, const pzs_real *vector, size_t count);
pzs_real pzs_product_weigh(pzs_real *restrict weighted_difference, const pzs_real *restrict weight,
                           const pzs_real *restrict left, const pzs_real *restrict right,
                           size_t count);

/* Return x . y; x . |y|; the largest entry of x, at least zero. n is a multiple of 4. */
pzs_real pzs_product_dot(const pzs_real *left, const pzs_real *right, size_t count);
pzs_real pzs_product_dot_size(const pzs_real *left, const pzs_real *right, size_t count);
pzs_real pzs_product_largest(const pzs_real *vector, size_t count);

#endif
