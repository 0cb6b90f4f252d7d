/* SPDX-License-Identifier: BSD-2-Clause */
/* Strains and stresses at nodes as outputs of a scene (stress_output.h). */
#include "stress_output.h"
#include "output_calls.h"
#include "strain.h"

/*
 * Return the value of an output of the scene that is a strain or stress at a node. The value is the
 * mean, weighted with the areas, over those elements at the node that contain the layer of the
 * output.
 */
static double value_at(const stress_field *field, const scene_output *output, int node)
{
    const output_calls *calls = output_calls_of(output);
    const mesh *mesh = &field->state.design->mesh;
    const double area = strain_area(mesh, output, node);
    double sum = 0;
    for (int i = field->node_start[node]; i < field->node_start[node + 1]; i++) {
        const int element = field->node_element[i];
        const double share = mesh->place[mesh->element_type[element]].area / area;
        if (!strain_is_in(mesh, output, element, node))
            continue;
        sum += share * calls->in_element(field, output, element);
    }
    return sum;
}

void stress_outputs(const stress_field *field, double *value)
{
    const design *design = field->state.design;
    for (int k = 0; k < design->outputs; k++)
        for (int i = design->place_first[k]; i < design->place_first[k + 1]; i++)
            if (output_is_recovered(&design->output[k]))
                value[i] = value_at(field, &design->output[k], design->place_node[i]);
}
