/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Products of constant matrices with a new vector in every tick of a simulation. The matrices are
 * stored in the layout in which such a product is fastest. The products are bitwise equal to those
 * of pzs_product_matrix.
 */
#ifndef TICK_MATRIX_H
#define TICK_MATRIX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct tick_matrix {
    size_t rows, columns;
    bool is_by_columns; /* true: `table` is [columns][rows]; false: [rows][columns] */
    double *table;      /* entries of the matrix, in allocated memory */
} tick_matrix;

/*
 * Copy rows of a matrix whose rows have `columns` entries.
 *   chosen [rows]             in  index of each row to copy; NULL: the first `rows` rows
 *   matrix [any rows][stride] in  matrix of at least `columns` columns
 * Returns whether memory sufficed; call tick_matrix_close in either case.
 */
bool tick_matrix_open(tick_matrix *to, const double *matrix, size_t stride, const uint32_t *chosen,
                      size_t rows, size_t columns);
void tick_matrix_close(tick_matrix *matrix);

/*
 * Multiply a matrix by a vector.
 *   vector  [columns] in   its memory must be readable up to the next multiple of four entries
 *   product [rows]    out  product
 */
void tick_matrix_multiply(const tick_matrix *matrix, const double *vector, double *product);

#endif
