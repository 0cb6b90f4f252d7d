/* SPDX-License-Identifier: BSD-2-Clause */
/* The plant of a simulation: a structure that differs from the controller's model (plant.h). */
#include "plant.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../model/material_scale.h"
#include "../model/mass.h"
#include "influence_sum.h"

/* ---- open ------------------------------------------------------------- */

/*
 * Append a temperature change of 1 K to the loads of the plant's scene. Returns 0, or -1 where
 * memory runs out.
 */
static int add_temperature(plant *plant)
{
    const char *why;
    int column;
    plant->kelvin = expr_compile("1", &column, &why);
    plant->scene.load[plant->scene.loads++] =
        (scene_load){.type = LOAD_TEMPERATURE, .value = plant->kelvin};
    return plant->kelvin ? 0 : -1;
}

static int has_temperature_events(const scene_simulate *simulate)
{
    for (int i = 0; i < simulate->events; i++)
        if (simulate->event[i].type == EVENT_TEMPERATURE)
            return 1;
    return 0;
}

/* Next number of a pseudo-random sequence that is equal on every computer, uniform in [0, 1). */
static double random_number(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return (*state >> 8) * 0x1p-24;
}

/*
 * Multiply the columns of a measured influence matrix by the gains of the plant, and the entries by
 * random factors around 1.
 */
static void scale_matrix(scene *scene)
{
    const scene_simulate *simulate = &scene->simulate;
    const size_t amplifiers = (size_t)scene->amplifiers;
    uint32_t state = (uint32_t)simulate->seed + 1;
    for (size_t i = 0; i < (size_t)scene->influence.outputs * amplifiers; i++) {
        double error = -6; /* the sum of twelve uniform random numbers has the variance 1 */
        for (int k = 0; k < 12; k++)
            error += random_number(&state);
        scene->influence.matrix[i] *=
            (simulate->gain ? simulate->gain[i % amplifiers] : 1) * (1 + simulate->scatter * error);
    }
}

static int change_scene(plant *plant)
{
    scene *scene = &plant->scene;
    const scene_simulate *simulate = &scene->simulate;
    scale_matrix(scene);
    scene->kinematics = simulate->kinematics;
    for (int i = 0; i < scene->materials; i++)
        material_scale(&scene->material[i], simulate->stiffness ? simulate->stiffness[i] : 1,
                       simulate->d ? simulate->d[i] : 1);
    return has_temperature_events(simulate) ? add_temperature(plant) : 0;
}

/*
 * Whether the plant has inertia: where the scene asks for it, or where the scene does not say and
 * all densities are given. A plant with a contact has no inertia, because its modes depend on the
 * nodes in contact; a plant with sensors of voltages or charges has none, because the modes have no
 * output rows for them. The member `reason` says why a plant has no inertia.
 */
static bool wants_inertia(plant *plant)
{
    const design *design = &plant->analysis.design;
    char names[SCENE_ERROR];
    const char *why = NULL;
    for (int i = 0; i < design->estimate.readings && design->simulate.sight != SIGHT_MEASURED; i++)
        if (design->output[design->estimate.reading[i].output].electric != ELECTRIC_NONE)
            why = "a sensor is an electrode";
    if (design->contact.given)
        why = "the plant has a contact";
    if (!plant->analysis.source->has_structure)
        why = "a measured influence matrix tells nothing of mass";
    if (design->simulate.inertia_given && !design->simulate.inertia)
        why = "the scene says inertia: false";
    if (why)
        snprintf(plant->reason, sizeof plant->reason, "%s", why);
    else if (mass_missing(design, names) > 0)
        snprintf(plant->reason, sizeof plant->reason, "no density of %.300s", names);
    return plant->reason[0] == '\0';
}

/* Compute the modes of the plant. Returns 0, or -1 with error filled. */
static int prepare_modes(plant *plant, char *error)
{
    const design *design = &plant->analysis.design;
    const size_t inputs = (size_t)(design->amplifiers + design->loads);
    if (!wants_inertia(plant))
        return design->simulate.inertia
                   ? scene_fault(design->simulate.at, error,
                                 "a plant with inertia is not possible: %.300s", plant->reason)
                   : 0;
    if (vibration_solve(&plant->vibration, design, design->simulate.modes, MASS_LUMPED, error) < 0)
        return -1;
    plant->modal_input = calloc(inputs + 1, sizeof *plant->modal_input);
    plant->deviation = calloc((size_t)design->structure.output.count + 1, sizeof *plant->deviation);
    plant->has_inertia = true;
    if (!plant->modal_input || !plant->deviation ||
        !modal_open(&plant->modal, design, &plant->vibration, inputs) ||
        !inertia_open(&plant->inertia, &plant->modal))
        return scene_fault(design->simulate.at, error, "out of memory");
    return 0;
}

