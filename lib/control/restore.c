/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Repair of damaged working memory, as by radiation or by a wrong pointer of the firmware.
 *   - What stays constant is derived again from the tables in flash at the start of each tick, so
 *     that damage lasts for one tick at most.
 *   - The optimiser's Hessian is compared with the tables one row in each tick.
 *   - What changes from tick to tick is corrected by the measurements and by the checks of the
 *     optimiser.
 */
#include "boxls.h"
#include "boxls_tableau.h"
#include "control.h"
#include "../core/guard.h"
#include "../core/numbers.h"
#include "../core/product.h"
#include "limit_rows.h"

void pzs_control_set_held(pzs_control *control, uint32_t input, pzs_real voltage)
{
    for (int copy = 0; copy < 3; copy++)
        control->state.held[copy][input] = voltage;
}

void pzs_control_share_bounds(pzs_optimiser *optimiser, const pzs_control *control)
{
    if (control->state.has_step_limits)
        return;
    optimiser->lower = control->state.lower;
    optimiser->upper = control->state.upper;
}

/*
 * Return the smallest useful threshold for linearly dependent inputs: a pivot of a newly computed
 * tableau (pivoted Hessian) below it, relative to the diagonal of the Hessian, may be a rounding
 * error.
 */
static pzs_real least_pivot_floor(const pzs_optimiser *optimiser)
{
    return 4 * (pzs_real)optimiser->inputs * PZS_EPSILON;
}

void pzs_control_set_constants(pzs_control *control)
{
    pzs_optimiser *optimiser = &control->state.optimiser;
    const pzs_real stiffest = pzs_product_largest(optimiser->diagonal, optimiser->width);
    const pzs_real regularisation = control->state.problem->regularisation;
    const pzs_real least = least_pivot_floor(optimiser);
    const bool is_plausible =
        optimiser->pivot_floor >= least && optimiser->pivot_floor <= BOXLS_DEPENDENT * least;
    optimiser->pivot_floor = is_plausible ? optimiser->pivot_floor : least;
    control->state.largest_column = PZS_SQRT(stiffest);
    optimiser->inverse_trace_bound = regularisation > BOXLS_DEPENDENT * least * stiffest
                                         ? (pzs_real)optimiser->inputs / regularisation
                                         : 0;
}

/*
 * Copy the voltage limits and step limits of the tables. Returns whether any step limit is shorter
 * than the distance between the voltage limits of its input.
 */
static bool copy_limits(const pzs_problem *problem, pzs_real *restrict lower,
                        pzs_real *restrict upper, pzs_real *restrict step_limit)
{
    const pzs_real *restrict lowest = problem->lower, *restrict highest = problem->upper,
                             *restrict step = problem->step_limit;
    bool has_step_limits = false;
    for (const pzs_real *const end = lowest + problem->inputs; lowest < end; lowest++) {
        has_step_limits |= *step < *highest - *lowest;
        *lower++ = *lowest;
        *upper++ = *highest++;
        *step_limit++ = *step++;
    }
    return has_step_limits;
}

void pzs_control_restore_limits(pzs_control *control)
{
    const pzs_problem *problem = control->state.problem;
    pzs_real *const *held = control->state.held, *const lower = control->state.lower,
                    *const upper = control->state.upper;
    pzs_guard_vote(held[0], held[1], held[2], problem->inputs * sizeof *held[0]);
    control->state.has_step_limits = copy_limits(problem, lower, upper, control->state.step_limit);
    for (uint32_t i = 0; i < problem->inputs; i++)
        if (number_is_finite(held[0][i]))
            lower[i] = upper[i] = number_clamp(held[0][i], lower[i], upper[i]);
}

uint32_t pzs_control_predicted_sum(const pzs_control *control)
{
    return pzs_guard_word_sum(control->state.predicted,
                              control->state.problem->outputs * sizeof *control->state.predicted);
}

/* ---- Hessian ----------------------------------------------------------- */

/*
 * Find damage in row k of the optimiser's Hessian: compare the row with the Hessian in the
 * controller's tables or, if the tables contain none, with the mirrored entries across the
 * diagonal. Returns the column of the first entry that differs, or the number of inputs if none
 * differs.
 */
