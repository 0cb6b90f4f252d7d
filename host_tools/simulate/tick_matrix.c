/* SPDX-License-Identifier: BSD-2-Clause */
/* Products of a matrix that stays the same with a new vector in every tick (tick_matrix.h). */
#include "tick_matrix.h"
#include <stdlib.h>
#include <string.h>
#include "../../lib/core/product.h"

bool tick_matrix_open(tick_matrix *to, const double *matrix, size_t stride, const uint32_t *chosen,
                      size_t rows, size_t columns)
{
    to->rows = rows;
    to->columns = columns;
    /*
     * The results must equal those of pzs_product_matrix. It adds the terms of short rows one after
     * the other, which a product by columns does as well. Rows of PRODUCT_LONG_ROW and more are
     * summed in another order; such matrices are therefore stored by rows.
     */
    to->is_by_columns = columns < PRODUCT_LONG_ROW;
    to->table = malloc((rows * columns + 1) * sizeof *to->table);
    if (!to->table)
        return false;
    const size_t row_step = to->is_by_columns ? 1 : columns;
    const size_t column_step = to->is_by_columns ? rows : 1;
    for (size_t i = 0; i < rows; i++) {
        const double *row = matrix + (chosen ? chosen[i] : i) * stride;
        for (size_t k = 0; k < columns; k++)
            to->table[i * row_step + k * column_step] = row[k];
    }
    return true;
}

void tick_matrix_close(tick_matrix *matrix)
{
    free(matrix->table);
    memset(matrix, 0, sizeof *matrix);
}

void tick_matrix_multiply(const tick_matrix *matrix, const double *vector, double *product)
{
    const size_t rows = matrix->rows, columns = matrix->columns;
    if (matrix->is_by_columns)
        pzs_product_sum_rows(product, matrix->table, rows, vector, columns, rows);
    else
        pzs_product_matrix(product, matrix->table, vector, rows, columns);
}
