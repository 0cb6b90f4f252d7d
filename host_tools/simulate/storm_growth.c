/* SPDX-License-Identifier: BSD-2-Clause */
/* Growth of small vibrations of a control loop on a structure with mass, without limits (storm.h).
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "random.h"
#include "storm.h"
#include "storm_state.h"

/*
 * Return the amplitude of small oscillations of a control loop: the root of the sum of the squares
 * of two norms, each weighted with the target weights. One is the norm of the vibration
 * displacements. The other is the norm of the static displacements that the last change of the
 * voltages causes; it is there because the voltages can oscillate without vibration.
 */
static double amplitude(storm *storm)
{
    const size_t amplifiers = storm->rig->amplifiers;
    double *moved = storm->best_shape;
    for (size_t k = 0; k < amplifiers; k++)
        storm->previous_voltage[k] = storm->voltage[k] - storm->previous_voltage[k];
    tick_matrix_multiply(&storm->rig->static_shape, storm->previous_voltage, moved);
    storm_observe_vibration(storm);
    return hypot(storm_distance(storm, moved, NULL), storm_distance(storm, storm->part, NULL));
}

double storm_slope(const double *value, int count)
{
    const double middle = (count - 1) / 2.0;
    double product = 0, square = 0;
    for (int i = 0; i < count; i++) {
        product += (i - middle) * value[i];
        square += (i - middle) * (i - middle);
    }
    return square > 0 ? product / square : 0;
}

static pzs_status run_free(storm *storm, int ticks, double *size, storm_result *result)
{
    const modal *modal = &storm->rig->modal;
    const double scale = storm->rig->scale;
    for (size_t i = 0; i < modal->modes; i++) {
        storm->inertia.deviation[i] = 2 * random_uniform(&storm->random) - 1;
        storm->inertia.velocity[i] = 2 * random_uniform(&storm->random) - 1;
    }
    const double unit = 1e-3 * scale / fmax(amplitude(storm), 1e-300);
    for (size_t i = 0; i < modal->modes; i++) {
        storm->inertia.deviation[i] *= unit;
        storm->inertia.velocity[i] *= unit;
    }
    storm->has_vibration = storm->has_shape = false;
    memset(storm->target, 0, storm->rig->targets * sizeof *storm->target);
    int k = 0;
    for (; k < ticks; k++) {
        const pzs_status status = storm_tick(storm);
        if (PZS_IS_ERROR(status))
            return status;
        size[k] = log(fmax(amplitude(storm), 1e-300));
        if (fabs(size[k] - log(1e-3 * scale)) > log(1e6))
            break;
    }
    result->ticks = k < ticks ? k + 1 : ticks;
    result->growth = exp(storm_slope(size + result->ticks / 2, result->ticks - result->ticks / 2));
    result->passed = result->growth < 1;
    return PZS_OK;
}

int storm_growth(const storm_rig *rig, const storm_plant *plant, int ticks, storm_result *result,
                 char *error)
{
    storm storm;
    double *size = malloc((size_t)ticks * sizeof *size);
    memset(result, 0, sizeof *result);
    int failed = storm_begin(&storm, rig, plant, error);
    if (!failed && !size)
        failed = storm_no_memory(rig->analysis, error);
    if (!failed) {
        const pzs_status status = run_free(&storm, ticks, size, result);
        if (PZS_IS_ERROR(status))
            failed = storm_explain(&storm, status, error);
    }
    storm_end(&storm);
    free(size);
    return failed;
}
