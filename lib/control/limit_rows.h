/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Functions for limit rows, which are limits of weighted sums of voltages (pzs_limit_rows). The
 * controller, the loop and the last check before the amplifiers call them through one table of
 * pointers, so that a program without such limits does not link them.
 */
#ifndef PZS_LIB_LIMIT_ROWS_H
#define PZS_LIB_LIMIT_ROWS_H

#include "pzs_control.h"

/*
 * Number of arrays in the tables of limits of sums of voltages; they enter the checksum of the
 * controller's tables.
 */
#define LIMIT_ROW_PARTS 8u

struct pzs_limit_row_calls {
    /*
     * List the arrays in the tables of limits of weighted sums of voltages, which the checksum of
     * the controller's tables covers. Arrays that are missing or too large to be read are not
     * listed.
     */
    void (*list_parts)(const pzs_problem *problem, pzs_table_part part[LIMIT_ROW_PARTS]);
    /*
     * Check the tables of the limits of sums of voltages. Returns PZS_OK, or an error with *where
     * as pzs_control_init states them.
     */
    pzs_status (*check_rows)(const pzs_problem *problem, int32_t *where);
    /* Whether voltages [inputs] violate no limit row (limit of a sum of voltages). */
    bool (*satisfy)(const pzs_limit_rows *rows, const pzs_real *voltage);
    /*
     * Place the optimiser for limit rows (limits of sums of voltages) and its arrays in the
     * workspace of the controller, from the address `work` on.
     */
    void (*arrange)(pzs_control *control, uint8_t *work);
    /* Initialise the optimiser for limit rows (limits of sums of voltages) in a new controller. */
    void (*prepare)(pzs_control *control);
    /*
     * At the start of a tick, repair parts of the optimiser for limit rows (limits of sums of
     * voltages) that damaged memory may have changed: flags, and the zeros beyond the end of
     * vectors.
     */
    void (*repair)(pzs_control *control);
    /*
     * Compute the voltages that minimise the objective of a control tick inside their bounds and
     * inside the limits of their sums, as far as the work limit of the optimiser allows. The
     * voltages must be inside all of these before the call.
     */
    void (*optimise)(pzs_control *control);
    /*
     * Bring the voltages of the controller back inside voltage limits and limit rows (limits of
     * sums of voltages): at once if the step limits allow it, otherwise a part of the way in each
     * tick.
     *   where out  only if this takes further ticks: an input that is outside its limits or belongs
     *              to a violated row
     * Returns whether the voltages are inside.
     */
    bool (*bring_inside)(pzs_control *control, int32_t *where);
    /*
     * Return the largest violation of the optimality (KKT) conditions (m2/V) by the present
     * voltages with a gradient [inputs] (m2/V), and store the number of active limit rows (limits
     * of sums of voltages) in *active.
     */
    pzs_real (*violation)(pzs_control *control, const pzs_real *gradient, uint16_t *active);
    /*
     * Correct voltages that violate a limit row (limit of a sum of voltages): move them along the
     * straight line towards the voltages `inside`, until they violate no row, or none more than
     * `inside` itself.
     *   inside  [inputs] in      voltages at the end of the line (V), which replace `voltage` if no
     *                            such point is found
     *   voltage [inputs] in/out  voltages to correct (V)
     * Returns the first input of the first row that was violated, or -1 if nothing has changed.
     */
    int32_t (*scale_back)(const pzs_problem *problem, const pzs_real *inside, pzs_real *voltage);
    /*
     * Undo changes of voltages by which limit rows (limits of sums of voltages) are violated more
     * than before. All inputs of such a row get their earlier voltages, and so on until no such row
     * is left. All other inputs keep their new voltages.
     *   before  [inputs] in      voltages before the change (V)
     *   voltage [inputs] in/out  voltages after the change (V)
     */
    void (*take_back)(const pzs_problem *problem, const pzs_real *before, pzs_real *voltage);
    /*
     * Continue a checksum over the coefficients and limits of all limit rows (limits of sums of
     * voltages). Returns the new checksum.
     */
    uint32_t (*add_row_limits)(uint32_t sum, const pzs_problem *problem);
    /*
     * Functions that return the smallest and the default number of multiply-adds that the optimiser
     * may use in a tick where sums of voltages are limited.
     */
    uint64_t (*least_work)(const pzs_problem *problem);
    uint64_t (*usual_work)(const pzs_problem *problem);
};

