/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Data that all storms (simulations with fast jumps of the target) of a control loop share
 * (storm_rig.h).
 */
#include "storm_rig.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "imperfections_scene.h"

int storm_no_memory(const analysis *analysis, char *error)
{
    return scene_fault(analysis->design.simulate.at, error, "out of memory");
}

/*
 * Set the index of the structure's output row that each sensor measures: all target rows
 * (controlled displacements), or the outputs that the scene's `estimate` section names.
 */
static void list_rows(storm_rig *rig)
{
    const design *design = &rig->analysis->design;
    const scene_estimate *estimate = &design->estimate;
    size_t at = 0;
    if (!rig->estimator) {
        for (size_t i = 0; i < rig->sensors; i++)
            rig->row[i] = (uint32_t)i;
        return;
    }
    for (int reading = 0; reading < estimate->readings; reading++) {
        const int output = estimate->reading[reading].output;
        for (int row = design->named_first[output]; row < design->named_first[output + 1]; row++)
            if (at < rig->sensors)
                rig->row[at++] = (uint32_t)row;
    }
}

/*
 * Set the static displacements of the targets and static readings of the sensors per volt of each
 * amplifier.
 *   influence [outputs][inputs] in  influence matrix of the structure
 */
static void fill_static(storm_rig *rig, const double *influence)
{
    const size_t inputs = rig->analysis->design.structure.input.count, amplifiers = rig->amplifiers;
    for (size_t i = 0; i < rig->targets; i++)
        memcpy(rig->influence + i * amplifiers, influence + i * inputs,
               amplifiers * sizeof(double));
    for (size_t i = 0; i < rig->sensors; i++)
        memcpy(rig->direct + i * amplifiers, influence + rig->row[i] * inputs,
               amplifiers * sizeof(double));
}

/*
 * Set the voltage limits within which random voltages for targets are drawn; an amplifier without
 * finite limits stays at 0 V.
 */
static void fill_limits(storm_rig *rig)
{
    const design *design = &rig->analysis->design;
    for (size_t k = 0; k < rig->amplifiers; k++) {
        const bool is_finite = isfinite(design->lower[k]) && isfinite(design->upper[k]);
        rig->lower[k] = is_finite ? design->lower[k] : 0;
        rig->upper[k] = is_finite ? design->upper[k] : 0;
    }
}

/*
 * Smallest unit of shape errors, as a fraction of a typical norm of the shapes that the voltages
 * reach. That norm is the root mean square, over random signs, with every voltage at plus or minus
 * half its range from the middle.
 */
static const double least_scale = 0.02;

/*
 * Set the unit of shape errors, rig->scale. It is the norm of the target. The target may be nearly
 * zero, as in a loop that only damps vibration. The unit is therefore at least least_scale times a
 * typical norm of the shapes that the voltages can reach. Returns whether memory sufficed.
 */
static bool fill_scale(storm_rig *rig)
{
    const design *design = &rig->analysis->design;
    double squares = 0;
    double *column = calloc(rig->targets + 1, sizeof *column);
    for (size_t k = 0; k < rig->amplifiers && column; k++) {
        const double half = (rig->upper[k] - rig->lower[k]) / 2;
        for (size_t i = 0; i < rig->targets; i++)
            column[i] = half * rig->influence[i * rig->amplifiers + k];
        squares += design_squares(design, column, NULL);
    }
    rig->scale = fmax(sqrt(design_squares(design, design->target, NULL)),
                      fmax(least_scale * sqrt(squares), 1e-300));
    free(column);
    return column != NULL;
}

double storm_unit(const storm_rig *rig)
{
    const design *design = &rig->analysis->design;
    const double norm = sqrt(design_squares(design, design->target, NULL));
    return norm > 0 ? rig->scale / norm : HUGE_VAL;
}

/*
 * Width of the hysteresis loop of the simulated plant relative to the voltage range. 0: the loop
 * compensates hysteresis, or the range is infinite.
 */
static double plant_hysteresis(const design *design)
{
    if (design->hysteresis.given)
        return 0;
    for (int k = 0; k < design->amplifiers; k++)
        if (!isfinite(design->upper[k] - design->lower[k]))
            return 0;
    return imperfections_hysteresis(design);
}

