/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Iterations of the dual active-set method where sums of absolute values of voltages are limited.
 * An input may then also be kept at 0 V (input_state), and its voltage has a chosen sign, which the
 * iterations may reverse.
 */
#include "absolute_rows.h"
#include "boxls_dual.h"
#include "../core/numbers.h"

/*
 * A quantity that is a linear combination of the active ones counts as inside its bounds if it is
 * outside by no more than this multiple of its rounding error.
 */
#define ROUNDING_FACTOR 64
/*
 * Number of times that the iterations examine again the quantities that they have ignored because
 * of rounding errors. This is done in ticks in which an earlier round did not lower the objective.
 */
#define REPEATS 2u

/*
 * State of an input in the iterations, where sums of absolute values of voltages are limited. With
 *   g  half the gradient of the objective without these limits
 *   f  sum of (weight * multiplier) over these limits (pzs_absolute_slopes)
 *   s  chosen sign of the voltage, 1 or -1
 * a voltage between its bounds is optimal if s g + f = 0, and a voltage of 0 V if -f <= g <= f. The
 * multiplier m = s g + f that keeps an input at 0 V thus has two limits, 0 <= m <= 2 f.
 */
typedef enum {
    INPUT_FREE,     /* its multiplier is 0 */
    INPUT_AT_BOUND, /* kept at a bound of its voltage by a multiplier of one sign */
    INPUT_AT_ZERO   /* kept at 0 V by a multiplier between 0 and twice the slope of its limits */
} input_state;

/* What an iteration leaves of the entering quantity. */
typedef enum {
    PULL_FAILED,    /* no change of its multiplier brings it to its bound */
    PULL_CONTINUES, /* another quantity became free; the next iteration has the same entering one */
    PULL_ENDED      /* it is active, or free without being outside */
} pull_end;

static input_state state_of(const rows_run *run, uint32_t i)
{
    if (rows_is_free(run, i))
        return INPUT_FREE;
    return absolute_is_split(run, i, run->tableau->side[i]) ? INPUT_AT_ZERO : INPUT_AT_BOUND;
}

/* Whether limited sum `row` is free but has kept its multiplier. */
static bool is_pending(const rows_run *run, uint32_t row)
{
    return rows_is_free(run, row) && run->tableau->direction[row] < 0;
}

/*
 * Compute for each input the slope (m2/V) that the active limits of sums of absolute values add to
 * the objective on each side of 0 V. Returns the slopes [inputs].
 */
static pzs_real *find_slopes(const rows_run *run)
{
    pzs_absolute_slopes(run, run->tableau->direction, run->optimiser->scratch);
    return run->optimiser->scratch;
}

/* ---- signs ------------------------------------------------------------------- */

/*
 * Reverse the sign of free input i, whose voltage is on the wrong side of 0 V. The sums of absolute
 * values that contain the input get other values; their limits become free and keep their
 * multipliers. The rows of the limited sums must be renewed afterwards.
 */
static void reverse_free(const rows_run *run, uint32_t i)
{
    pzs_real *next = run->tableau->next_voltage;
    const pzs_rows *sums = &run->rows->sums;
    for (uint32_t row = absolute_first(run); row < run->count; row++) {
        const uint32_t k = row - run->inputs;
        for (uint32_t at = sums->start[k]; at < sums->start[k + 1u]; at++) {
            if (sums->dof[at] != i || !(sums->value[at] > 0))
                continue;
            next[row] -= 2 * run->solver->scale[row] * rows_coefficient(run, k, at) * next[i];
            pzs_dual_free(run->tableau, row);
        }
    }
    pzs_absolute_reverse(run, i);
}

/*
 * Where a free voltage and its chosen sign differ, and no active limit of a sum of absolute values
 * contains the voltage, choose the sign of the voltage, if the work limit allows it.
 */
