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

void inertia_jump(inertia *inertia, const double *input)
{
    const modal *modal = inertia->modal;
    for (size_t k = 0; k < modal->inputs; k++) {
        const double change = input[k] - inertia->input[k];
        inertia->input[k] = input[k];
        if (change == 0)
            continue;
        for (size_t i = 0; i < modal->modes; i++)
            inertia->deviation[i] -=
                inertia->gain * modal->response[i * modal->inputs + k] * change;
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