int plant_open(plant *plant, const design *nominal, char *error)
{
    memset(plant, 0, sizeof *plant);
    plant->temperature = -1;
    int failed = design_vary(nominal, &plant->scene) < 0 || change_scene(plant) < 0;
    if (failed)
        scene_fault(nominal->simulate.at, error, "out of memory");
    failed = failed || analysis_prepare(&plant->analysis, &plant->scene, error) < 0 ||
             analysis_influence(&plant->analysis, error) < 0 || prepare_modes(plant, error) < 0;
    const design *design = &plant->analysis.design;
    if (!failed) {
        plant->input = calloc((size_t)design->structure.input.count, sizeof *plant->input);
        plant->computed_input =
            calloc((size_t)design->structure.input.count, sizeof *plant->computed_input);
        plant->scene_input =
            calloc((size_t)design->structure.input.count, sizeof *plant->scene_input);
        plant->value = calloc((size_t)design->structure.output.count + 1, sizeof *plant->value);
        failed = !plant->input || !plant->computed_input || !plant->scene_input || !plant->value
                     ? scene_fault(nominal->simulate.at, error, "out of memory")
                     : 0;
    }
    if (failed) {
        plant_close(plant);
        return -1;
    }
    if (plant->analysis.is_nonlinear)
        memcpy(plant->scene_input, plant->analysis.equilibrium.full_input,
               (size_t)design->structure.input.count * sizeof *plant->scene_input);
    if (has_temperature_events(&design->simulate))
        plant->temperature = design->amplifiers + design->loads - 1;
    plant_rest(plant);
    return 0;
}

void plant_close(plant *plant)
{
    if (plant->analysis.source)
        analysis_free(&plant->analysis);
    scene_vary_free(&plant->scene);
    expr_free(plant->kelvin);
    inertia_close(&plant->inertia);
    modal_close(&plant->modal);
    vibration_free(&plant->vibration);
    free(plant->modal_input);
    free(plant->deviation);
    free(plant->input);
    free(plant->computed_input);
    free(plant->scene_input);
    free(plant->value);
    memset(plant, 0, sizeof *plant);
}

/* ---- loads ------------------------------------------------------------ */

/*
 * Index of the input that belongs to a load. On a nonlinear structure each follower load (load that
 * turns with the surface) has its own input behind those of all loads, in the order of the loads.
 */
static int input_of(const plant *plant, int load)
{
    const design *design = &plant->analysis.design;
    int extra = design->amplifiers + design->loads;
    if (!plant->analysis.is_nonlinear ||
        plant->analysis.design.load[load].follower == FOLLOWER_NONE)
        return design->amplifiers + load;
    for (int k = 0; k < load; k++)
        extra += plant->analysis.design.load[k].follower != FOLLOWER_NONE;
    return extra;
}

void plant_load(plant *plant, int load, double factor)
{
    plant->input[input_of(plant, load)] = factor;
}

void plant_warm(plant *plant, double kelvin)
{
    if (plant->temperature >= 0)
        plant->input[plant->temperature] = kelvin;
}

void plant_rest(plant *plant)
{
    const design *design = &plant->analysis.design;
    memcpy(plant->input, plant->scene_input,
           (size_t)design->structure.input.count * sizeof *plant->input);
    for (int k = 0; k < design->loads; k++)
        plant_load(plant, k, 1);
    plant_warm(plant, 0);
    plant->has_shape = false;
    plant->is_at_rest = true;
}

/* ---- vibration -------------------------------------------------------- */

/*
 * Set the inputs of the modal model to their present values. At the first call after plant_rest the
 * plant is at rest in the equilibrium under these inputs.
 */
