/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Gains and leaks of modes, which are patterns of voltages: a leaky integrator for each mode,
 * inside all limits (pzs_modal_gains). A tick without limits would change the present voltages v by
 * d, where H d is half the gradient of the objective with its sign changed. This block replaces d
 * by d':
 *   outside the span of the modes    d' = gain d - leak (v - v0)
 *   in each mode p_k                 p_k'H d' = gain_k p_k'H d - leak_k p_k'H (v - v0)
 *   H, v0  Hessian of the objective, reference voltages
 * The optimisation then chooses, inside all limits, the voltages nearest to v + d' in the norm of
 * H.
 *
 * Work of a tick: 3 * modes * inputs multiply-adds, and inputs * inputs more with `other_leak`.
 */
#include <string.h>
#include "control.h"
#include "pzs_loop.h"
#include "scrub.h"
#include "../core/guard.h"
#include "../core/numbers.h"
#include "../core/product.h"

/*
 * List the arrays that the checksum of the tables of gains and leaks of modes covers
 * (pzs_modal_gains). Returns their number.
 */
static uint32_t list_parts(const pzs_modal_gains *tables, pzs_table_part part[PZS_TABLE_PARTS])
{
    const size_t modes = tables->modes, entries = modes * tables->inputs;
    part[0] = (pzs_table_part){&tables->inputs, 2u * sizeof tables->inputs};
    part[1] = scrub_reals(tables->pattern, entries);
    part[2] = scrub_reals(tables->effect, entries);
    part[3] = scrub_reals(tables->gain, modes);
    part[4] = scrub_reals(tables->leak, modes);
    part[5] = scrub_reals(&tables->other_gain, 2);
    return 6;
}

static uint32_t crc_of(const pzs_modal_gains *tables)
{
    pzs_table_part part[PZS_TABLE_PARTS];
    return pzs_scrub_crc(part, list_parts(tables, part));
}

static bool has_arrays(const pzs_modal_gains *tables)
{
    return tables->modes == 0 || (tables->pattern != NULL && tables->effect != NULL &&
                                  tables->gain != NULL && tables->leak != NULL);
}

pzs_status pzs_modal_gains_seal(pzs_modal_gains *tables)
{
    if (tables == NULL || tables->inputs == 0 || !has_arrays(tables))
        return PZS_E_ARGUMENT;
    tables->format = PZS_TABLE_FORMAT;
    tables->crc = crc_of(tables);
    return PZS_OK;
}

/* ---- check of the tables ----------------------------------------------- */

/*
 * Whether a mode of which each tick makes the part `gain` of the wanted change, and removes the
 * part `leak`, comes to rest without oscillation that grows; false also for numbers that are NaN.
 */
static bool is_allowed(pzs_real gain, pzs_real leak)
{
    return gain >= 0 && leak >= 0 && leak <= 1 && gain + leak < 2;
}

/*
 * Return the index of the first mode whose gain (part of the wanted change that a tick makes) or
 * leak (part of its coordinate that a tick removes) is out of range; the number of modes if this is
 * true only of other_gain or other_leak; -1 if all are in range.
 */
static int32_t find_bad_gain(const pzs_modal_gains *tables)
{
    for (uint32_t k = 0; k < tables->modes; k++)
        if (!is_allowed(tables->gain[k], tables->leak[k]))
            return (int32_t)k;
    return is_allowed(tables->other_gain, tables->other_leak) ? -1 : (int32_t)tables->modes;
}

static pzs_status check(const pzs_modal_gains *tables, const pzs_problem *problem, int32_t *where)
{
    if (tables->format != PZS_TABLE_FORMAT || tables->scene != problem->scene)
        return PZS_E_FORMAT;
    if (tables->inputs != problem->inputs || !has_arrays(tables))
        return PZS_E_ARGUMENT;
    if (crc_of(tables) != tables->crc)
        return PZS_E_CRC;
    const uint32_t entries = (uint32_t)tables->modes * tables->inputs;
    if (entries > 0 && (pzs_guard_nonfinite(tables->pattern, entries) >= 0 ||
                        pzs_guard_nonfinite(tables->effect, entries) >= 0))
        return PZS_E_NONFINITE;
    *where = find_bad_gain(tables);
    return *where < 0 ? PZS_OK : PZS_E_ARGUMENT;
}

/* ---- change of the gradient ---------------------------------------------- */

/*
 * Copy the gradient with its sign changed, and the deviation of the voltages from the reference
 * voltages. The deviation of an input whose voltage is fixed is set to 0, so that the leak (part of
 * this deviation that a tick removes) does not act on it.
 */
static void read_step(pzs_modal_gains_state *state, const pzs_control *control)
{
    const pzs_optimiser *optimiser = &control->state.optimiser;
    const pzs_real *reference = control->state.problem->reference_voltage;
    for (uint32_t i = 0; i < optimiser->inputs; i++) {
        const bool is_held = !(control->state.lower[i] < control->state.upper[i]);
        state->gradient[i] = optimiser->target_gradient[i] - optimiser->regularisation_gradient[i];
        state->deviation[i] = is_held ? 0 : optimiser->base[i] - reference[i];
    }
    for (uint32_t i = optimiser->inputs; i < optimiser->width; i++)
        state->deviation[i] = 0;
}

