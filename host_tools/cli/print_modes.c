/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Shape errors on standard output for a target that is a list of shapes, for which the voltages are
 * optimised one by one (print_modes.h).
 */
#include "print_modes.h"
#include <stdio.h>

/*
 * For a target that is a list of shapes, print for each pair of a lower and an upper voltage limit
 * a table with the error that the optimal voltages leave of each shape.
 */
void print_modes(const design *design, const modes *modes)
{
    for (int bound = 0; modes->count > 0 && bound < modes->limits; bound++) {
        const double *limit = modes->left[bound].limit;
        printf("\n  mode by mode, shape error within %g .. %g V:\n", limit[0], limit[1]);
        printf("  %-20s %12s %11s %12s %11s %7s %11s %12s\n", "mode", "rms wanted", "no limits",
               "largest (V)", "in limits", "active", "clipped", "regularised");
        for (int k = 0; k < modes->count; k++) {
            const mode_left *left = &modes->left[k * modes->limits + bound];
            printf("  %-20s %12.3e %10.3f%% %12.2f %10.3f%% %7d %10.3f%% %11.3f%%\n",
                   design->goal.mode[k].name, modes->mode[k].size,
                   100 * modes->mode[k].unconstrained_error, modes->mode[k].largest_voltage,
                   100 * left->optimum, left->active_limits, 100 * left->clipped,
                   100 * left->regularised);
        }
    }
}

void print_modes_json(json *json, const design *design, const modes *modes)
{
    json_open(json, "modes", '[');
    for (int k = 0; k < modes->count; k++) {
        json_open(json, NULL, '{');
        json_string(json, "name", design->goal.mode[k].name);
        json_number(json, "rms", modes->mode[k].size);
        json_number(json, "unconstrained_error", modes->mode[k].unconstrained_error);
        json_number(json, "largest_volt", modes->mode[k].largest_voltage);
        json_open(json, "limits", '[');
        for (int bound = 0; bound < modes->limits; bound++) {
            const mode_left *left = &modes->left[k * modes->limits + bound];
            json_open(json, NULL, '{');
            json_numbers(json, "limits", left->limit, 2);
            json_number(json, "shape_error", left->optimum);
            json_number(json, "active", left->active_limits);
            json_number(json, "clipped_error", left->clipped);
            json_number(json, "regularised_error", left->regularised);
            json_close(json, '}');
        }
        json_close(json, ']');
        json_close(json, '}');
    }
    json_close(json, ']');
}