static void set_modal_inputs(plant *plant)
{
    const design *design = &plant->analysis.design;
    const size_t amplifiers = (size_t)design->amplifiers;
    memcpy(plant->modal_input, plant->input, amplifiers * sizeof *plant->modal_input);
    for (int k = 0; k < design->loads; k++)
        plant->modal_input[amplifiers + (size_t)k] = plant->input[input_of(plant, k)];
    if (plant->is_at_rest)
        inertia_rest(&plant->inertia, plant->modal_input);
    else
        inertia_jump(&plant->inertia, plant->modal_input);
    plant->is_at_rest = false;
}

void plant_kick(plant *plant, int load, double seconds)
{
    if (plant->has_inertia)
        inertia_kick(&plant->inertia, (size_t)(plant->analysis.design.amplifiers + load), seconds);
}

void plant_elapse(plant *plant, const double *voltage, double seconds)
{
    if (!plant->has_inertia)
        return;
    memcpy(plant->input, voltage, (size_t)plant->analysis.design.amplifiers * sizeof *voltage);
    set_modal_inputs(plant);
    inertia_advance(&plant->inertia, seconds);
}

double plant_vibration(const plant *plant)
{
    return plant->has_inertia
               ? sqrt(design_squares(&plant->analysis.design, plant->deviation, NULL))
               : 0;
}

double plant_period(const plant *plant)
{
    const bool has_modes = plant->has_inertia && plant->modal.modes > 0;
    return has_modes ? 2 * 3.14159265358979323846 / plant->modal.frequency[0] : 0;
}

/* Compute the deviation of every output row from the static equilibrium. */
static void compute_deviation(plant *plant)
{
    if (!plant->has_inertia)
        return;
    set_modal_inputs(plant);
    inertia_observe(&plant->inertia, 0, plant->modal.rows, plant->deviation);
}

/* ---- shapes ----------------------------------------------------------- */

static void sum_columns(const plant *plant, size_t rows, double *shape)
{
    influence_sum(plant->analysis.influence, plant->input, rows,
                  plant->analysis.design.structure.input.count, shape);
}

/*
 * Compute the equilibrium under the present inputs, starting from the latest shape. Where the
 * inputs have not changed, the latest shape is kept.
 */
static int compute_equilibrium(plant *plant, char *error)
{
    analysis *analysis = &plant->analysis;
    pzs_solver *run = &analysis->equilibrium.solver;
    const size_t bytes = analysis->design.structure.input.count * sizeof *plant->input;
    if (plant->has_shape && memcmp(plant->input, plant->computed_input, bytes) == 0)
        return 0;
    if (!plant->has_shape)
        pzs_solver_reset(run);
    analysis->status = pzs_equilibrium(run, plant->input);
    plant->linear_solves += run->info.linear_solves;
    plant->has_shape = true;
    memcpy(plant->computed_input, plant->input, bytes);
    return PZS_IS_ERROR(analysis->status) ? analysis_explain(analysis, analysis->status, error) : 0;
}

/*
 * Compute the static shape under voltages and the present loads.
 *   voltage [amplifiers] in   (V)
 *   shape   [targets]    out
 */
static int static_shape(plant *plant, const double *voltage, double *shape, char *error)
{
    memcpy(plant->input, voltage, (size_t)plant->analysis.design.amplifiers * sizeof *voltage);
    if (!plant->analysis.is_nonlinear) {
        sum_columns(plant, (size_t)plant->analysis.design.targets, shape);
        return 0;
    }
    if (compute_equilibrium(plant, error) < 0)
        return -1;
    design_shape(&plant->analysis.design, plant->analysis.equilibrium.solver.info.displacement,
                 shape);
    return 0;
}

int plant_shape(plant *plant, const double *voltage, double *shape, char *error)
{
    if (static_shape(plant, voltage, shape, error) < 0)
        return -1;
    compute_deviation(plant);
    for (int i = 0; i < plant->analysis.design.targets && plant->has_inertia; i++)
        shape[i] += plant->deviation[i];
    return 0;
}

/*
 * Compute all static output values, including the voltages and charges of electrodes where the
 * scene has such outputs.
 */
static pzs_status compute_outputs(plant *plant)
{
    analysis *analysis = &plant->analysis;
    if (analysis->is_nonlinear)
        pzs_observe(&analysis->design.structure, analysis->equilibrium.solver.info.displacement,
                    plant->value);
    else
        sum_columns(plant, analysis->design.structure.output.count, plant->value);
    return analysis_electrodes(analysis, plant->input);
}

