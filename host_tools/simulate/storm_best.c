/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Best shape that the limits of a storm, a simulation of a control loop, allow on its structure
 * (storm_state.h).
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/control/control.h"
#include "../../lib/core/product.h"
#include "storm_state.h"

/* Number of static control steps that find the voltages at which a control loop comes to rest. */
enum { REST_STEPS = 200 };

double storm_distance(const storm *storm, const double *first, const double *second)
{
    return sqrt(design_squares(&storm->rig->analysis->design, first, second));
}

double storm_offset(const storm *storm, size_t row)
{
    const double offset = storm->rig->offset && !storm_is_free(storm) ? storm->rig->offset[row] : 0;
    return offset + storm->load[row];
}

void storm_compute_rest(storm *storm, const double *voltage)
{
    const storm_rig *rig = storm->rig;
    pzs_product_matrix(storm->best_shape, rig->influence, voltage, rig->targets, rig->amplifiers);
    for (size_t i = 0; i < rig->targets; i++)
        storm->best_shape[i] = storm->best_shape[i] * storm->plant->gain + storm_offset(storm, i);
}

/*
 * Find the voltages at which a control loop comes to rest on a structure whose influence matrix
 * differs from the controller's. They are not the best ones, because the controller uses its own
 * matrix.
 *   control  in/out  controller with its own influence matrix; its voltage limits are those of the
 *       voltages that can act on the ceramic
 */
static pzs_status find_rest(storm *storm, pzs_control *control)
{
    const size_t amplifiers = storm->rig->amplifiers, targets = storm->rig->targets;
    const double *tables = storm->rig->analysis->design.problem.influence;
    pzs_status status = PZS_OK;
    for (int step = 0; step < REST_STEPS && !PZS_IS_ERROR(status); step++) {
        storm_compute_rest(storm, control->info.voltage);
        pzs_product_matrix(storm->part, tables, control->info.voltage, targets, amplifiers);
        for (size_t i = 0; i < targets; i++)
            /* Each static control step corrects half of the shape error. */
            storm->part[i] += (storm->last_target[i] - storm->best_shape[i]) / 2;
        status = pzs_step(control, storm->part);
    }
    return status;
}

/*
 * Compute the influence matrix of the simulated structure for the voltage optimisation, without the
 * free functions of the target (shapes that may be added to it at no cost). Small entries, which
 * the controller may leave out, are included.
 *   column    [targets]             out  work array
 *   influence [targets][amplifiers] out  displacement per volt (length unit/V)
 */
static void take_plant_influence(const storm *storm, double *column, double *influence)
{
    const storm_rig *rig = storm->rig;
    design_influence_free(&rig->analysis->design, rig->influence, rig->amplifiers, column,
                          influence);
    for (size_t i = 0; i < rig->targets * rig->amplifiers; i++)
        influence[i] *= storm->plant->gain;
}

/*
 * Make the voltage optimisation problem of the best shape: without step limits, and with the lowest
 * and highest voltages that can act on the ceramic as limits.
 *   wide [amplifiers] out  infinite step limits; must outlive the problem
 */
static pzs_problem best_problem(const storm *storm, double *wide)
{
    const size_t amplifiers = storm->rig->amplifiers;
    pzs_problem problem = storm->rig->analysis->design.problem;
    for (size_t k = 0; k < amplifiers; k++)
        wide[k] = HUGE_VAL;
    problem.step_limit = wide;
    problem.lower = storm->stroke;
    problem.upper = storm->stroke + amplifiers;
    problem.hessian = NULL;
    problem.crc = pzs_problem_crc(&problem);
    return problem;
}

/*
 * Solve the voltage optimisation problem of the best shape, and compute this shape.
 *   influence [targets][amplifiers] in   influence matrix of the problem
 *   work      [bytes]               in   memory of the optimiser
 *   voltage   [amplifiers]          out  best voltages (V)
 */
static pzs_status solve_best(storm *storm, const pzs_problem *problem, const double *influence,
                             void *work, size_t bytes, double *voltage)
{
    const bool is_deformed = storm->rig->offset != NULL;
    pzs_control control;
    pzs_status status = pzs_control_init(&control, problem, influence, work, bytes);
    if (!PZS_IS_ERROR(status))
        status = is_deformed ? find_rest(storm, &control) : pzs_step(&control, storm->last_target);
    if (PZS_IS_ERROR(status))
        return status;
    storm_compute_rest(storm, control.info.voltage);
    memcpy(voltage, control.info.voltage, storm->rig->amplifiers * sizeof *voltage);
    return status;
}

pzs_status storm_find_best(storm *storm, double *voltage)
{
    const size_t amplifiers = storm->rig->amplifiers, targets = storm->rig->targets;
    const pzs_problem *given = &storm->rig->analysis->design.problem;
    double *influence = malloc((targets * amplifiers + amplifiers + targets) * sizeof *influence);
    const size_t bytes = pzs_control_bytes(given);
    void *work = malloc(bytes);
    pzs_status status = PZS_E_WORKSPACE;
    if (influence && work) {
        double *wide = influence + targets * amplifiers;
        const pzs_problem problem = best_problem(storm, wide);
        if (storm->rig->offset)
            memcpy(influence, given->influence, targets * amplifiers * sizeof *influence);
        else
            take_plant_influence(storm, wide + amplifiers, influence);
        status = solve_best(storm, &problem, influence, work, bytes, voltage);
    }
    free(influence);
    free(work);
    return status;
}
