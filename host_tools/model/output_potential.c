/* SPDX-License-Identifier: BSD-2-Clause */
/* Outputs that are potentials of bare faces, which have no electrode (output_calls.h). */
#include "design.h"
#include "output_calls.h"

static double potential(const output_state *state, int k, int i)
{
    const design *design = state->design;
    const scene_output *output = &design->output[k];
    return bare_faces_potential(&design->bare, state->input_value, output->layer,
                                output->height > 0, design->place_node[design->place_first[k] + i]);
}

const output_calls potential_calls = {.value = potential};
