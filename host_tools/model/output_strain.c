/* SPDX-License-Identifier: BSD-2-Clause */
/* Outputs that are strains at nodes (output_calls.h). */
#include "output_calls.h"
#include "strain.h"
#include "stress_field.h"

static double in_element(const stress_field *field, const scene_output *output, int element)
{
    return strain_of_output(&field->state.design->mesh, output, element,
                            field->element[element].strain);
}

const output_calls strain_calls = {
    .add_row = strain_row, .in_element = in_element, .check = strain_check};
