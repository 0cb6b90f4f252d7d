/*
 * Amplifiers that give whole steps only and leave small changes be.
 *
 * A volt asked for becomes the last whole step on the way to it from the volt given now. So it
 * stays between the two, inside limits and slew, and what integral action asks for is given once it
 * amounts to a step: no step is taken that the next tick would take back, which rounding to the
 * nearest does where the plant is stronger than the model. Limits in force come before whole steps.
 */
#include <string.h>
#include "pzs_loop.h"
#include "control.h"
#include "../core/numbers.h"

#define MOST_STEPS                                                                                 \
    PZS_R(1e9) /* volts of more steps are not rounded: they count in less than the real's own      \
                  steps */

/* The last whole step on the way from `have` to `wish`, or `have`. */
static pzs_real whole_step(pzs_real wish, pzs_real have, pzs_real step)
{
    const pzs_real steps = wish / step;
    if (!(step > 0) || !(number_absolute(steps) < MOST_STEPS))
        return wish;
    const int32_t near = (int32_t)steps;
    const pzs_real at = (pzs_real)near * step;
    if (wish > have) {
        const pzs_real below = at > wish ? (pzs_real)(near - 1) * step : at;
        return below > have ? below : have;
    }
    const pzs_real above = at < wish ? (pzs_real)(near + 1) * step : at;
    return above < have ? above : have;
}

pzs_status pzs_quantise(pzs_control *control, pzs_real *given, pzs_real step, pzs_real dead_band)
{
    if (control == NULL || given == NULL || !(step >= 0) || !(dead_band >= 0))
        return PZS_E_ARGUMENT;
    if (control->state.stage != CONTROL_READY)
        return PZS_E_STAGE;
    const pzs_problem *problem = control->state.problem;
    for (uint32_t j = 0; j < problem->inputs; j++) {
        const pzs_real wish = control->state.voltage[j];
        const pzs_real have = number_is_finite(given[j])
                                  ? number_clamp(given[j], problem->lower[j], problem->upper[j])
                                  : wish;
        const pzs_real stepped =
            number_absolute(wish - have) <= dead_band ? have : whole_step(wish, have, step);
        given[j] = number_clamp(stepped, control->state.lower[j], control->state.upper[j]);
        control->state.voltage[j] = given[j];
    }
    pzs_control_moved(control);
    return PZS_OK;
}

/* ---- block ------------------------------------------------------------ */

static size_t block_bytes(const void *tables, const pzs_problem *problem)
{
    (void)tables;
    return PZS_AMPLIFIER_BLOCK_BYTES(problem->inputs);
}

static pzs_status block_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    const pzs_amplifier *t = tables;
    const pzs_control *control = signals->control;
    pzs_amplifier_state *a = self;
    if (!(t->step >= 0) || !(t->dead_band >= 0))
        return PZS_E_ARGUMENT;
    a->tables = t;
    a->given = (void *)((uint8_t *)self + PZS_ALIGNED(sizeof *a));
    memcpy(a->given, control->state.voltage, control->state.problem->inputs * sizeof *a->given);
    return PZS_OK;
}

static pzs_status block_tick(void *self, pzs_loop_signals *signals)
{
    const pzs_amplifier_state *a = self;
    return pzs_quantise(signals->control, a->given, a->tables->step, a->tables->dead_band);
}

const pzs_block_type pzs_amplifier_block = {"amplifier", PZS_PHASE_VOLTAGE, block_bytes, block_init,
                                            block_tick};