static void follow_unconstrained(const rows_run *run)
{
    pzs_optimiser *tableau = run->tableau;
    bool has_changed = false;
    if (!pzs_dual_affords(tableau, 2u * pzs_absolute_renew_work(run))) {
        tableau->is_cut = true;
        return;
    }
    const pzs_real *slope = find_slopes(run);
    for (uint32_t i = 0; i < run->inputs; i++) {
        const pzs_real sign = run->solver->scale[i];
        const bool is_outside = tableau->next_voltage[i] * sign < 0;
        if (!is_outside || !rows_is_free(run, i) || slope[i] > 0 ||
            !absolute_is_split(run, i, -sign))
            continue;
        reverse_free(run, i);
        has_changed = true;
    }
    if (has_changed)
        pzs_absolute_renew(run);
}

/*
 * Reverse the chosen signs of the inputs at 0 V whose multiplier exceeds twice the slope of their
 * limits. Their multipliers then have the wrong sign, so that they become free next.
 *   rounding in  an excess up to this size does not count (m2/V)
 * Returns whether a sign was reversed.
 */
static bool reverse_exceeding(const rows_run *run, pzs_real rounding)
{
    pzs_optimiser *tableau = run->tableau;
    const pzs_real *slope = find_slopes(run);
    bool has_changed = false;
    for (uint32_t i = 0; i < run->inputs; i++) {
        const pzs_real sign = run->solver->scale[i];
        if (state_of(run, i) != INPUT_AT_ZERO ||
            !(sign * tableau->direction[i] - 2 * slope[i] > rounding))
            continue;
        tableau->direction[i] -= 2 * sign * slope[i];
        pzs_absolute_reverse(run, i);
        has_changed = true;
    }
    if (has_changed)
        pzs_absolute_renew(run);
    return has_changed;
}

/*
 * Make free all active quantities whose multipliers are outside their limits, until none is left or
 * the work limit stops the optimiser.
 */
static void drop_wrong(const rows_run *run, pzs_real rounding)
{
    pzs_optimiser *tableau = run->tableau;
    bool again = true;
    while (again) {
        pzs_dual_drop_wrong(tableau, rounding);
        for (uint32_t row = absolute_first(run); row < run->count; row++)
            if (rows_is_free(run, row) && !(tableau->direction[row] < 0))
                tableau->direction[row] = 0;
        tableau->is_cut |= !pzs_dual_affords(tableau, 2u * pzs_absolute_renew_work(run));
        again = !tableau->is_cut && reverse_exceeding(run, rounding);
    }
}

/* ---- iteration ----------------------------------------------------------------- */

/*
 * As in boxls_dual.c, an iteration changes the multiplier of one free quantity outside its bounds
 * (a voltage or a limited sum), the entering one; the multipliers of the active quantities follow.
 * It ends at the first event:
 *   - the entering quantity reaches its bound and becomes active;
 *   - a multiplier becomes 0: its quantity becomes free;
 *   - the multiplier of an input at 0 V becomes twice the slope of its limits (input_state): the
 *     input becomes free with the other sign;
 *   - the entering quantity is an input at the wrong side of 0 V, and its multiplier becomes twice
 *     this slope before its voltage reaches 0 V: it gets the other sign and stays free.
 */

/*
 * Another sign of a voltage away from 0 V changes the limited sums of absolute values. Their limits
 * then become free but keep their multipliers, until iterations bring them to their limits or the
 * multipliers to 0. The number of iterations is finite, because every iteration of positive length
 * raises the dual objective.
 */

/*
 * Find the input at 0 V, or the entering input, whose multiplier first becomes twice the slope of
 * its limits.
 *   entering in      entering quantity, whose multiplier changes by sense * part
 *   part     in/out  in: largest size of this change; out: size at which the input was found (m2/V)
 * Returns the input, or the number of inputs if there is none.
 */