static bool take_memory(storm_rig *rig)
{
    const size_t amplifiers = rig->amplifiers, sensors = rig->sensors, targets = rig->targets;
    rig->memory = calloc(sensors * amplifiers + targets * amplifiers + 2 * amplifiers + 1,
                         sizeof *rig->memory);
    rig->row = calloc(sensors + 1, sizeof *rig->row);
    if (!rig->memory || !rig->row)
        return false;
    rig->direct = rig->memory;
    rig->influence = rig->direct + sensors * amplifiers;
    rig->lower = rig->influence + targets * amplifiers;
    rig->upper = rig->lower + amplifiers;
    return true;
}

static void close_ticks(storm_rig *rig)
{
    tick_matrix_close(&rig->static_shape);
    tick_matrix_close(&rig->static_reading);
    tick_matrix_close(&rig->vibration_shape);
    tick_matrix_close(&rig->vibration_reading);
}

/*
 * Fill, from the static responses and the vibration modes, the matrices that every tick of a storm
 * (simulation with fast jumps of the target) uses. Returns whether memory sufficed.
 */
static bool fill_ticks(storm_rig *rig)
{
    const modal *modal = &rig->modal;
    const size_t targets = rig->targets, sensors = rig->sensors, amplifiers = rig->amplifiers,
                 modes = modal->modes;
    close_ticks(rig);
    return tick_matrix_open(&rig->static_shape, rig->influence, amplifiers, NULL, targets,
                            amplifiers) &&
           tick_matrix_open(&rig->static_reading, rig->direct, amplifiers, NULL, sensors,
                            amplifiers) &&
           tick_matrix_open(&rig->vibration_shape, modal->shape, modes, NULL, targets, modes) &&
           tick_matrix_open(&rig->vibration_reading, modal->shape, modes, rig->row, sensors, modes);
}

void storm_use(storm_rig *rig, const pzs_block *block, int blocks, int delay)
{
    rig->blocks = 0;
    rig->supervision = NULL;
    for (int k = 0; k < blocks; k++)
        if (block[k].type->phase == PZS_PHASE_SUPERVISE)
            rig->supervision = block[k].tables;
        else
            rig->block[rig->blocks++] = block[k];
    rig->delay = delay;
}

/*
 * Fill a rig that is empty but for its vibration modes. Returns 0, or -1 with error filled.
 */
static int fill_rig(storm_rig *rig, const analysis *analysis, const estimator *estimator,
                    char *error)
{
    const design *design = &analysis->design;
    rig->analysis = analysis;
    rig->estimator = estimator;
    rig->interval = 1 / design->control.rate;
    rig->bandwidth = design->simulate.imperfections.bandwidth;
    rig->targets = (size_t)design->targets;
    rig->amplifiers = (size_t)design->amplifiers;
    rig->sensors = estimator ? (size_t)estimator->sensors : rig->targets;
    if (!take_memory(rig) || !modal_open(&rig->modal, design, &rig->vibration, rig->amplifiers))
        return storm_no_memory(analysis, error);
    list_rows(rig);
    fill_static(rig, analysis->influence);
    fill_limits(rig);
    if (!fill_ticks(rig) || !fill_scale(rig))
        return storm_no_memory(analysis, error);
    compensation_fill(&rig->ceramic, &design->hysteresis, &design->problem, design->control.rate);
    rig->play = plant_hysteresis(design);
    return 0;
}

int storm_open(storm_rig *rig, const analysis *analysis, const estimator *estimator, char *error)
{
    const design *design = &analysis->design;
    memset(rig, 0, sizeof *rig);
    if (analysis_vibration(analysis, &rig->vibration,
                           design->simulate.given ? design->simulate.modes : 100, error) < 0)
        return -1;
    return fill_rig(rig, analysis, estimator, error);
}

int storm_open_static(storm_rig *rig, const analysis *analysis, const estimator *estimator,
                      char *error)
{
    memset(rig, 0, sizeof *rig);
    return fill_rig(rig, analysis, estimator, error);
}

bool storm_deform(storm_rig *rig, const deformed *deformed)
{
    fill_static(rig, deformed->analysis.influence);
    rig->offset = deformed->offset;
    modal_close(&rig->modal);
    return modal_copy(&rig->modal, &deformed->modal) && fill_ticks(rig);
}

void storm_close(storm_rig *rig)
{
    close_ticks(rig);
    modal_close(&rig->modal);
    vibration_free(&rig->vibration);
    free(rig->memory);
    free(rig->row);
    memset(rig, 0, sizeof *rig);
}