static uint32_t find_difference(const pzs_control *control, const pzs_real *table, uint32_t k)
{
    const pzs_optimiser *optimiser = &control->state.optimiser;
    const uint32_t inputs = optimiser->inputs;
    const pzs_real *row = optimiser->hessian + (size_t)k * optimiser->width;
    const pzs_real *source = table != NULL ? table + (size_t)k * inputs : optimiser->hessian + k;
    const size_t stride = table != NULL ? 1u : optimiser->width;
    for (uint32_t j = 0; j < inputs; j++) {
        const bool has_sum = j == k && table != NULL;
        const pzs_real expected =
            has_sum ? source[j] + control->state.problem->regularisation : source[j * stride];
        if (!(row[j] >= expected && row[j] <= expected))
            return j;
    }
    return inputs;
}

/*
 * Compute rows k and j of the optimiser's Hessian again from the tables. The mirrored entries
 * across the diagonal and the separate array of diagonal entries are repaired, too.
 */
static void repair_rows(pzs_control *control, const pzs_real *table, uint32_t k, uint32_t j)
{
    pzs_optimiser *optimiser = &control->state.optimiser;
    const uint32_t first = k < j ? k : j;
    const uint32_t last = k < j ? j : k;
    pzs_control_form_row(control, table, first);
    for (uint32_t i = first; table == NULL && i < optimiser->inputs; i++)
        optimiser->hessian[(size_t)i * optimiser->width + first] =
            optimiser->hessian[(size_t)first * optimiser->width + i];
    pzs_control_form_row(control, table, last);
    optimiser->diagonal[first] = optimiser->hessian[(size_t)first * optimiser->width + first];
    optimiser->diagonal[last] = optimiser->hessian[(size_t)last * optimiser->width + last];
}

/*
 * Compare row k of the optimiser's Hessian with the Hessian in the controller's tables or, if these
 * contain none, with the mirrored entries across the diagonal. Returns whether the row had to be
 * repaired.
 */
static bool scrub_row(pzs_control *control, const pzs_real *table, uint32_t k)
{
    pzs_optimiser *optimiser = &control->state.optimiser;
    const pzs_real diagonal = optimiser->hessian[(size_t)k * optimiser->width + k];
    const uint32_t j = find_difference(control, table, k);
    const bool is_same = optimiser->diagonal[k] >= diagonal && optimiser->diagonal[k] <= diagonal;
    if (j == optimiser->inputs && is_same)
        return false;
    repair_rows(control, table, k, j < optimiser->inputs ? j : k);
    return true;
}

/*
 * Return the number of inputs in the active set, those whose voltage is kept at a bound. First set
 * the number that marks each input as free (1) or active (0), which damaged memory may have
 * changed, to exactly 0 or 1.
 */
static uint32_t count_active(pzs_optimiser *optimiser)
{
    uint32_t active = 0;
    for (uint32_t i = 0; i < optimiser->inputs; i++) {
        optimiser->free_set[i] = optimiser->free_set[i] > 0 ? 1 : 0;
        active += optimiser->free_set[i] > 0 ? 0u : 1u;
    }
    return active;
}

/*
 * Set the padding of matrix rows and vectors of the controller, which lie at the start of its
 * workspace, to zero: the entries beyond the number of inputs, in every `stride`-th row of `width`
 * entries from row `first` on. The padding must be zero, because sums and maxima are taken over
 * whole rows.
 */
static void clear_padding(pzs_control *control, uint32_t first, uint32_t stride)
{
    const pzs_optimiser *optimiser = &control->state.optimiser;
    for (size_t row = first; row < PZS_CONTROL_ROWS(optimiser->inputs); row += stride)
        for (uint32_t i = optimiser->inputs; i < optimiser->width; i++)
            optimiser->hessian[row * optimiser->width + i] = 0;
}

/*
 * Let the next tick compute the tableau (pivoted Hessian) of the optimiser anew, and that of the
 * optimiser for limited sums of voltages, if sums are limited.
 */
