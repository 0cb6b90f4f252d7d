/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Limits of weighted sums of absolute values of voltages, for example of the current of a common
 * supply:
 *   sum over the inputs of (weight * |voltage|) <= upper limit
 *
 * Each input has a chosen sign, 1 or -1: sign * voltage stands for |voltage| in the sums, and the
 * voltage must not pass 0 V. The iterations of the optimiser (absolute_dual.c) reverse a sign where
 * the optimum demands it; only the tableau rows of these sums are then computed again.
 */
#include <string.h>
#include "absolute_rows.h"
#include "boxls_dual.h"
#include "../core/numbers.h"
#include "../core/product.h"

/*
 * Return the place of the first limited sum of absolute values in the arrays pzs_rows.dof (inputs)
 * and pzs_rows.value (weights): the index of its first entry. These sums are the last ones there.
 */
static uint32_t first_entry(const rows_run *run)
{
    return run->rows->sums.start[absolute_first(run) - run->inputs];
}

/*
 * Return the index in pzs_rows.dof (inputs) and pzs_rows.value (weights) behind the last entry of
 * the limited sums of absolute values, which is the number of all entries.
 */
static uint32_t last_entry(const rows_run *run)
{
    return run->rows->sums.start[run->rows->sums.count];
}

void pzs_absolute_slopes(const rows_run *run, const pzs_real *multiplier, pzs_real *slope)
{
    const pzs_rows *sums = &run->rows->sums;
    memset(slope, 0, run->inputs * sizeof *slope);
    for (uint32_t row = absolute_first(run); row < run->count; row++) {
        const uint32_t k = row - run->inputs;
        const pzs_real own = -run->solver->scale[row] * multiplier[row];
        for (uint32_t at = sums->start[k]; at < sums->start[k + 1u]; at++)
            slope[sums->dof[at]] += own * sums->value[at];
    }
    run->tableau->work += last_entry(run) - first_entry(run);
}

/* ---- choice of the signs ------------------------------------------------- */

/*
 * Set the bounds of the voltage of input i in the optimiser: those of the present tick, cut off at
 * 0 V so that the voltage keeps the sign chosen for it. In limited sums of absolute values this
 * sign replaces the absolute value.
 */
static void split_bounds(const rows_run *run, uint32_t i)
{
    const bool is_positive = run->solver->scale[i] > 0;
    const pzs_real lower = run->optimiser->lower[i], upper = run->optimiser->upper[i];
    run->tableau->lower[i] = is_positive && lower < 0 ? 0 : lower;
    run->tableau->upper[i] = !is_positive && upper > 0 ? 0 : upper;
}

void pzs_absolute_reverse(const rows_run *run, uint32_t i)
{
    pzs_real *side = run->tableau->side;
    const bool is_kept = !rows_is_free(run, i) && absolute_is_split(run, i, side[i]);
    run->solver->scale[i] = -run->solver->scale[i];
    split_bounds(run, i);
    if (is_kept)
        side[i] = -run->solver->scale[i];
}

/*
 * Whether the sign chosen for the voltage of input i must be reversed: the present voltage has the
 * opposite sign, or the bounds of the voltage exclude the chosen sign.
 */
static bool is_sign_wrong(const rows_run *run, uint32_t i)
{
    const pzs_real sign = run->solver->scale[i];
    const pzs_real lower = run->optimiser->lower[i], upper = run->optimiser->upper[i];
    const bool is_excluded = sign > 0 ? upper <= 0 && lower < 0 : lower >= 0 && upper > 0;
    return is_excluded || run->optimiser->voltage[i] * sign < -run->solver->margin[i];
}

/* Whether the voltage limits of input i allow voltages of both signs. */
static bool has_both_signs(const rows_run *run, uint32_t i)
{
    return run->optimiser->lower[i] < 0 && run->optimiser->upper[i] > 0;
}

/* ---- response matrix ------------------------------------------------------- */

void pzs_absolute_clear(const rows_run *run)
{
    for (uint32_t row = absolute_first(run); row < run->count; row++)
        if (rows_is_free(run, row))
            run->tableau->direction[row] = 0;
}

uint64_t pzs_absolute_renew_work(const rows_run *run)
{
    const uint64_t width = run->tableau->width, active = run->tableau->active_count;
    return run->rows->absolute_count *
           (run->inputs * width + 3u * active * active + 4u * (uint64_t)run->count);
}

/*
 * Compute anew the row and the column of limited sum k of absolute values of voltages in the
 * optimiser's tableau, which gives changes of voltages and sums from changes of multipliers. The
 * row of the sum is a linear combination of the rows of its inputs, with the signed coefficients of
 * the sum.
 */
