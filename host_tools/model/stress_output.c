/* SPDX-License-Identifier: BSD-2-Clause */
/* Strains and stresses at nodes as outputs of a scene (stress_output.h). */
#include "stress_output.h"
#include "strain.h"
#include "stress_summary.h"

/*
 * Return the value that an output of the scene has in one element; the output is a stress component
 * or the von Mises stress of a layer (Pa).
 */
static double stress_in(const stress_field *field, const scene_output *output, int element)
{
    stress_layer layer;
    stress_layer_of(field, element, output->layer, &layer);
    const double *stress = layer.at[output->height].stress;
    const double turn = output->angle - field->state.design->layer[output->layer].angle;
    double turned[STRESS_COMPONENTS];
    if (output->recovered_component == RECOVERED_MISES)
        return stress_mises(stress);
    strain_turn_stress(stress, turn * 0.017453292519943295, turned);
    return turned[output->recovered_component];
}

/*
 * Return the value of an output of the scene that is a strain or stress at a node. The value is the
 * mean, weighted with the areas, over those elements at the node that contain the layer of the
 * output.
 */
static double value_at(const stress_field *field, const scene_output *output, int node)
{
    const mesh *mesh = &field->state.design->mesh;
    const double area = strain_area(mesh, output, node);
    double sum = 0;
    for (int i = field->node_start[node]; i < field->node_start[node + 1]; i++) {
        const int element = field->node_element[i];
        const double share = mesh->place[mesh->element_type[element]].area / area;
        if (!strain_is_in(mesh, output, element, node))
            continue;
        sum +=
            share * (output->recovered == RECOVERED_STRESS
                         ? stress_in(field, output, element)
                         : strain_of_output(mesh, output, element, field->element[element].strain));
    }
    return sum;
}

void stress_outputs(const stress_field *field, double *value)
{
    const design *design = field->state.design;
    for (int k = 0; k < design->outputs; k++)
        for (int i = design->place_first[k]; i < design->place_first[k + 1]; i++)
            if (design->output[k].recovered != RECOVERED_NONE)
                value[i] = value_at(field, &design->output[k], design->place_node[i]);
}
