/* SPDX-License-Identifier: BSD-2-Clause */
/* Lookup of the functions of an output by its type (output_calls.h). */
#include "output_calls.h"

const output_calls *output_calls_of(const scene_output *output)
{
#define CALLS_OF(type, word, keys, of, quantity, spread, reading, finish, calls) [type] = &calls,
    static const output_calls *const all[OUTPUT_TYPE_COUNT] = {OUTPUT_TYPES(CALLS_OF)};
    return all[output->type];
}

bool output_has_rows(const scene_output *output)
{
    return output_calls_of(output)->add_row != NULL;
}

bool output_is_recovered(const scene_output *output)
{
    return output_calls_of(output)->in_element != NULL;
}
