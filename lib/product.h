/* Product of a table and a vector. */
#ifndef PZS_PRODUCT_H
#define PZS_PRODUCT_H

#include "pzs.h"

/* y [rows] = a x, a [rows][cols]; each sum in ascending order. x is zero from cols up to whole fours. */
void product(pzs_real *restrict y, const pzs_real *restrict a, const pzs_real *restrict x, size_t rows, size_t cols);

#endif
