/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Functions of the optimiser for limit rows, the limits of weighted sums of voltages
 * (row_solver.c), for use in absolute_rows.c, which treats sums of absolute values.
 */
#ifndef PZS_LIB_ROW_SOLVER_H
#define PZS_LIB_ROW_SOLVER_H

#include "limit_rows.h"

/*
 * Pointers to what the optimiser for limit rows (limits of sums of voltages) works on: the
 * controller, its tables, its two optimisers (one with, one without the limited sums) and the
 * memory that the optimiser for limit rows keeps between ticks.
 */
typedef struct rows_run {
    pzs_control *control;
    const pzs_problem *problem;
    const pzs_limit_rows *rows;
    pzs_row_solver *solver;
    pzs_optimiser *tableau; /* active-set optimiser of the quantities: the voltages, followed by the
                               limited sums of voltages. It holds their tableau, active set, bounds
                               and multipliers. The tableau T is a matrix: if the multipliers change
                               by a vector dm, the quantities change by -T dm */
    pzs_optimiser *optimiser; /* voltages, bounds and gradients of the optimiser for the inputs
                                 alone, without the limited sums of voltages */
    uint32_t inputs, count;   /* inputs: number of inputs; count: number of inputs plus number of
                                 limit rows, which are limits of sums of voltages */
} rows_run;

static inline rows_run rows_run_of(pzs_control *control)
{
    pzs_row_solver *solver = control->state.row_solver;
    return (rows_run){.control = control,
                      .problem = control->state.problem,
                      .rows = control->state.problem->limit_rows,
                      .solver = solver,
                      .tableau = &solver->extended,
                      .optimiser = &control->state.optimiser,
                      .inputs = control->state.problem->inputs,
                      .count = solver->extended.inputs};
}

/*
 * Whether quantity k, a voltage or limit row (limit of a sum of voltages), is free, that is, not
 * kept at a bound.
 */
static inline bool rows_is_free(const rows_run *run, uint32_t k)
{
    return run->tableau->free_set[k] > 0;
}

/*
 * Return the coefficient of the stored entry `at` of limit row k (limit of a sum of voltages). In a
 * limit of a sum of absolute values the coefficient has the sign that the voltage of the entry's
 * input keeps.
 */
static inline pzs_real rows_coefficient(const rows_run *run, uint32_t k, uint32_t at)
{
    const pzs_rows *sums = &run->rows->sums;
    const pzs_real value = sums->value[at];
    return limit_row_is_absolute(run->rows, k) ? value * run->solver->scale[sums->dof[at]] : value;
}

/*
 * Subtract from a gradient [inputs] what the active limit rows (limits of sums of voltages)
 * contribute to it: scaled coefficients times multiplier. Returns the largest absolute contribution
 * (m2/V), from which the rounding error is estimated.
 */
pzs_real pzs_rows_subtract(const rows_run *run, pzs_real *gradient);

#endif
