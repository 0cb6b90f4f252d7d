/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Simulation of a control loop on a structure with mass, on which a load appears at once
 * (load_step.h).
 */
#include "load_step.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/core/product.h"
#include "storm_state.h"

static const double two_pi = 6.283185307179586;

/*
 * Loads of the load steps: a uniform pressure, forces at two outputs (the output that moves most
 * under its own force, and the output in the middle of the list), and loads that move one vibration
 * mode only.
 */
typedef enum load_shape {
    LOAD_UNIFORM,
    LOAD_SOFTEST,
    LOAD_MIDDLE,
    LOAD_FIRST_MODE,
    LOAD_THIRD_MODE,
    LOAD_SHAPES
} load_shape;

enum {
    LOAD_REST = 2, /* time for which the simulation goes on after the shape has settled (periods of
                      the first vibration mode that the loop observes) */
    START_PERIODS = 20 /* If voltages are near a limit before a load step, the loop first moves them
                          to the middle of their limits, in at most this number of periods of the
                          first vibration mode that it observes */
};

/*
 * Load steps excite only vibration modes whose phase advances in a tick by at most this angle
 * (rad). The control tick damps these modes in full; faster modes would decay by their own damping
 * alone.
 */
static const double load_angle = 0.6;

/*
 * Size of the simulated loads: part of half the range between its limits by which a voltage changes
 * to compensate the load, for the voltage that changes most.
 */
static const double load_share = 0.3;

/*
 * Largest part of the effect of a load that the best voltages may leave. If they leave more,
 * voltages cannot compensate the load, and it is not applied. The effect is the norm of the
 * displacements of the targets that the load causes.
 */
static const double load_left = 0.2;

/*
 * The loop is at rest when the distance of the shape from its equilibrium has fallen to this
 * fraction of its largest value. Before a load step it may have to come to rest at other voltages.
 */
static const double at_rest = 1e-3;

/* A load step: its vibration modes, and the modal coordinates of the load. */
typedef struct load_step {
    storm *storm;
    size_t from, to; /* first vibration mode that the load moves, and the mode after the last */
    double period;   /* period of the first vibration mode (ticks) */
    double *modal;   /* [modes of the plant] modal coordinates of the structure in equilibrium under
                        the load */
    double *start;   /* [targets] shape before the load step (m) */
    double *voltage; /* [amplifiers] best voltages under the load (V) */
} load_step;

/* Index of the first vibration mode whose natural frequency is at least `frequency` (Hz). */
static size_t mode_from(const modal *modal, double frequency)
{
    size_t mode = 0;
    while (mode + 1 < modal->modes && modal->frequency[mode] < 0.999 * two_pi * frequency)
        mode++;
    return mode;
}

/*
 * Static displacement of an output under a unit force at this output, as a sum over the vibration
 * modes that the loads of load steps move (from step->from to step->to - 1).
 */
static double compliance(const load_step *step, size_t row)
{
    const modal *modal = &step->storm->rig->modal;
    double sum = 0;
    for (size_t i = step->from; i < step->to; i++)
        sum += pow(modal->shape[row * modal->modes + i] / modal->frequency[i], 2);
    return sum;
}

/*
 * Return the index of the output at which the force of a load acts: the middle one in the list for
 * LOAD_MIDDLE, otherwise the output that moves most under its own force.
 */
static size_t loaded_row(const load_step *step, load_shape shape)
{
    const size_t targets = step->storm->rig->targets;
    size_t softest = 0;
    if (shape == LOAD_MIDDLE)
        return targets / 2;
    for (size_t row = 1; row < targets; row++)
        if (compliance(step, row) > compliance(step, softest))
            softest = row;
    return softest;
}

/*
 * Return the modal force on vibration mode i at unit modal mass (product of the mode's shape and
 * the load), for a uniform pressure or for a unit force at output `row`.
 */
static double modal_force(const load_step *step, load_shape shape, size_t row, size_t i)
{
    const storm_rig *rig = step->storm->rig;
    const double *weight = rig->analysis->design.weight;
    double sum = 0;
    if (shape != LOAD_UNIFORM)
        return rig->modal.shape[row * rig->modal.modes + i];
    for (size_t target = 0; target < rig->targets; target++)
        sum += weight[target] * weight[target] * rig->modal.shape[target * rig->modal.modes + i];
    return sum;
}

/*
 * Set step->modal, the modal coordinates of the structure in equilibrium under a load of a given
 * distribution. The size of the load is arbitrary; scale_load sets it later.
 */