int plant_readings(plant *plant, double *reading, char *error)
{
    const analysis *analysis = &plant->analysis;
    const scene_estimate *estimate = &plant->analysis.design.estimate;
    const pzs_status status = compute_outputs(plant);
    for (size_t i = 0; i < analysis->design.structure.output.count && plant->has_inertia; i++)
        plant->value[i] += plant->deviation[i];
    for (int index = 0; index < estimate->readings; index++)
        for (int i = 0; i < analysis_outputs(analysis, estimate->reading[index].output); i++)
            *reading++ =
                analysis_output(analysis, estimate->reading[index].output, i, plant->value);
    return status == PZS_OK ? 0 : analysis_explain(analysis, status, error);
}

/*
 * Compute the displacement vector of the static equilibrium.
 *   displacement [free_dof] out
 */
static int static_displacement(plant *plant, double *displacement, char *error)
{
    analysis *analysis = &plant->analysis;
    if (analysis->is_nonlinear) {
        memcpy(displacement, analysis->equilibrium.solver.info.displacement,
               (size_t)analysis->design.mesh.free_dof * sizeof *displacement);
        return 0;
    }
    const pzs_status status = analysis_displace(analysis, plant->input, displacement);
    return status == PZS_OK ? 0 : analysis_explain(analysis, status, error);
}

int plant_displacement(plant *plant, double *displacement, char *error)
{
    const size_t dof = (size_t)plant->analysis.design.mesh.free_dof;
    if (static_displacement(plant, displacement, error) < 0)
        return -1;
    for (size_t i = 0; i < plant->modal.modes && plant->has_inertia; i++) {
        const double *modal_part =
            plant->vibration.shape + ((size_t)plant->vibration.rigid + i) * dof;
        for (size_t k = 0; k < dof; k++)
            displacement[k] += plant->inertia.deviation[i] * modal_part[k];
    }
    return 0;
}

/* ---- optimum ---------------------------------------------------------- */

/*
 * Compute the displacements that the voltages must cause on the linear structure: target minus
 * displacements under the present loads.
 */
static void set_wanted(plant *plant, const double *target)
{
    design *design = &plant->analysis.design;
    const size_t inputs = design->structure.input.count;
    for (size_t i = 0; i < (size_t)design->targets; i++) {
        design->target[i] = target[i];
        design->wanted[i] = 0;
        for (int k = 0; k < design->loads; k++)
            design->wanted[i] +=
                plant->analysis.influence[i * inputs + (size_t)(design->amplifiers + k)] *
                plant->input[input_of(plant, k)];
    }
    design_take_free(design, design->target);
    design_take_free(design, design->wanted);
    for (int i = 0; i < design->targets; i++)
        design->wanted[i] = design->target[i] - design->wanted[i];
}

int plant_optimum(plant *plant, const double *target, const double *lowest, const double *highest,
                  voltages *best, double *shape, char *error)
{
    analysis *analysis = &plant->analysis;
    design *design = &analysis->design;
    const size_t amplifiers = (size_t)design->amplifiers;
    double *limit = malloc(2 * amplifiers * sizeof *limit);
    if (!limit)
        return analysis_explain(analysis, PZS_E_WORKSPACE, error);
    memcpy(limit, design->lower, amplifiers * sizeof *limit);
    memcpy(limit + amplifiers, design->upper, amplifiers * sizeof *limit);
    memcpy(design->lower, lowest, amplifiers * sizeof *lowest);
    memcpy(design->upper, highest, amplifiers * sizeof *highest);
    set_wanted(plant, target);
    if (analysis->is_nonlinear)
        memcpy(analysis->equilibrium.full_input, plant->input,
               design->structure.input.count * sizeof *plant->input);
    const int failed =
        voltages_optimum(analysis, (common_limits){.source = LIMITS_SCENE}, best, error) < 0;
    memcpy(design->lower, limit, amplifiers * sizeof *limit);
    memcpy(design->upper, limit + amplifiers, amplifiers * sizeof *limit);
    free(limit);
    plant->has_shape = false;
    return failed ? -1 : static_shape(plant, best->voltage, shape, error);
}