static uint32_t first_crossing(const rows_run *run, uint32_t entering, pzs_real sense,
                               pzs_real *part)
{
    pzs_optimiser *tableau = run->tableau;
    const pzs_real *change = dual_array(tableau, DUAL_CHANGE), *slope = find_slopes(run);
    pzs_real *rate = tableau->pivot, *slope_rate = tableau->scratch;
    uint32_t first = run->inputs;
    for (uint32_t k = 0; k < run->count; k++)
        rate[k] = 0;
    for (uint32_t k = 0; k < tableau->active_count; k++)
        rate[tableau->order[k]] = sense * change[k];
    rate[entering] = sense;
    pzs_absolute_slopes(run, rate, slope_rate);
    for (uint32_t i = 0; i < run->inputs; i++) {
        const pzs_real sign = run->solver->scale[i];
        const bool is_entering = i == entering && absolute_is_split(run, i, tableau->side[i]);
        if (!is_entering && state_of(run, i) != INPUT_AT_ZERO)
            continue;
        const pzs_real room = 2 * slope[i] - sign * tableau->direction[i];
        const pzs_real closes = sign * rate[i] - 2 * slope_rate[i];
        if (closes > 0 && room < *part * closes) {
            *part = room > 0 ? room / closes : 0;
            first = i;
        }
    }
    return first;
}

/* Give input i the other sign: its multiplier has become twice the slope of its limits. */
static pull_end cross(const rows_run *run, uint32_t i)
{
    pzs_optimiser *tableau = run->tableau;
    const bool is_at_zero = !rows_is_free(run, i);
    tableau->direction[i] = 0;
    if (is_at_zero) {
        pzs_dual_free(tableau, i);
        tableau->next_voltage[i] = 0;
        pzs_absolute_reverse(run, i);
    } else {
        reverse_free(run, i);
    }
    pzs_absolute_renew(run);
    return is_at_zero ? PULL_CONTINUES : PULL_ENDED;
}

/* Make quantity i active at its bound, with its present multiplier, if the active set has room. */
static void join(const rows_run *run, uint32_t i)
{
    pzs_optimiser *tableau = run->tableau;
    const pzs_real multiplier = tableau->direction[i];
    if (tableau->active_count < tableau->active_most)
        pzs_dual_join(tableau, i, tableau->side[i]);
    tableau->direction[i] = multiplier;
}

/*
 * Whether rounding errors explain that a quantity is outside its bounds by the distance `outside`
 * (V) although it is a linear combination of the active ones.
 */
static bool is_explained(const rows_run *run, pzs_real outside)
{
    pzs_real largest = 0;
    for (uint32_t k = 0; k < run->count; k++) {
        const pzs_real size = number_absolute(run->tableau->next_voltage[k]);
        largest = size > largest ? size : largest;
    }
    return outside <= ROUNDING_FACTOR * PZS_EPSILON * largest ||
           pzs_dual_is_rounding(run->tableau, outside);
}

/*
 * Make one iteration with the entering quantity i. A limited sum that is free but has a multiplier
 * may also be inside its limit; its multiplier then falls.
 */
static pull_end pull(const rows_run *run, uint32_t i)
{
    pzs_optimiser *tableau = run->tableau;
    const pzs_real side = tableau->side[i], bound = dual_bound(tableau, i);
    const pzs_real pivot = pzs_dual_find_response(tableau, i);
    const pzs_real outside = side * (tableau->next_voltage[i] - bound);
    const pzs_real own = -side * tableau->direction[i];
    const bool may_join = pzs_dual_may_join(tableau, i, pivot), falls = outside < 0;
    const pzs_real sense = falls ? side : -side;
    if (!may_join && !falls && is_explained(run, outside)) {
        tableau->waiting[i] = 1;
        return PULL_ENDED;
    }
    pzs_real part = may_join ? number_absolute(outside) / pivot : (pzs_real)HUGE_VAL;
    const bool vanishes = falls && own < part;
    if (vanishes)
        part = own;
    const uint32_t zero = pzs_dual_first_zero(tableau, sense, &part);
    const uint32_t crossing = first_crossing(run, i, sense, &part);
    if (!number_is_finite(part))
        return PULL_FAILED;
    pzs_dual_advance(tableau, i, sense * part);
    if (crossing < run->inputs)
        return cross(run, crossing);
    if (zero < tableau->active_count) {
        tableau->direction[tableau->order[zero]] = 0;
        pzs_dual_free(tableau, tableau->order[zero]);
        return PULL_CONTINUES;
    }
    if (vanishes) {
        tableau->direction[i] = 0;
        return PULL_ENDED;
    }
    join(run, i);
    tableau->next_voltage[i] = bound;
    return PULL_ENDED;
}

