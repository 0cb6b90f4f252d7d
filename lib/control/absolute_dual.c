/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Iterations of the dual active-set method where weighted sums of absolute values of voltages are
 * limited.
 *
 * Each input has a chosen sign, and sign * voltage replaces the absolute value of its voltage in
 * these sums. An input may be kept not only at a bound of its voltage but also at 0 V
 * (input_state). The iterations may reverse the chosen signs.
 */
#include "absolute_rows.h"
#include "boxls_dual.h"
#include "../core/numbers.h"

/*
 * Relative rounding error of a voltage, or of a weighted sum of voltages that is limited, as a
 * multiple of the machine epsilon. It is used for a voltage or sum that depends linearly on others
 * which are kept at their bounds. It counts as inside its bounds if it exceeds them by at most this
 * error times the largest voltage or sum.
 */
#define ROUNDING_FACTOR 64
/*
 * A round (sequence of iterations of the optimiser) ignores voltages, and limited weighted sums of
 * voltages, that are outside their bounds by no more than rounding errors. If an earlier round of
 * the same tick did not lower the objective, a round examines them again, this many times.
 */
#define REPEATS 2u

/*
 * State of an input in the iterations, where weighted sums of absolute values of voltages are
 * limited.
 *   g  half the gradient of the objective by the voltage, without these limits (m2/V)
 *   f  sum of (weight * multiplier) over these limits (m2/V), see pzs_absolute_slopes
 *   s  chosen sign of the voltage, 1 or -1
 * A voltage between its bounds is optimal if s g + f = 0, and a voltage of 0 V if -f <= g <= f. The
 * multiplier m = s g + f keeps an input at 0 V; it must therefore obey 0 <= m <= 2f. With the
 * opposite chosen sign the multiplier is 2f - m.
 */
typedef enum {
    INPUT_FREE,     /* the voltage is kept neither at a bound nor at 0 V */
    INPUT_AT_BOUND, /* the voltage is kept at its lower or upper bound by a multiplier that must not
                       change its sign */
    INPUT_AT_ZERO /* the voltage is kept at 0 V by a multiplier from 0 to 2f, where f is the sum of
                     (weight * multiplier) over the limits of weighted sums of absolute voltages
                     that contain the voltage */
} input_state;

/*
 * Result of one iteration of the dual active-set method. The iteration changes the multiplier of
 * one voltage, or of one limited sum of voltages, to bring it to its bound. This voltage or sum is
 * called the entering quantity.
 */
typedef enum {
    PULL_FAILED, /* the iterations must end, because no change of the entering quantity's multiplier
                    moves this quantity to its bound */
    PULL_CONTINUES, /* the entering quantity is not yet at its bound, because another one has become
                       free before; the next iteration goes on changing the multiplier of the same
                       entering quantity */
    PULL_ENDED /* the entering quantity is done: kept at its bound, or free inside its bounds; the
                  next iteration chooses a new entering quantity */
} pull_end;

static input_state state_of(const rows_run *run, uint32_t i)
{
    if (rows_is_free(run, i))
        return INPUT_FREE;
    return absolute_is_split(run, i, run->tableau->side[i]) ? INPUT_AT_ZERO : INPUT_AT_BOUND;
}

/*
 * Whether a limited sum of absolute voltages is free (not kept at its limit) but still has a
 * multiplier, as after the chosen sign of one of its voltages was reversed. `row` is the row of the
 * sum in the tableau.
 */
static bool is_pending(const rows_run *run, uint32_t row)
{
    return rows_is_free(run, row) && run->tableau->direction[row] < 0;
}

/*
 * Compute the slope f of each input (m2/V): the sum of (weight of the input * multiplier) over
 * those limits of weighted sums of absolute voltages that contain its voltage. These limits add f *
 * |voltage| to half the objective. Returns the slopes [inputs].
 */
static pzs_real *find_slopes(const rows_run *run)
{
    pzs_absolute_slopes(run, run->tableau->direction, run->optimiser->scratch);
    return run->optimiser->scratch;
}

/* ---- signs ------------------------------------------------------------------- */

/*
 * Reverse the chosen sign of free input i, because its voltage is on the other side of 0 V. Limited
 * sums of absolute values that contain the voltage change by this; they become free (not kept at
 * their limits) but keep their multipliers. The caller must then compute the tableau rows of these
 * sums anew (pzs_absolute_renew).
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
 * Reverse the chosen sign of each free input whose voltage is on the other side of 0 V, if the
 * input may have both signs and no limited sum of voltages that contains it has a multiplier. If
 * the work limit leaves no time for this, set `is_cut`: the optimiser then ends.
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
 * For each input at 0 V with a multiplier m > 2f reverse the chosen sign, 1 or -1, with which
 * limited sums of absolute voltages count its voltage. Here f is the sum of (weight * multiplier)
 * over these sums. With the opposite sign the multiplier is 2f - m < 0, which is too small to keep
 * the input at 0 V: the input becomes free next.
 *   rounding in  an excess of m over 2f up to this size does not count (m2/V)
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
 * Make free every voltage, and every limited sum of voltages, whose multiplier has a value that
 * cannot keep it at its bound or at 0 V (input_state). Repeat this until no such multiplier is left
 * or the work limit stops the optimiser.
 *   rounding in  multipliers that are wrong by no more than this do not count (m2/V)
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
 * An iteration, as in boxls_dual.c, moves one free quantity (voltage or limited sum of absolute
 * voltages) from outside towards its bound by changing the multiplier of this quantity, the
 * entering quantity. Active quantities, those kept at a bound or at 0 V, stay there, and their
 * multipliers follow.
 *
 * For each input let f be the sum of (weight * multiplier) over the limited sums that contain it.
 * The iteration ends at the first of these events:
 *   - the entering quantity reaches its bound and becomes active;
 *   - the multiplier of an active quantity becomes 0: this quantity becomes free;
 *   - the multiplier of an input at 0 V becomes 2f (input_state): the input becomes free with the
 *     opposite sign;
 *   - the entering quantity is an input on the wrong side of 0 V, and its multiplier becomes 2f
 *     before its voltage reaches 0 V: the input gets the opposite sign and stays free;
 *   - the entering quantity is a limited sum below its limit (is_pending), and its multiplier
 *     becomes 0: the sum stays free.
 */

