/*
 * piezoshape, control image: limits of weighted sums of voltages, beside the limits of each
 * voltage. SPDX-License-Identifier: BSD-2-Clause
 *
 * pzs_control.h includes this header.
 */
#ifndef PZS_LIMIT_ROWS_H
#define PZS_LIMIT_ROWS_H

#include "pzs_control_state.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Limits of weighted sums of voltages, in addition to the limits of each voltage: for example the
 * largest difference of two neighbouring voltages. A limit row is one such limit; row k demands
 *   lower_k <= sum over the entries of row k of (`value` * voltage of input `dof`) <=
 *   upper_k.
 * The last absolute_count rows limit weighted sums of absolute values of voltages, for example the
 * current that a common supply gives: there the absolute value takes the place of the voltage.
 * All voltages that the controller gives obey the limit rows without any rounding error: the
 * optimiser narrows each row by the rounding error of its sum. A program whose voltage optimisation
 * problem has no limit rows does not link their code.
 */
typedef struct pzs_limit_rows {
    const struct pzs_limit_row_calls *call; /* pointer to the functions that implement limit rows:
                                               always &pzs_limit_rows_calls */
    pzs_rows sums; /* coefficients of the voltages in the limited sums (1): `count` rows whose
                      columns `dof` are inputs, each input at most once in a row */
    const pzs_real *lower; /* [sums.count] lower limit of each weighted sum, or -infinity (V) */
    const pzs_real *upper; /* [sums.count] upper limit of each weighted sum, or infinity (V); above
                              the lower limit by more than twice the rounding error of the sum */
    const pzs_real *safe;  /* [inputs] safe voltages inside all voltage limits and limit rows, to
                              which the controller can always return (V) */
    uint16_t absolute_count; /* number of limit rows, the last ones, that limit weighted sums of
                                absolute values of voltages; their coefficients are not negative,
                                their lower limits are -infinity */
    const struct pzs_absolute_row_calls *absolute_call; /* pointer to the functions for limits of
                                                           sums of absolute values:
                                                           &pzs_absolute_rows_calls, or NULL where
                                                           absolute_count is 0 */
} pzs_limit_rows;

/*
 * Functions that implement limit rows, which are limits of weighted sums of voltages. The member
 * `call` of pzs_limit_rows points to them.
 */
extern const struct pzs_limit_row_calls pzs_limit_rows_calls;

/*
 * Functions that implement limits of weighted sums of absolute values of voltages. The member
 * absolute_call of pzs_limit_rows points to them; a program without such limits does not link them.
 */
extern const struct pzs_absolute_row_calls pzs_absolute_rows_calls;

#define PZS_LIMIT_ROW_LIMIT 8192 /* largest number of limit rows, limits of sums of voltages */

/*
 * For a problem with limit rows (limits of weighted sums of voltages), PZS_LIMIT_ROW_WORK_LEAST and
 * PZS_LIMIT_ROW_WORK_LIMIT replace PZS_WORK_LEAST and PZS_WORK_LIMIT, the smallest and the default
 * work limit of the optimiser (multiply-adds).
 */
#define PZS_LIMIT_ROW_WORK_LEAST(inputs, rows)                                                     \
    (PZS_WORK_LEAST((inputs) + (rows)) + 10u * PZS_PRODUCT_WORK((inputs) + (rows)))
#define PZS_LIMIT_ROW_WORK_LIMIT(inputs, rows) PZS_WORK_LIMIT((inputs) + (rows))

/*
 * Number of multiply-adds by which limits of weighted sums of absolute values of voltages raise the
 * smallest work limit of the optimiser above PZS_LIMIT_ROW_WORK_LEAST. `rows` is the number of all
 * limit rows, absolute_count the number of those that limit sums of absolute values.
 */
#define PZS_ABSOLUTE_ROW_WORK(inputs, rows, absolute_count)                                        \
    ((uint64_t)(absolute_count) * ((inputs) + 8u) * PZS_PRODUCT_WORK((inputs) + (rows)))

/*
 * PZS_LIMIT_ROW_BYTES is the memory that limit rows (limits of weighted sums of voltages) need in
 * addition to PZS_CONTROL_BYTES, or to the memory of a block that holds a controller (bytes).
 * PZS_LIMIT_ROW_VECTORS is the number of vectors that this memory holds.
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