/*
 * Set target_gradient to that of a tick in which all patterns of voltages have the gain other_gain
 * and the leak other_leak; filter_modes then corrects it in the modes. Returns the squared size of
 * the leak term: the weighted squared norm of the shape that the leak removes in this tick (m2).
 */
static pzs_real filter_all(const pzs_modal_gains_state *state, pzs_optimiser *optimiser)
{
    const pzs_real gain = state->tables->other_gain, leak = state->tables->other_leak;
    pzs_real square = 0;
    for (uint32_t i = 0; i < optimiser->inputs; i++)
        optimiser->target_gradient[i] =
            optimiser->regularisation_gradient[i] + gain * state->gradient[i];
    if (!(leak > 0))
        return 0;
    pzs_product_matrix(state->product, optimiser->hessian, state->deviation, optimiser->inputs,
                       optimiser->width);
    for (uint32_t i = 0; i < optimiser->inputs; i++) {
        square += state->deviation[i] * state->product[i];
        optimiser->target_gradient[i] -= leak * state->product[i];
    }
    return square > 0 ? leak * leak * square : 0;
}

/*
 * Correct target_gradient in the modes, where filter_all has used other_gain and other_leak instead
 * of the gain and leak of each mode. Returns the squared size of the correction of the leak term,
 * as the weighted squared norm of a shape (m2).
 */
static pzs_real filter_modes(pzs_modal_gains_state *state, pzs_optimiser *optimiser)
{
    const pzs_modal_gains *tables = state->tables;
    const size_t modes = tables->modes, inputs = tables->inputs;
    pzs_real square = 0;
    pzs_product_matrix(state->step, tables->pattern, state->gradient, modes, inputs);
    pzs_product_matrix(state->coordinate, tables->effect, state->deviation, modes, inputs);
    for (size_t k = 0; k < modes; k++) {
        const pzs_real back = (tables->leak[k] - tables->other_leak) * state->coordinate[k];
        square += back * back;
        state->step[k] = (tables->gain[k] - tables->other_gain) * state->step[k] - back;
    }
    pzs_product_sum_rows(state->gradient, tables->effect, inputs, state->step, modes, inputs);
    for (size_t i = 0; i < inputs; i++)
        optimiser->target_gradient[i] += state->gradient[i];
    return square;
}

/*
 * Change the gradient of the objective in a tick (pzs_control_filter). Returns the new scale of its
 * rounding errors (m2). Gains are below 2, so that rounding errors of the gradient grow by less
 * than a factor of 2, and their squares by less than 4.
 */
static pzs_real filter_step(pzs_control *control, pzs_step_filter *filter, pzs_real missed)
{
    pzs_modal_gains_state *state = (void *)filter;
    pzs_optimiser *optimiser = &control->state.optimiser;
    read_step(state, control);
    const pzs_real square = 4 * missed + filter_all(state, optimiser);
    return state->tables->modes > 0 ? square + filter_modes(state, optimiser) : square;
}

/* ---- block of the control loop ------------------------------------------- */

static size_t block_bytes(const void *tables, const pzs_problem *problem)
{
    const pzs_modal_gains *gains = tables;
    return PZS_MODAL_GAINS_BLOCK_BYTES(problem->inputs, gains->modes);
}

/* Set the pointers of the block of gains and leaks of modes to its tables and to its arrays. */
static void place(pzs_modal_gains_state *state, const pzs_modal_gains *tables)
{
    state->filter.filter_step = filter_step;
    state->tables = tables;
    state->gradient = (void *)((uint8_t *)state + PZS_ALIGNED(sizeof *state));
    state->deviation = state->gradient + PZS_CONTROL_WIDTH(tables->inputs);
    state->product = state->deviation + PZS_CONTROL_WIDTH(tables->inputs);
    state->step = state->product + PZS_CONTROL_WIDTH(tables->inputs);
    state->coordinate = state->step + PZS_FOURS(tables->modes);
}

static pzs_status block_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    const pzs_status status = check(tables, signals->control->state.problem, &signals->where);
    if (status != PZS_OK)
        return status;
    if (signals->vibration != NULL)
        return PZS_E_STAGE;
    memset(self, 0, block_bytes(tables, signals->control->state.problem));
    place(self, tables);
    return PZS_OK;
}

static pzs_status block_tick(void *self, pzs_loop_signals *signals)
{
    pzs_modal_gains_state *state = self;
    place(state, signals->tables);
    pzs_control_filter(signals->control, &state->filter);
    return PZS_OK;
}

static uint32_t block_parts(const void *tables, uint32_t number,
                            pzs_table_part part[PZS_TABLE_PARTS], uint32_t *crc)
{
    const pzs_modal_gains *table = tables;
    *crc = table->crc;
    return number == 0 ? list_parts(table, part) : 0;
}

const pzs_block_type pzs_modal_gains_block = {"modal_gains", PZS_PHASE_READINGS, block_bytes,
                                              block_init,    block_tick,         block_parts};
