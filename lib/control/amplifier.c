/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Amplifiers that give whole converter steps only and do not follow changes inside a dead band.
 *
 * A wanted voltage becomes the last whole step on the way to it from the present voltage. The
 * result lies between the two, inside voltage limits and step limits, and integral action changes
 * the voltage once it has summed up to one step. No step is taken that the next tick would take
 * back, as rounding to the nearest step would do where the structure responds more than the model.
 * Voltage limits in force take precedence over whole steps. Where whole steps violate a limit row,
 * the amplifiers of this row keep their present voltages for this tick.
 *
 * A damped tick (vibration.c) demands small changes from the present voltages again and again, each
 * of which may be less than a step. What the amplifier does not give of them is carried over to the
 * next tick, up to one step plus the dead band.
 */
#include <string.h>
#include "pzs_loop.h"
#include "control.h"
#include "limit_rows.h"
#include "../core/numbers.h"
#include "step_bounds.h"

/*
 * A voltage of more converter steps than this is not rounded, because the steps would be finer than
 * the resolution of pzs_real.
 */
#define STEP_COUNT_LIMIT PZS_R(1e9)

/*
 * Return the multiple of the converter step, between `present` and `wanted`, that is nearest to
 * `wanted`, or `present` if there is none between them (V).
 */
static pzs_real last_step(pzs_real wanted, pzs_real present, pzs_real step)
{
    const pzs_real steps = wanted / step;
    if (!(step > 0) || !(number_absolute(steps) < STEP_COUNT_LIMIT))
        return wanted;
    const int32_t whole = (int32_t)steps;
    const pzs_real voltage = (pzs_real)whole * step;
    if (wanted > present) {
        const pzs_real below = voltage > wanted ? (pzs_real)(whole - 1) * step : voltage;
        return below > present ? below : present;
    }
    const pzs_real above = voltage < wanted ? (pzs_real)(whole + 1) * step : voltage;
    return above < present ? above : present;
}

/*
 * Return the voltage of an input plus the parts of earlier changes that the amplifier has not made,
 * clamped to step limit and voltage limits (V).
 */
static pzs_real voltage_with_carry(const pzs_control *control, uint32_t j, pzs_real present)
{
    const pzs_real voltage = control->state.voltage[j], most = control->state.step_limit[j];
    if (control->state.carry == NULL || !(control->state.lower[j] < control->state.upper[j]))
        return voltage;
    const pzs_real carried = number_clamp(voltage + control->state.carry[j],
                                          step_down(present, most), step_up(present, most));
    return number_clamp(carried, control->state.lower[j], control->state.upper[j]);
}

/*
 * Return the amplifiers of a violated limit row to their present voltages, which violate none.
 *   present [inputs] in      voltages before the change (V)
 *   given   [inputs] in/out  voltages after whole steps (V)
 */
static void keep_rows(pzs_control *control, const pzs_real *present, pzs_real *given)
{
    const pzs_problem *problem = control->state.problem;
    if (problem->limit_rows == NULL)
        return;
    problem->limit_rows->call->take_back(problem, present, given);
    for (uint32_t j = 0; j < problem->inputs; j++)
        control->state.voltage[j] = given[j];
}

pzs_status pzs_quantise(pzs_control *control, pzs_real *given, pzs_real step, pzs_real dead_band)
{
    if (control == NULL || given == NULL || !(step >= 0) || !(dead_band >= 0))
        return PZS_E_ARGUMENT;
    if (control->state.stage != CONTROL_READY)
        return PZS_E_STAGE;
    const pzs_problem *problem = control->state.problem;
    pzs_real *before = control->state.optimiser.scratch;
    for (uint32_t j = 0; j < problem->inputs; j++) {
        const pzs_real voltage = control->state.voltage[j];
        const pzs_real present = number_is_finite(given[j])
                                     ? number_clamp(given[j], problem->lower[j], problem->upper[j])
                                     : voltage;
        const pzs_real wanted = voltage_with_carry(control, j, present);
        const pzs_real stepped = number_absolute(wanted - present) <= dead_band
                                     ? present
                                     : last_step(wanted, present, step);
        before[j] = present;
        given[j] = number_clamp(stepped, control->state.lower[j], control->state.upper[j]);
        if (control->state.carry != NULL)
            control->state.carry[j] =
                number_clamp(wanted - given[j], -(step + dead_band), step + dead_band);
        control->state.voltage[j] = given[j];
    }
    keep_rows(control, before, given);
    pzs_control_moved(control);
    return PZS_OK;
}

/* ---- block ------------------------------------------------------------ */

static size_t block_bytes(const void *tables, const pzs_problem *problem)
{
    (void)tables;
    return PZS_AMPLIFIER_BLOCK_BYTES(problem->inputs);
}

/* Let the block point to its tables and to its array. */
static void place(pzs_amplifier_state *state, const pzs_amplifier *amplifier)
{
    state->tables = amplifier;
    state->given = (void *)((uint8_t *)state + PZS_ALIGNED(sizeof *state));
}

static pzs_status block_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    const pzs_amplifier *amplifier = tables;
    const pzs_control *control = signals->control;
    pzs_amplifier_state *state = self;
    if (!(amplifier->step >= 0) || !(amplifier->dead_band >= 0))
        return PZS_E_ARGUMENT;
    place(state, amplifier);
    memcpy(state->given, control->state.voltage,
           control->state.problem->inputs * sizeof *state->given);
    return PZS_OK;
}

static pzs_status block_tick(void *self, pzs_loop_signals *signals)
{
    pzs_amplifier_state *state = self;
    place(state, signals->tables);
    memcpy(state->given, signals->given,
           signals->control->state.problem->inputs * sizeof *state->given);
    return pzs_quantise(signals->control, state->given, state->tables->step,
                        state->tables->dead_band);
}

const pzs_block_type pzs_amplifier_block = {"amplifier", PZS_PHASE_VOLTAGE, block_bytes,
                                            block_init,  block_tick,        NULL};
