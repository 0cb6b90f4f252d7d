/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Vibration of a structure about its static equilibrium, computed for each vibration mode
 * separately (inertia.h).
 */
#include "inertia.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/core/product.h"
#include "../model/propagator.h"

/* Number of inputs whose jumps are added to the deviations of the modes in one call. */
enum { JUMP_BATCH = 64 };

void inertia_place(inertia *inertia, const modal *modal, double *memory)
{
    const size_t modes = modal->modes;
    memset(inertia, 0, sizeof *inertia);
    inertia->modal = modal;
    inertia->gain = inertia->stretch = 1;
    inertia->deviation = memory;
    inertia->velocity = inertia->deviation + modes;
    inertia->propagator = inertia->velocity + modes;
    inertia->input = inertia->propagator + 4 * modes;
    inertia->response = inertia->input + modal->inputs;
}

bool inertia_open(inertia *inertia, const modal *modal)
{
    double *memory = calloc(INERTIA_REALS(modal->modes, modal->inputs), sizeof *memory);
    memset(inertia, 0, sizeof *inertia);
    if (!memory)
        return false;
    inertia_place(inertia, modal, memory);
    inertia->memory = memory;
    return true;
}

void inertia_close(inertia *inertia)
{
    free(inertia->memory);
    memset(inertia, 0, sizeof *inertia);
}

void inertia_rest(inertia *inertia, const double *input)
{
    memset(inertia->deviation, 0, 2 * inertia->modal->modes * sizeof *inertia->deviation);
    memcpy(inertia->input, input, inertia->modal->inputs * sizeof *input);
}

/*
 * Compute the static responses of the simulated vibration modes to the inputs: `gain` times those
 * of the model. Nothing is done if `gain` has not changed.
 */
static void scale_responses(inertia *inertia)
{
    const modal *modal = inertia->modal;
    const size_t modes = modal->modes, inputs = modal->inputs;
    if (!(inertia->gain < inertia->response_gain || inertia->gain > inertia->response_gain))
        return;
    for (size_t i = 0; i < modes; i++)
        for (size_t k = 0; k < inputs; k++)
            inertia->response[k * modes + i] = inertia->gain * modal->response[i * inputs + k];
    inertia->response_gain = inertia->gain;
}

/*
 * Set some inputs to new values, and subtract the changes of the equilibrium from the deviations.
 *   from, to in  first of these inputs, and the input after the last one; at most JUMP_BATCH inputs
 */
static void jump_inputs(inertia *inertia, const double *input, size_t from, size_t to)
{
    const size_t modes = inertia->modal->modes;
    double change[JUMP_BATCH];
    uint16_t changed[JUMP_BATCH];
    size_t count = 0;
    for (size_t k = from; k < to; k++) {
        const double difference = input[k] - inertia->input[k];
        inertia->input[k] = input[k];
        if (difference == 0)
            continue;
        change[count] = difference;
        changed[count++] = (uint16_t)(k - from);
    }
    pzs_product_subtract_rows(inertia->deviation, inertia->response + from * modes, modes, changed,
                              change, count, modes);
}

void inertia_jump(inertia *inertia, const double *input)
{
    const size_t inputs = inertia->modal->inputs;
    scale_responses(inertia);
    for (size_t from = 0; from < inputs; from += JUMP_BATCH) {
        const size_t rest = inputs - from;
        jump_inputs(inertia, input, from, from + (rest < JUMP_BATCH ? rest : JUMP_BATCH));
    }
}

void inertia_kick(inertia *inertia, size_t input, double seconds)
{
    const modal *modal = inertia->modal;
    for (size_t i = 0; i < modal->modes; i++)
        inertia->velocity[i] += inertia->stretch * modal->frequency[i] * inertia->gain *
                                modal->response[i * modal->inputs + input] * seconds;
}

void inertia_advance(inertia *inertia, double interval)
{
    const modal *modal = inertia->modal;
    if (interval == 0)
        return;
    for (size_t i = 0; i < modal->modes; i++) {
        double *r = inertia->propagator + 4 * i;
        if (interval < inertia->interval || interval > inertia->interval)
            modal_propagator(inertia->stretch * modal->frequency[i], modal->damping[i], interval,
                             r);
        const double d = inertia->deviation[i], p = inertia->velocity[i];
        inertia->deviation[i] = r[0] * d + r[1] * p;
        inertia->velocity[i] = r[2] * d + r[3] * p;
    }
    inertia->interval = interval;
}

void inertia_observe(const inertia *inertia, size_t first, size_t rows, double *out)
{
    const size_t modes = inertia->modal->modes;
    pzs_product_matrix(out, inertia->modal->shape + first * modes, inertia->deviation, rows, modes);
}

double inertia_energy(const inertia *inertia)
{
    double sum = 0;
    for (size_t i = 0; i < inertia->modal->modes; i++) {
        const double frequency = inertia->stretch * inertia->modal->frequency[i];
        sum += frequency * frequency *
               (inertia->deviation[i] * inertia->deviation[i] +
                inertia->velocity[i] * inertia->velocity[i]) /
               2;
    }
    return sum;
}