static void reset_tableaux(pzs_control *control)
{
    pzs_tableau_reset(&control->state.optimiser);
    if (control->state.row_solver != NULL)
        control->state.row_solver->extended.exchanges = UINT32_MAX;
}

/*
 * Make one step of the check for damaged memory: compare the next row k of the optimiser's Hessian
 * with the tables and repair it if it was damaged. Numbers derived from the Hessian are computed
 * anew after a repair, and after the last row.
 */
static void scrub_next_row(pzs_control *control, const pzs_real *table)
{
    pzs_optimiser *optimiser = &control->state.optimiser;
    const uint32_t inputs = optimiser->inputs;
    const uint32_t k = control->state.scrub_row < inputs ? control->state.scrub_row : 0;
    const bool is_repaired = scrub_row(control, table, k);
    control->state.scrub_row = (uint16_t)(k + 1u);
    // Set the padding behind the entries of all inputs to zero again, as damaged memory may have
    // changed it: in the rows k, k + inputs, k + 2 inputs and so on of the workspace, where k is
    // the row of the Hessian that this call has checked. After a repair, do so in all rows.
    const uint32_t first = is_repaired ? 0 : k;
    const uint32_t step = is_repaired ? 1u : inputs;
    clear_padding(control, first, step);
    if (k + 1u == inputs || is_repaired) {
        optimiser->active_count = count_active(optimiser);
        optimiser->inverse_trace = 0;
        pzs_control_set_constants(control);
    }
    if (is_repaired)
        reset_tableaux(control);
}

/* ---- controller --------------------------------------------------------- */

static const pzs_real *hessian_table(const pzs_problem *problem, const pzs_real *influence)
{
    return influence == NULL ? problem->hessian : NULL;
}

void pzs_control_restore(pzs_control *control, const pzs_problem *problem,
                         const pzs_real *influence, void *work)
{
    pzs_optimiser *optimiser = &control->state.optimiser;
    control->state.problem = problem;
    control->state.influence = influence != NULL ? influence : problem->influence;
    control->state.stage = CONTROL_READY;
    pzs_control_place(control, work);
    /*
     * Switch off the damping of vibration and the gains of modes at the start of each tick. Their
     * blocks, if the loop has them, switch them on again later in the tick.
     */
    pzs_control_damp(control, 1, NULL, NULL);
    pzs_control_filter(control, NULL);
    guard_repair_bool(&optimiser->is_verified);
    guard_repair_bool(&optimiser->is_rebuilding);
    guard_repair_bool(&control->state.is_taken_over);
    guard_repair_bool(&control->state.is_led);
    guard_repair_bool(&optimiser->is_predicted);
    guard_repair_bool(&optimiser->is_fresh);
    guard_repair_bool(&optimiser->is_dual);
    optimiser->is_dual = optimiser->is_dual && optimiser->dual != NULL;
    optimiser->pending_count = 0;
    if (optimiser->checked_next >= optimiser->inputs)
        optimiser->checked_next = 0;
    pzs_control_restore_limits(control);
    pzs_control_share_bounds(optimiser, control);
    const uint64_t work_limit = pzs_control_usual_work(problem);
    if (control->settings.work_limit > work_limit)
        control->settings.work_limit = work_limit;
    if (pzs_control_predicted_sum(control) != control->state.predicted_sum)
        pzs_control_moved(control);
    if (problem->limit_rows != NULL)
        problem->limit_rows->call->repair(control);
    scrub_next_row(control, hessian_table(problem, influence));
}

void pzs_control_recover(pzs_control *control, const pzs_real *influence)
{
    pzs_optimiser *optimiser = &control->state.optimiser;
    const pzs_problem *problem = control->state.problem;
    for (uint32_t k = 0; k < problem->inputs; k++) {
        (void)scrub_row(control, hessian_table(problem, influence), k);
        optimiser->free_set[k] = 1;
    }
    for (uint32_t i = 0; i < problem->outputs; i++)
        if (!number_is_finite(control->state.disturbance[i]))
            control->state.disturbance[i] = 0;
    pzs_control_set_constants(control);
    reset_tableaux(control);
    pzs_control_moved(control);
}
