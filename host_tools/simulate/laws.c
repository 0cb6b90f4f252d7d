/* SPDX-License-Identifier: BSD-2-Clause */
/* Control laws for comparison: clipped least squares and leaky integrator (laws.h). */
#include "laws.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/control/control.h"
#include "amplifier.h"

bool law_open(law *law, const pzs_problem *problem, double regularisation)
{
    const size_t outputs = problem->outputs;
    memset(law, 0, sizeof *law);
    law->share = 1;
    law->problem = law->regularised = *problem;
    law->regularised.regularisation += regularisation;
    law->memory = calloc(2 * outputs + problem->inputs + 1, sizeof *law->memory);
    law->disturbance = law->memory;
    law->required = law->memory ? law->memory + outputs : NULL;
    law->next = law->memory ? law->required + outputs : NULL;
    return unconstrained_open(&law->solver, &law->regularised) && law->memory;
}

void law_close(law *law)
{
    unconstrained_close(&law->solver);
    free(law->memory);
    memset(law, 0, sizeof *law);
}

/* ---- clipping of voltages to limits ----------------------------------- */

void law_set_voltages(const law *law, const pzs_loop_signals *signals)
{
    pzs_control *control = signals->control;
    const pzs_control_info *info = &control->info;
    for (int k = 0; k < law->problem.inputs; k++) {
        const double clipped = fmin(fmax(law->next[k], info->lower[k]), info->upper[k]);
        const bool is_held = !(info->lower[k] < info->upper[k]);
        /*
         * Where actuators have curves, no step limit is applied here: the limits of effects (values
         * to which the displacements of the actuators are proportional) contain the step limits of
         * the voltages already.
         */
        control->state.voltage[k] =
            is_held || signals->curves
                ? clipped
                : amplifier_limited(info->voltage[k], clipped, law->problem.step_limit[k]);
    }
    pzs_control_moved(control);
}

/* ---- step blocks of the control laws ---------------------------------- */

static size_t law_bytes(const void *tables, const pzs_problem *problem)
{
    return pzs_step_block.block_bytes(tables, problem);
}

static pzs_status law_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    const law *law = tables;
    memset(law->disturbance, 0, law->problem.outputs * sizeof *law->disturbance);
    return pzs_step_block.block_init(self, tables, signals);
}

static law *law_of(const pzs_loop_signals *signals)
{
    return (law *)(void *)(uintptr_t)signals->control->state.problem;
}

/*
 * Return the displacement of one output (m) that the model of the controller predicts under the
 * present voltages.
 */
static double predicted_displacement(const law *law, const double *voltage, size_t output)
{
    const double *row = law->problem.influence + output * law->problem.inputs;
    double sum = 0;
    for (size_t k = 0; k < law->problem.inputs; k++)
        sum += row[k] * voltage[k];
    return sum;
}

static pzs_status clipped_tick(void *self, pzs_loop_signals *signals)
{
    law *law = law_of(signals);
    const double *voltage = signals->control->info.voltage;
    (void)self;
    for (size_t i = 0; i < law->problem.outputs; i++) {
        const double measured = signals->measured ? signals->measured[i] : (double)NAN;
        if (isfinite(measured))
            law->disturbance[i] = measured - predicted_displacement(law, voltage, i);
        law->required[i] = signals->wanted[i] - law->disturbance[i];
    }
    if (!unconstrained_solve(&law->solver, law->required, law->next))
        return PZS_E_NONFINITE;
    for (size_t k = 0; k < law->problem.inputs && law->share < 1; k++)
        law->next[k] = voltage[k] + law->share * (law->next[k] - voltage[k]);
    law_set_voltages(law, signals);
    return PZS_OK;
}

static pzs_status leaky_tick(void *self, pzs_loop_signals *signals)
{
    law *law = law_of(signals);
    const double *voltage = signals->control->info.voltage;
    (void)self;
    for (size_t i = 0; i < law->problem.outputs; i++) {
        const double measured = signals->measured ? signals->measured[i] : (double)NAN;
        law->required[i] = isfinite(measured) ? signals->wanted[i] - measured : 0;
    }
    if (!unconstrained_solve(&law->solver, law->required, law->next))
        return PZS_E_NONFINITE;
    for (size_t k = 0; k < law->problem.inputs; k++)
        law->next[k] = (1 - law->leak) * voltage[k] + law->gain * law->next[k];
    law_set_voltages(law, signals);
    return PZS_OK;
}

const pzs_block_type law_clipped_block = {"clipped", PZS_PHASE_STEP, law_bytes,
                                          law_init,  clipped_tick,   NULL};
const pzs_block_type law_leaky_block = {"leaky",  PZS_PHASE_STEP, law_bytes,
                                        law_init, leaky_tick,     NULL};