/*
 * A limited sum of absolute voltages may leave its limit when the chosen sign of one of its
 * voltages is reversed, unless that voltage is 0 V. Such a sum becomes free but keeps its
 * multiplier. Later iterations either bring the sum to its limit or its multiplier to 0. The number
 * of iterations is finite, because each one of positive length raises the dual objective.
 */

/*
 * Find the input whose multiplier reaches the value 2f first in the present iteration. Here f is
 * the sum of (weight * multiplier) over the limited sums of absolute voltages that contain the
 * input. Only inputs kept at 0 V and the entering input can be found.
 *   entering in      voltage or limited sum of voltages whose multiplier the iteration changes
 *   sense    in      sign of this change, 1 or -1
 *   part     in/out  in: largest size of this change; out: its size when the multiplier of the
 *                    found input becomes 2f, unchanged if none is found (m2/V)
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

/*
 * Reverse the chosen sign of input i and make the input free, because its multiplier m has become
 * 2f. Here f is the sum of (weight * multiplier) over the limited sums of absolute voltages that
 * contain the input. With the opposite sign the multiplier is 2f - m = 0.
 */
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

/*
 * Keep quantity i (a voltage or limited sum of voltages) at its bound from now on, with its present
 * multiplier, if the active set has room.
 */
static void join(const rows_run *run, uint32_t i)
{
    pzs_optimiser *tableau = run->tableau;
    const pzs_real multiplier = tableau->direction[i];
    if (tableau->active_count < tableau->active_most)
        pzs_dual_join(tableau, i, tableau->side[i]);
    tableau->direction[i] = multiplier;
}

/*
 * Whether it is only a rounding error that a quantity (voltage or limited sum of voltages) seems to
 * be outside its bounds by the distance `outside` (V). The quantity must be a linear combination of
 * those that are kept at their bounds.
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
 * Make one iteration: change the multiplier of the entering quantity i, a free voltage or limited
 * sum of voltages, until this quantity reaches its bound or another event ends the iteration. A
 * free sum below its limit that still has a multiplier (is_pending) is treated here, too: its
 * multiplier is reduced.
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
 * Choose the entering quantity, whose multiplier the next iteration changes: a limited sum of
 * voltages that is free but still has a multiplier (is_pending); if there is none, the free voltage
 * or sum that is farthest outside its bounds. Returns the number of quantities if all are inside.
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
 * Iterate until no voltage and no limited sum of voltages is outside its bounds by more than
 * rounding errors. Returns false if the iterations end before that: at the work limit, after `most`
 * iterations of the optimiser, or because an iteration fails (PULL_FAILED).
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
 * Examine again the voltages and limited sums of voltages that this round (sequence of iterations)
 * has ignored, because they were outside their bounds by no more than rounding errors. First move
 * those kept at a bound exactly to it, which removes rounding errors. Returns false if the
 * iterations end before all are inside (pull_all).
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
 * Start a round (sequence of iterations of the optimiser), where weighted sums of absolute values
 * of voltages are limited. A multiplier keeps a voltage or sum at its bound, or a voltage at 0 V.
 * Make free each voltage and sum whose multiplier has a sign or size that cannot do so, and set
 * multipliers of free sums to 0. Returns the number of iterations at which the round must end,
 * counted with those of earlier rounds.
 */
static uint32_t begin(const rows_run *run, pzs_real rounding)
{
    const uint32_t most = pzs_dual_begin_round(run->tableau);
    pzs_absolute_clear(run);
    // During the iterations a limited sum of absolute values has no lower bound: where chosen signs
    // are not those of the voltages, the sum of (chosen sign * weight * voltage) may be negative.
    for (uint32_t row = absolute_first(run); row < run->count; row++)
        run->tableau->lower[row] = -(pzs_real)HUGE_VAL;
    drop_wrong(run, rounding);
    return most;
}

/*
 * Store for each input what the next tick needs if the work limit has stopped the iterations
 * (pzs_absolute_row_calls.resume): its chosen sign, 1 or -1, doubled where the voltage is kept at a
 * bound other than 0 V. The store is the array `waiting`.
 */
static void note_signs(const rows_run *run)
{
    for (uint32_t i = 0; i < run->inputs; i++) {
        const bool is_bound = state_of(run, i) == INPUT_AT_BOUND;
        // The iterations are over, so that the array `waiting` may be overwritten.
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
