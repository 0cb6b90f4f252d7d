/* SPDX-License-Identifier: BSD-2-Clause */
/* Outputs that are stresses at nodes (output_calls.h). */
#include "output_calls.h"
#include "strain.h"
#include "stress_field.h"
#include "stress_summary.h"

/*
 * Value of scene_output.part for the von Mises stress. Smaller values stand for the stress
 * components 11 22 33 23 13 12.
 */
enum { PART_MISES = 6 };

/*
 * Return the value that an output of the scene has in one element; the output is a stress component
 * or the von Mises stress of a layer (Pa).
 */
static double in_element(const stress_field *field, const scene_output *output, int element)
{
    stress_layer layer;
    stress_layer_of(field, element, output->layer, &layer);
    const double *stress = layer.at[output->height].stress;
    const double turn = output->angle - field->state.design->layer[output->layer].angle;
    double turned[STRESS_COMPONENTS];
    if (output->part == PART_MISES)
        return stress_mises(stress);
    strain_turn_stress(stress, turn * 0.017453292519943295, turned);
    return turned[output->part];
}

const output_calls stress_calls = {.in_element = in_element, .check = strain_check};