/*
 * Choose the entering quantity: a limited sum that is free but has a multiplier, or else the free
 * quantity that is farthest outside its bounds. Returns the number of quantities if there is none.
 */
static uint32_t choose_entering(const rows_run *run)
{
    follow_unconstrained(run);
    for (uint32_t row = absolute_first(run); row < run->count; row++)
        if (is_pending(run, row) && !(run->tableau->waiting[row] > 0)) {
            run->tableau->side[row] = 1;
            return row;
        }
    return pzs_dual_choose_outside(run->tableau);
}

/*
 * Iterate until all quantities are inside their bounds or the optimiser has made `most` iterations.
 * Returns false if the iterations ended early.
 */
static bool pull_all(const rows_run *run, uint32_t most)
{
    pzs_optimiser *tableau = run->tableau;
    uint32_t entering = choose_entering(run);
    bool goes_on = !tableau->is_cut;
    while (goes_on && entering < run->count) {
        const uint64_t extra = 2u * pzs_absolute_renew_work(run);
        pull_end end = PULL_FAILED;
        if (tableau->iterations < most && pzs_dual_may_iterate(tableau, extra))
            end = pull(run, entering);
        if (end == PULL_ENDED)
            entering = choose_entering(run);
        goes_on = end != PULL_FAILED && !tableau->is_cut;
    }
    return goes_on;
}

/*
 * Examine again the quantities that the iterations have ignored, because rounding errors explained
 * that they were outside their bounds. The active quantities are first moved exactly to their
 * bounds, so that little is left that rounding errors explain. Returns false if the iterations
 * ended early.
 */
static bool pull_ignored(const rows_run *run, uint32_t most)
{
    pzs_optimiser *tableau = run->tableau;
    const uint64_t active = tableau->active_count;
    bool is_any = false;
    for (uint32_t k = 0; k < run->count; k++) {
        is_any |= tableau->waiting[k] > 0;
        tableau->waiting[k] = 0;
    }
    if (!is_any || !pzs_dual_affords(tableau, active * (active + tableau->width)))
        return true;
    tableau->multiplier_change = 0;
    pzs_dual_move_to_bounds(tableau);
    return pull_all(run, most);
}

/*
 * Start the iterations: free all active quantities whose multipliers are outside their limits.
 * Returns the largest number of iterations that the optimiser may have made when they end.
 */
static uint32_t begin(const rows_run *run, pzs_real rounding)
{
    const uint32_t most = pzs_dual_begin_round(run->tableau);
    pzs_absolute_clear(run);
    // Limited sums have no lower bound: they may be negative while chosen signs differ from the
    // signs of the voltages.
    for (uint32_t row = absolute_first(run); row < run->count; row++)
        run->tableau->lower[row] = -(pzs_real)HUGE_VAL;
    drop_wrong(run, rounding);
    return most;
}

/*
 * Note the chosen sign of each input at the end of the iterations, 1 or -1, doubled for an input at
 * a bound of its voltage. If the work limit has stopped the iterations, the next tick continues
 * with these signs (pzs_absolute_row_calls.resume).
 */
static void note_signs(const rows_run *run)
{
    for (uint32_t i = 0; i < run->inputs; i++) {
        const bool is_bound = state_of(run, i) == INPUT_AT_BOUND;
        // The array `waiting` is unused until the next iterations begin.
        run->tableau->waiting[i] = run->solver->scale[i] * (is_bound ? 2 : 1);
    }
}

bool pzs_iterate_absolute(pzs_control *control, pzs_real rounding)
{
    const rows_run run = rows_run_of(control);
    const uint32_t most = begin(&run, rounding), again = run.solver->failures > 0 ? REPEATS : 0;
    bool is_complete = !run.tableau->is_cut && pull_all(&run, most);
    for (uint32_t k = 0; k < again && is_complete; k++)
        is_complete = pull_ignored(&run, most);
    for (uint32_t row = absolute_first(&run); row < run.count; row++)
        if (is_pending(&run, row))
            join(&run, row);
    note_signs(&run);
    pzs_dual_take_voltages(run.tableau);
    return is_complete;
}