static void set_load(load_step *step, load_shape shape)
{
    const modal *modal = &step->storm->rig->modal;
    const size_t last = step->to - 1, third = step->from + 2 < last ? step->from + 2 : last,
                 row = loaded_row(step, shape);
    memset(step->modal, 0, modal->modes * sizeof *step->modal);
    if (shape == LOAD_FIRST_MODE || shape == LOAD_THIRD_MODE) {
        step->modal[shape == LOAD_FIRST_MODE ? step->from : third] = 1;
        return;
    }
    for (size_t i = step->from; i < step->to; i++)
        step->modal[i] = modal_force(step, shape, row, i) / pow(modal->frequency[i], 2);
}

/*
 * Multiply the load of a load step by a factor, and compute the static displacements of all outputs
 * under it.
 */
static void scale_load(load_step *step, double factor)
{
    const modal *modal = &step->storm->rig->modal;
    for (size_t i = 0; i < modal->modes; i++)
        step->modal[i] *= factor;
    pzs_product_matrix(step->storm->load, modal->shape, step->modal, modal->rows, modal->modes);
}

/*
 * Find the voltages with which the shape under the load comes nearest to the shape before the load
 * step, and that nearest shape.
 */
static pzs_status find_loaded_best(load_step *step)
{
    storm *storm = step->storm;
    for (size_t i = 0; i < storm->rig->targets; i++)
        storm->last_target[i] = step->start[i] - storm->load[i];
    return storm_find_best(storm, step->voltage);
}

/*
 * Largest difference between the best voltages under the load and the present voltages, relative to
 * half the range between the voltage limits; 0 without limits.
 */
static double largest_change(const load_step *step)
{
    const storm_rig *rig = step->storm->rig;
    double largest = 0;
    for (size_t k = 0; k < rig->amplifiers; k++) {
        const double half = (rig->upper[k] - rig->lower[k]) / 2;
        if (half > 0)
            largest = fmax(largest, fabs(step->voltage[k] - step->storm->voltage[k]) / half);
    }
    return largest;
}

/*
 * Apply a load of a given distribution, as large as the voltages can well compensate: no voltage
 * then changes by more than load_share of half its range.
 *   size out  norm of the displacements of the targets by the load, without compensation; 0: no
 *             load is applied, because it moves nothing or the voltages cannot compensate it
 */
static pzs_status size_load(load_step *step, load_shape shape, double *size)
{
    storm *storm = step->storm;
    const double small = 1e-3;
    *size = 0;
    set_load(step, shape);
    scale_load(step, 1);
    const double norm = storm_distance(storm, storm->load, NULL);
    if (!(norm > 0))
        return PZS_OK;
    scale_load(step, small * storm->rig->scale / norm);
    pzs_status status = find_loaded_best(step);
    const double change = largest_change(step);
    if (PZS_IS_ERROR(status) || storm_distance(storm, storm->best_shape, step->start) >
                                    load_left * small * storm->rig->scale)
        return status;
    /*
     * Scale the load so that the compensating voltages change by load_share of half their range.
     * Without voltage limits, the displacements of the target nodes by the load become load_share
     * times the unit of shape errors.
     */
    scale_load(step, load_share / (change > 0 ? change : small));
    *size = storm_distance(storm, storm->load, NULL);
    return find_loaded_best(step);
}

/*
 * Whether a voltage is so near to one of its limits at the start that the loop could not compensate
 * a load.
 */
static bool starts_near_limit(const storm *storm)
{
    const storm_rig *rig = storm->rig;
    for (size_t k = 0; k < rig->amplifiers; k++) {
        const double range = rig->upper[k] - rig->lower[k], voltage = storm->voltage[k];
        if (fmin(rig->upper[k] - voltage, voltage - rig->lower[k]) < load_share / 2 * range)
            return true;
    }
    return false;
}

/*
 * Bring the loop to rest before a load step. It rests at the voltages with which it starts; if one
 * of them is near a limit, all voltages first move to the middle of their limits.
 */
