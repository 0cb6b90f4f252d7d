/* SPDX-License-Identifier: BSD-2-Clause */
/* Outputs that are quantities of contact with a rigid body (output_calls.h). */
#include "equilibrium.h"
#include "output_calls.h"

/* Return the number of nodes that output k names; 0: the output is that of the whole shell. */
static int node_count(const design *design, int k)
{
    return design->place_first[k + 1] - design->place_first[k];
}

/*
 * Return a component of the force of the rigid body on the nodes of the output, or on the whole
 * shell (N).
 */
static double force(const output_state *state, int k, int i)
{
    const design *design = state->design;
    const int part = design->output[k].part;
    double sum = 0;
    (void)i;
    if (node_count(design, k) == 0)
        return state->equilibrium->contact.info.force[part];
    for (int n = design->place_first[k]; n < design->place_first[k + 1]; n++) {
        double of_node[3];
        equilibrium_contact_force(state->equilibrium, design->place_node[n], of_node);
        sum += of_node[part];
    }
    return sum;
}

/*
 * Return the number of nodes that touch the rigid body, among the nodes of the output or of the
 * whole shell.
 */
static double nodes(const output_state *state, int k, int i)
{
    const design *design = state->design;
    const pzs_contact *contact = &state->equilibrium->contact;
    int count = 0;
    (void)i;
    if (node_count(design, k) == 0)
        return contact->info.nodes;
    for (int n = design->place_first[k]; n < design->place_first[k + 1]; n++)
        count += contact->info.pressure[design->place_node[n]] > 0;
    return count;
}

/* Return the pressure of the rigid body on the shell at a node (N/m2). */
static double pressure(const output_state *state, int k, int i)
{
    const design *design = state->design;
    return state->equilibrium->contact.info
        .pressure[design->place_node[design->place_first[k] + i]];
}

const output_calls contact_force_calls = {.value = force}, contact_nodes_calls = {.value = nodes},
                   contact_pressure_calls = {.value = pressure};
