/*
 * Limits of weighted sums of voltages, which the controller (pzs_control.h) obeys beside the limits
 * of each voltage. pzs_control.h includes this header.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef PZS_LIMIT_ROWS_H
#define PZS_LIMIT_ROWS_H

#include "pzs_control_state.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Tables of limits of weighted sums of voltages, for example of the difference of two neighbouring
 * voltages. Limit row k demands
 *   lower[k] <= sum over the inputs of (coefficient in row k of `sums` * voltage) <= upper[k]
 *   - The last absolute_count rows take absolute values of the voltages, for example to limit the
 *     current of a common supply.
 *   - All voltages that the controller gives obey these limits exactly: the optimiser narrows each
 *     limit by the rounding error of the sum.
 *   - A program without such limits does not link their code.
 */
typedef struct pzs_limit_rows {
    const struct pzs_limit_row_calls *call; /* functions that implement limits of sums of voltages:
                                               always &pzs_limit_rows_calls */
    pzs_rows sums; /* coefficients of the voltages in the limited sums of voltages (dimensionless):
                      row k holds those of sum k, and the column numbers `dof` are inputs, each at
                      most once in a row */
    const pzs_real *lower; /* [sums.count] lower limit of each weighted sum of voltages, or
                              -infinity (V) */
    const pzs_real *upper; /* [sums.count] upper limit of each weighted sum of voltages, or infinity
                              (V); above the lower limit by more than twice the rounding error of
                              the sum */
    const pzs_real *safe;  /* [inputs] safe voltages, to which the controller can always return (V);
                              they obey the limits of all voltages and of all sums of voltages */
    uint16_t absolute_count; /* number of limited sums of absolute values of voltages. They are the
                                last rows of `sums`; their coefficients are not negative, and their
                                lower limits are -infinity */
    const struct pzs_absolute_row_calls *absolute_call; /* functions for limits of sums of absolute
                                                           values of voltages:
                                                           &pzs_absolute_rows_calls, or NULL where
                                                           absolute_count is 0 */
} pzs_limit_rows;

/*
 * Functions that implement limits of weighted sums of voltages; pzs_limit_rows.call points to them.
 */
extern const struct pzs_limit_row_calls pzs_limit_rows_calls;

/*
 * Functions that implement limits of weighted sums of absolute values of voltages;
 * pzs_limit_rows.absolute_call points to them. A program without such limits does not link them.
 */
extern const struct pzs_absolute_row_calls pzs_absolute_rows_calls;

#define PZS_LIMIT_ROW_LIMIT 8192 /* largest number of limited sums of voltages */

/*
 * Where sums of voltages are limited, PZS_LIMIT_ROW_WORK_LEAST and PZS_LIMIT_ROW_WORK_LIMIT replace
 * PZS_WORK_LEAST and PZS_WORK_LIMIT, the smallest and the default number of multiply-adds that the
 * optimiser may use in a tick. `rows` is the number of limited sums.
 */
#define PZS_LIMIT_ROW_WORK_LEAST(inputs, rows)                                                     \
    (PZS_WORK_LEAST((inputs) + (rows)) + 10u * PZS_PRODUCT_WORK((inputs) + (rows)))
#define PZS_LIMIT_ROW_WORK_LIMIT(inputs, rows) PZS_WORK_LIMIT((inputs) + (rows))

/*
 * Additional work (multiply-adds) for limits of weighted sums of absolute values of voltages: the
 * smallest work limit of the optimiser in a tick is then PZS_LIMIT_ROW_WORK_LEAST plus this number.
 *   rows            number of all limited sums
 *   absolute_count  number of sums of absolute values among them
 */
#define PZS_ABSOLUTE_ROW_WORK(inputs, rows, absolute_count)                                        \
    ((uint64_t)(absolute_count) * ((inputs) + 8u) * PZS_PRODUCT_WORK((inputs) + (rows)))

/*
 * PZS_LIMIT_ROW_BYTES is the memory that limits of weighted sums of voltages need in addition to
 * PZS_CONTROL_BYTES (bytes); `rows` is the number of limited sums. PZS_LIMIT_ROW_VECTORS is the
 * number of vectors in this memory, each with an entry for each input and each limited sum.
 */
#define PZS_LIMIT_ROW_VECTORS (12u + PZS_PENDING)
#define PZS_LIMIT_ROW_BYTES(inputs, rows)                                                          \
    (sizeof(pzs_row_solver) + 16u +                                                                \
     sizeof(pzs_real) * (((size_t)(inputs) + (size_t)(rows) + PZS_LIMIT_ROW_VECTORS) *             \
                             PZS_CONTROL_WIDTH((size_t)(inputs) + (size_t)(rows)) +                \
                         (size_t)(inputs) * ((size_t)(inputs) + 3u) / 2u))

#ifdef __cplusplus
}
#endif
#endif