static pzs_status start_loop(load_step *step)
{
    storm *storm = step->storm;
    const storm_rig *rig = storm->rig;
    const bool moves = starts_near_limit(storm);
    const int ticks = moves ? (int)ceil(START_PERIODS * step->period) : 0;
    int rested = 0;
    double largest = 0;
    pzs_status status = PZS_OK;
    for (size_t k = 0; k < rig->amplifiers; k++)
        step->voltage[k] = moves ? (rig->lower[k] + rig->upper[k]) / 2 : storm->voltage[k];
    storm_compute_rest(storm, step->voltage);
    memcpy(step->start, storm->best_shape, rig->targets * sizeof *step->start);
    memcpy(storm->target, step->start, rig->targets * sizeof *storm->target);
    for (int k = 0; k < ticks && rested < step->period && !PZS_IS_ERROR(status); k++) {
        storm_compute_shape(storm);
        const double distance = storm_distance(storm, storm->shape, step->start);
        largest = fmax(largest, distance);
        rested = distance < at_rest * largest ? rested + 1 : 0;
        status = storm_tick(storm);
    }
    return status;
}

/*
 * Simulate the loop under a load that has just appeared, until the shape stays within 5 % of `size`
 * from the best shape under the load. Returns the status of the loop.
 *   size  in   norm of the displacements that the load causes without compensation (m)
 *   ticks out  number of ticks until the shape has settled
 */
static pzs_status run_load(load_step *step, double size, int *ticks)
{
    storm *storm = step->storm;
    const int most = (int)ceil(CERTIFICATE_LOAD_MOST * step->period),
              rest = (int)ceil(LOAD_REST * step->period);
    *ticks = 0;
    for (int k = 0; k < most && k < *ticks + rest; k++) {
        const pzs_status status = storm_tick(storm);
        if (PZS_IS_ERROR(status))
            return status;
        storm_compute_shape(storm);
        const double distance = storm_distance(storm, storm->shape, storm->best_shape) / size;
        if (!(distance <= CERTIFICATE_TOLERANCE))
            *ticks = k + 1;
    }
    return PZS_OK;
}

/*
 * Simulate a load step: the loop comes to rest, a load appears at once, and the loop compensates
 * it.
 *   ticks out  number of ticks until 5 % of the displacements by the load are left; -1: the load is
 *       not applied, because the voltages cannot compensate it
 */
static pzs_status step_load(load_step *step, load_shape shape, int *ticks)
{
    storm *storm = step->storm;
    double size = 0;
    *ticks = -1;
    pzs_status status = start_loop(step);
    if (!PZS_IS_ERROR(status))
        status = size_load(step, shape, &size);
    if (PZS_IS_ERROR(status) || !(size > 0))
        return status;
    for (size_t i = 0; i < storm->rig->modal.modes; i++)
        storm->inertia.deviation[i] -= step->modal[i];
    storm->has_vibration = storm->has_shape = false;
    return run_load(step, size, ticks);
}

/*
 * Simulate a load step (a load that appears at once) on a structure that equals the controller's
 * model. Returns 0, or -1 with error filled.
 *   ticks out  number of ticks until 5 % of the displacements by the load are left; -1: the load is
 *       not applied, because the voltages cannot compensate it
 */
static int try_load(const storm_rig *rig, load_step *step, load_shape shape, int *ticks,
                    char *error)
{
    static const storm_plant nominal = {.gain = 1, .frequency = 1, .step_limit = 1, .seed = 1};
    storm storm;
    int failed = storm_begin(&storm, rig, &nominal, error);
    step->storm = &storm;
    if (!failed) {
        const pzs_status status = step_load(step, shape, ticks);
        if (PZS_IS_ERROR(status))
            failed = storm_explain(&storm, status, error);
    }
    storm_end(&storm);
    return failed;
}

int load_step_periods(const storm_rig *rig, double first, double *periods, char *error)
{
    const modal *modal = &rig->modal;
    load_step step = {.from = mode_from(modal, first)};
    int failed = 0;
    *periods = (double)NAN;
    step.to = step.from + 1;
    while (step.to < modal->modes && modal->frequency[step.to] * rig->interval <= load_angle)
        step.to++;
    step.period = two_pi / (modal->frequency[step.from] * rig->interval);
    step.modal = calloc(modal->modes + rig->targets + rig->amplifiers + 1, sizeof *step.modal);
    if (!step.modal)
        return storm_no_memory(rig->analysis, error);
    step.start = step.modal + modal->modes;
    step.voltage = step.start + rig->targets;
    const int shapes = step.to == step.from + 1 ? 1 : LOAD_SHAPES;
    for (int shape = 0; shape < shapes && !failed; shape++) {
        int ticks;
        failed = try_load(rig, &step, (load_shape)shape, &ticks, error);
        if (!failed && ticks >= 0)
            *periods = fmax(*periods, ticks / step.period);
    }
    free(step.modal);
    return failed;
}
