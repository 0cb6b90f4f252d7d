/* SPDX-License-Identifier: BSD-2-Clause */
/* Outputs that are voltages or charges of electrodes (output_calls.h). */
#include "electrodes.h"
#include "output_calls.h"

static double voltage(const output_state *state, int k, int i)
{
    const design *design = state->design;
    return state->input_value[electrodes_input(design, &design->output[k], i)];
}

static double charge(const output_state *state, int k, int i)
{
    const design *design = state->design;
    const int input = electrodes_input(design, &design->output[k], i);
    return state->charge[electrodes_of(design, input)];
}

const output_calls voltage_calls = {.value = voltage}, charge_calls = {.value = charge};