/*
 * Functions for limits of weighted sums of absolute values of voltages. The optimiser calls them
 * through a table of pointers, so that a program without such limits does not link them.
 */
struct pzs_absolute_row_calls {
    /*
     * Choose for each input in a limited sum of absolute values of voltages the sign of its present
     * voltage: |voltage| = sign * voltage. If a sign changes, adapt the bounds and the tableau
     * (matrix) of the optimiser.
     */
    void (*follow_signs)(pzs_control *control);
    /*
     * Return the largest violation of the optimality (KKT) conditions (m2/V) by inputs at 0 V that
     * belong to a limited sum of absolute values. The violation is the rate at which half the
     * objective falls if the voltage leaves 0 V to the side that its chosen sign excludes. How far
     * the objective can fall in this way is added, as an upper bound, to the duality gap
     * solver->gap (m2).
     *   reduced [inputs] in  gradient minus the contributions of the active limits of sums (m2/V)
     */
    pzs_real (*crossing_violation)(pzs_control *control, const pzs_real *reduced);
    /*
     * If the work limit stopped the iterations of the last tick, go on with the signs that the
     * iterations had chosen for the voltages in limited sums of absolute values. Adapts the bounds
     * and the tableau (matrix) of the optimiser to these signs. Computes anew the limited sums, and
     * the gradient minus the contributions of their active limits.
     */
    void (*resume)(pzs_control *control);
    /*
     * Make the iterations of the dual active-set method as pzs_iterate_dual does (boxls_dual.h).
     * Inputs in limited sums of absolute values of voltages may be kept at 0 V, and get the other
     * sign where this lowers the objective.
     */
    bool (*iterate)(pzs_control *control, pzs_real rounding);
};

/* Return the number of limited sums of voltages of a controller. */
static inline uint32_t limit_row_count(const pzs_problem *problem)
{
    return problem->limit_rows != NULL ? problem->limit_rows->sums.count : 0;
}

/* Whether limited sum k is a weighted sum of absolute values of voltages. */
static inline bool limit_row_is_absolute(const pzs_limit_rows *rows, uint32_t k)
{
    return k + rows->absolute_count >= rows->sums.count;
}

/*
 * Return the weighted sum of voltages, or of their absolute values, that limit row k limits (V).
 * The terms are added in the order of the stored coefficients, so that the optimiser and the last
 * check before the amplifiers compute the same bits.
 */
pzs_real pzs_limit_rows_sum(const pzs_limit_rows *rows, uint32_t k, const pzs_real *voltage);

/*
 * Return the distance (V) by which the optimiser narrows limit row k, a limit of a sum of voltages.
 * It covers the rounding error of the sum for any voltages inside the voltage limits.
 */
pzs_real pzs_limit_rows_margin(const pzs_problem *problem, uint32_t k);

int32_t pzs_scale_back_rows(const pzs_problem *problem, const pzs_real *inside, pzs_real *voltage);

/* ---- optimiser (row_solver.c) ------------------------------------------- */

void pzs_arrange_rows(pzs_control *control, uint8_t *work);
void pzs_prepare_rows(pzs_control *control);
void pzs_repair_rows(pzs_control *control);
void pzs_optimise_rows(pzs_control *control);
pzs_real pzs_violation_rows(pzs_control *control, const pzs_real *gradient, uint16_t *active);

#endif
