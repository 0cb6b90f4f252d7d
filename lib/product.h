/* Products of tables and vectors, with the same bits at any width of the machine. */
#ifndef PZS_PRODUCT_H
#define PZS_PRODUCT_H

#include "pzs.h"

/* y [rows] = a x, a [rows][cols]; each sum in ascending order. x may be read up to whole fours. */
void product(pzs_real *restrict y, const pzs_real *restrict a, const pzs_real *restrict x, size_t rows, size_t cols);

/* y [cols] = sum over the rows of x_i times row i of a [rows][stride]. */
void product_sum_rows(pzs_real *restrict y, const pzs_real *restrict a, size_t stride, const pzs_real *restrict x,
                      size_t rows, size_t cols);

/* |w x|^2; and z [n] = w^2 (x - y), which returns |w (x - y)|^2. */
pzs_real product_energy(const pzs_real *w, const pzs_real *x, size_t n);
pzs_real product_weigh(pzs_real *restrict z, const pzs_real *restrict w, const pzs_real *restrict x,
                       const pzs_real *restrict y, size_t n);

/* x . y; x . |y|; and the largest of x, not below zero: there n is a multiple of 4. */
pzs_real product_dot(const pzs_real *x, const pzs_real *y, size_t n);
pzs_real product_dot_size(const pzs_real *x, const pzs_real *y, size_t n);
pzs_real product_largest(const pzs_real *x, size_t n);

#endif
