/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Amplifiers whose output voltage is a whole multiple of a converter step, and which do not follow
 * a change of voltage inside a dead band: a stage of the control tick.
 *
 *   - The given voltage is the last whole multiple between the present and the wanted voltage, so
 *     that it obeys voltage limits and step limits. Rounding to the nearest multiple could exceed
 *     them.
 *   - Voltage limits take precedence over whole multiples.
 *   - Where rounded voltages violate a limit of a weighted sum of voltages, the amplifiers of this
 *     sum keep their voltages in this tick.
 *   - Vibration damping may need changes below a converter step. The rest is carried over to the
 *     next tick, up to one converter step plus the dead band.
 */
#include <string.h>
#include "pzs_loop.h"
#include "control.h"
#include "limit_rows.h"
#include "../core/numbers.h"
#include "step_bounds.h"

/*
 * A voltage is rounded to a whole number of converter steps only if it has at most this many. A
 * converter step is the smallest voltage change that an amplifier can make. With more steps, a step
 * would be finer than the resolution of pzs_real.
 */
#define STEP_COUNT_LIMIT PZS_R(1e9)

/*
 * Return the multiple of the converter step, between the voltages `present` and `wanted`, that is
 * nearest to `wanted` (V); `present` if no multiple lies between them; `wanted` for a step of zero
 * or one finer than the resolution of pzs_real.
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
 * Return the voltage of input j plus those parts of earlier voltage changes that its amplifier has
 * not made because of converter steps and dead band (V). The sum is clamped to the step limit
 * around the voltage `present` and to the voltage limits.
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
 * Where voltages rounded to converter steps violate the limit of a weighted sum of voltages, set
 * the inputs in this sum back to their present voltages, which violate no limit.
 *   present [inputs] in      voltages before the change (V)
 *   given   [inputs] in/out  voltages rounded to converter steps (V)
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

/* ---- block of the control loop --------------------------------------- */

static size_t block_bytes(const void *tables, const pzs_problem *problem)
{
    (void)tables;
    return PZS_AMPLIFIER_BLOCK_BYTES(problem->inputs);
}

/*
 * Set the pointers of the memory for amplifiers with converter steps: to their tables, and to the
 * array of the voltages that they give [inputs], which follows in memory.
 */
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
