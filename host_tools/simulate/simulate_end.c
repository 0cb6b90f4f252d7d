/* SPDX-License-Identifier: BSD-2-Clause */
/* Whether a simulated loop ends far from its target (simulation.h). */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "plant_motion.h"
#include "simulation.h"

/*
 * Relative shape error of a phase without voltages; NAN where the structure has no equilibrium
 * there.
 */
static double error_without_voltages(simulation *simulation, const simulate_phase *phase,
                                     double *shape)
{
    plant *plant = &simulation->plant;
    const design *design = &simulation->nominal->design;
    char ignored[SCENE_ERROR];
    plant_rest(plant);
    memset(plant->input, 0, (size_t)design->amplifiers * sizeof *plant->input);
    for (int k = 0; k < design->loads; k++)
        plant_load(plant, k, phase->load[k]);
    plant_warm(plant, phase->load[design->loads]);
    if (plant_static_shape(plant, shape, ignored) < 0)
        return (double)NAN;
    return sqrt(design_squares(design, shape, phase->target)) / simulation->reference;
}

double simulate_divergence(simulation *simulation)
{
    const simulate_phase *last = &simulation->phase[simulation->phases - 1];
    const double steady = last->course[LAW_CONTROLLER].steady;
    double largest = 1;
    double *shape = calloc((size_t)simulation->nominal->design.targets, sizeof *shape);
    for (int k = 0; k < simulation->phases && shape && steady > largest; k++) {
        const simulate_phase *phase = &simulation->phase[k];
        largest =
            fmax(largest, fmax(phase->optimum, error_without_voltages(simulation, phase, shape)));
    }
    free(shape);
    return isfinite(steady) ? steady / largest : HUGE_VAL;
}
