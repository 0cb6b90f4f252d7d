/* SPDX-License-Identifier: BSD-2-Clause */
/* Outputs that are reactions of supports (output_calls.h). */
#include "output_calls.h"
#include "reactions.h"

/*
 * Return a component of the reaction that output k gives.
 *   component in  0 to 2: force along x, y, z; 3 to 5: moment about x, y, z
 */
static double reaction(const output_state *state, int k, int component)
{
    const design *design = state->design;
    const scene_output *output = &design->output[k];
    const int first = design->place_first[k], count = design->place_first[k + 1] - first;
    if (output->support[0])
        return reactions_of(state->reactions, output->support, component);
    return reactions_at(state->reactions, &design->mesh, design->place_node + first, count,
                        component);
}

static double force(const output_state *state, int k, int i)
{
    (void)i;
    return reaction(state, k, state->design->output[k].part);
}

static double moment(const output_state *state, int k, int i)
{
    (void)i;
    return reaction(state, k, 3 + state->design->output[k].part);
}

const output_calls reaction_force_calls = {.value = force, .needs_reactions = true},
                   reaction_moment_calls = {.value = moment, .needs_reactions = true};