static void renew_row(const rows_run *run, uint32_t k)
{
    pzs_optimiser *tableau = run->tableau;
    const pzs_rows *sums = &run->rows->sums;
    const size_t width = tableau->width, row = run->inputs + k;
    pzs_real *sum = tableau->tableau + row * width, *factor = tableau->scratch;
    memset(factor, 0, width * sizeof *factor);
    for (uint32_t at = sums->start[k]; at < sums->start[k + 1u]; at++)
        factor[sums->dof[at]] = run->solver->scale[row] * rows_coefficient(run, k, at);
    pzs_product_sum_rows(sum, tableau->tableau, width, factor, run->inputs,
                         optimiser_span(tableau));
    sum[row] = pzs_product_dot(factor, sum, run->inputs);
    for (uint32_t other = 0; other < run->count; other++)
        tableau->tableau[other * width + row] = sum[other];
    tableau->work += (uint64_t)run->inputs * width;
}

void pzs_absolute_renew(const rows_run *run)
{
    pzs_optimiser *tableau = run->tableau;
    for (uint32_t row = absolute_first(run); row < run->count; row++) {
        const bool is_active = !rows_is_free(run, row);
        const pzs_real multiplier = tableau->direction[row];
        pzs_dual_free(tableau, row);
        renew_row(run, row - run->inputs);
        if (is_active)
            pzs_dual_join(tableau, row, 1);
        tableau->direction[row] = multiplier;
    }
}

/*
 * Choose the signs of the voltages in limited sums of absolute values when a sequence of iterations
 * starts: those of the present voltages. Set the bounds of voltages and sums for these signs.
 */
static void follow_signs(pzs_control *control)
{
    const rows_run run = rows_run_of(control);
    bool has_changed = false;
    for (uint32_t at = first_entry(&run); at < last_entry(&run); at++) {
        const uint16_t i = run.rows->sums.dof[at];
        // Repair the chosen sign of the voltage of input i, which damaged memory may have changed:
        // it is 1 or -1.
        run.solver->scale[i] = run.solver->scale[i] < 0 ? (pzs_real)-1 : (pzs_real)1;
        split_bounds(&run, i);
        if (!is_sign_wrong(&run, i))
            continue;
        pzs_absolute_reverse(&run, i);
        has_changed = true;
    }
    for (uint32_t row = absolute_first(&run); row < run.count; row++)
        // The lower bound of a sum of absolute values never acts, because the sum is not negative.
        // It must be finite, so that the duality gap stays finite, and is set to minus the upper
        // bound.
        run.tableau->lower[row] = -run.tableau->upper[row];
    if (has_changed)
        pzs_absolute_renew(&run);
}

/*
 * Compute the limited sums of absolute values for the present voltages, with each absolute value
 * replaced by (chosen sign * voltage), into the voltage array of the tableau. A term is negative
 * where the voltage does not have its chosen sign.
 */
static void load_signed_sums(const rows_run *run)
{
    const pzs_rows *sums = &run->rows->sums;
    for (uint32_t row = absolute_first(run); row < run->count; row++) {
        const uint32_t k = row - run->inputs;
        pzs_real sum = 0;
        for (uint32_t at = sums->start[k]; at < sums->start[k + 1u]; at++)
            sum += rows_coefficient(run, k, at) * run->optimiser->voltage[sums->dof[at]];
        run->tableau->voltage[row] = run->solver->scale[row] * sum;
    }
}

static void resume(pzs_control *control)
{
    const rows_run run = rows_run_of(control);
    const pzs_real *last = run.tableau->waiting;
    pzs_real *reduced = run.optimiser->scratch;
    bool has_changed = false;
    for (uint32_t at = first_entry(&run); run.tableau->is_cut && at < last_entry(&run); at++) {
        const uint16_t i = run.rows->sums.dof[at];
        if (!(last[i] * run.solver->scale[i] < 0) || !has_both_signs(&run, i))
            continue;
        pzs_absolute_reverse(&run, i);
        if (!rows_is_free(&run, i))
            run.tableau->side[i] = run.solver->scale[i] * (number_absolute(last[i]) > 1 ? 1 : -1);
        has_changed = true;
    }
    if (!has_changed)
        return;
    pzs_absolute_renew(&run);
    load_signed_sums(&run);
    memcpy(reduced, run.optimiser->gradient, run.optimiser->width * sizeof *reduced);
    (void)pzs_rows_subtract(&run, reduced);
}

/* ---- optimality -------------------------------------------------------------- */

static pzs_real crossing_violation(pzs_control *control, const pzs_real *reduced)
{
    const rows_run run = rows_run_of(control);
    pzs_real *slope = run.tableau->scratch, largest = 0;
    pzs_absolute_clear(&run);
    pzs_absolute_slopes(&run, run.tableau->direction, slope);
    for (uint32_t i = 0; i < run.inputs; i++) {
        const pzs_real sign = run.solver->scale[i];
        const pzs_real room = sign > 0 ? -run.optimiser->lower[i] : run.optimiser->upper[i];
        const pzs_real excess = sign * reduced[i] - 2 * slope[i];
        if (!absolute_is_split(&run, i, -sign) || !(excess > 0))
            continue;
        run.solver->gap += room * excess;
        if (number_absolute(run.optimiser->voltage[i]) <= run.solver->margin[i])
            largest = excess > largest ? excess : largest;
    }
    return largest;
}

const struct pzs_absolute_row_calls pzs_absolute_rows_calls = {follow_signs, crossing_violation,
                                                               resume, pzs_iterate_absolute};
