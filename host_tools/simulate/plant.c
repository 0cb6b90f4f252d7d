/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The plant of a simulation: the simulated structure, which differs from the model of the
 * controller (plant.h).
 */
#include "plant.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/model/electrode.h"
#include "../model/mass.h"
#include "../model/material_scale.h"
#include "influence_sum.h"
#include "plant_motion.h"

/* All ways of computing the motion of a plant with inertia. */
static const plant_motion *const motions[MOTION_NONLINEAR + 1] = {
    [MOTION_MODAL] = &plant_modal, [MOTION_NONLINEAR] = &plant_nonlinear};

/* ---- preparation of the plant ----------------------------------------- */

/*
 * Append a temperature change of 1 K to the loads of the plant's scene. Returns 0, or -1 if memory
 * runs out.
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

/*
 * Return the next number of a pseudo-random sequence, uniform in [0, 1), which is the same on every
 * computer.
 */
static double random_number(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return (*state >> 8) * 0x1p-24;
}

/*
 * Make the measured influence matrix of a plant differ from the controller's: columns, and the
 * static responses of measured modes, are multiplied by the plant's gain for the amplifier, and
 * entries by a random factor near 1.
 */
static void scale_matrix(scene *scene)
{
    const scene_simulate *simulate = &scene->simulate;
    const size_t amplifiers = (size_t)scene->amplifiers;
    uint32_t state = (uint32_t)simulate->seed + 1;
    for (size_t i = 0; i < (size_t)scene->influence.outputs * amplifiers; i++) {
        double error = -6; /* minus six makes the mean 0: the sum of twelve random numbers, uniform
                              from 0 to 1, has the mean 6 and the variance 1 */
        for (int k = 0; k < 12; k++)
            error += random_number(&state);
        scene->influence.matrix[i] *=
            (simulate->gain ? simulate->gain[i % amplifiers] : 1) * (1 + simulate->scatter * error);
    }
    for (int mode = 0; mode < scene->influence.modes && simulate->gain; mode++)
        for (size_t k = 0; k < amplifiers && scene->influence.mode[mode].response; k++)
            scene->influence.mode[mode].response[k] *= simulate->gain[k];
}

static int change_scene(plant *plant)
{
    scene *scene = &plant->scene;
    const scene_simulate *simulate = &scene->simulate;
    scale_matrix(scene);
    /*
     * Remove the actuator curves from the model of the simulated structure. Its inputs are
     * proportional to the displacements of the actuators, because imperfections_actuate has already
     * applied the curves to the voltages.
     */
    memset(&scene->influence.curve, 0, sizeof scene->influence.curve);
    scene->kinematics = simulate->kinematics;
    for (int i = 0; i < scene->materials; i++) {
        const double stiffness = simulate->stiffness ? simulate->stiffness[i] : 1;
        const double piezo = simulate->d ? simulate->d[i] : 1;
        material_scale(&scene->material[i], stiffness, piezo);
    }
    return has_temperature_events(simulate) ? add_temperature(plant) : 0;
}

/*
 * Return whether the plant moves with inertia. Otherwise the member `reason` of the plant says why
 * not.
 */
static bool wants_inertia(plant *plant)
{
    const design *design = &plant->analysis.design;
    char names[SCENE_ERROR];
    const char *why = NULL;
    /*
     * The modal model has no output rows for sensors that measure voltages or charges of
     * electrodes.
     */
    if (design->simulate.sight != SIGHT_MEASURED && !design_reads_displacements(design))
        why = "a sensor is an electrode";
    /*
     * With contact, a linear model is not possible: the vibration modes depend on which nodes are
     * in contact.
     */
    if (design->contact.given)
        why = "the plant has a contact";
    if (!plant->analysis.source->has_structure && design->measured.modes == 0)
        why = "a measured influence matrix tells nothing of mass";
    if (design->simulate.inertia_given && !design->simulate.inertia)
        why = "the scene says inertia: false";
    if (why)
        snprintf(plant->reason, sizeof plant->reason, "%s", why);
    else if (mass_missing(design, names) > 0)
        snprintf(plant->reason, sizeof plant->reason, "no density of %.300s", names);
    return plant->reason[0] == '\0';
}

/*
 * Choose how a plant with inertia moves. A nonlinear motion, which is the default of a nonlinear
 * plant, is refused for a plant with open electrodes, because their voltages would be unknowns of
 * each time step.
 */
static int choose_motion(plant *plant, char *error)
{
    const scene_simulate *simulate = &plant->analysis.design.simulate;
    const bool is_open = pzs_electrode_open_count(&plant->analysis.design.electrodes) > 0;
    const bool is_nonlinear = simulate->motion == MOTION_NONLINEAR;
    if (is_nonlinear && is_open)
        return scene_fault(simulate->at, error,
                           "motion: nonlinear%s is not possible with open electrodes; write "
                           "plant: {motion: modal} in simulate, without steps",
                           simulate->motion_given ? "" : ", the default of a nonlinear plant,");
    plant->motion = motions[simulate->motion];
    return 0;
}

/*
 * Compute the vibration modes of a plant with inertia and prepare its motion. Returns 0, or -1 with
 * error filled.
 */
static int prepare_motion(plant *plant, char *error)
{
    const design *design = &plant->analysis.design;
    const size_t inputs = (size_t)(design->amplifiers + design->loads);
    plant->motion = &plant_quasi_static;
    if (!wants_inertia(plant))
        return design->simulate.inertia
                   ? scene_fault(design->simulate.at, error,
                                 "a plant with inertia is not possible: %.300s", plant->reason)
                   : 0;
    if (analysis_vibration(&plant->analysis, &plant->vibration, design->simulate.modes, error) <
            0 ||
        choose_motion(plant, error) < 0)
        return -1;
    plant->deviation = calloc((size_t)design->structure.output.count + 1, sizeof *plant->deviation);
    plant->has_inertia = true;
    if (!plant->deviation || !modal_open(&plant->modal, design, &plant->vibration, inputs))
        return scene_fault(design->simulate.at, error, "out of memory");
    return plant->motion->open(plant, error);
}

int plant_open(plant *plant, const design *nominal, char *error)
{
    memset(plant, 0, sizeof *plant);
    plant->temperature = -1;
    int failed = design_vary(nominal, &plant->scene) < 0 || change_scene(plant) < 0;
    if (failed)
        scene_fault(nominal->simulate.at, error, "out of memory");
    failed = failed || analysis_prepare(&plant->analysis, &plant->scene, error) < 0 ||
             analysis_influence(&plant->analysis, error) < 0 || prepare_motion(plant, error) < 0;
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
    if (plant->motion)
        plant->motion->close(plant);
    modal_close(&plant->modal);
    vibration_free(&plant->vibration);
    free(plant->deviation);
    free(plant->input);
    free(plant->computed_input);
    free(plant->scene_input);
    free(plant->value);
    memset(plant, 0, sizeof *plant);
}

/* ---- loads of the plant ----------------------------------------------- */

int plant_input(const plant *plant, int load)
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
    plant->input[plant_input(plant, load)] = factor;
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

/* ---- motion of the plant ---------------------------------------------- */

static void set_voltages(plant *plant, const double *voltage)
{
    memcpy(plant->input, voltage, (size_t)plant->analysis.design.amplifiers * sizeof *voltage);
}

void plant_kick(plant *plant, int load, double seconds)
{
    plant->motion->kick(plant, load, seconds);
}

int plant_elapse(plant *plant, const double *voltage, double seconds, char *error)
{
    set_voltages(plant, voltage);
    return plant->motion->advance(plant, seconds, error);
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

int plant_shape(plant *plant, const double *voltage, double *shape, char *error)
{
    set_voltages(plant, voltage);
    return plant->motion->shape(plant, shape, error);
}

int plant_readings(plant *plant, double *reading, char *error)
{
    const analysis *analysis = &plant->analysis;
    const scene_estimate *estimate = &plant->analysis.design.estimate;
    if (plant->motion->outputs(plant, error) < 0)
        return -1;
    for (int index = 0; index < estimate->readings; index++)
        for (int i = 0; i < analysis_outputs(analysis, estimate->reading[index].output); i++)
            *reading++ =
                analysis_output(analysis, estimate->reading[index].output, i, plant->value);
    return 0;
}

int plant_displacement(plant *plant, double *displacement, char *error)
{
    return plant->motion->displacement(plant, displacement, error);
}

/* ---- quasi-static plant ----------------------------------------------- */

static void sum_columns(const plant *plant, size_t rows, double *shape)
{
    influence_sum(plant->analysis.influence, plant->input, rows,
                  plant->analysis.design.structure.input.count, shape);
}

/*
 * Compute the static equilibrium of the plant under its present voltages, loads and temperature,
 * starting from its latest shape. If these inputs have not changed, the latest shape is kept.
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

int plant_static_shape(plant *plant, double *shape, char *error)
{
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

int plant_static_outputs(plant *plant, char *error)
{
    analysis *analysis = &plant->analysis;
    if (analysis->is_nonlinear)
        pzs_observe(&analysis->design.structure, analysis->equilibrium.solver.info.displacement,
                    plant->value);
    else
        sum_columns(plant, analysis->design.structure.output.count, plant->value);
    const pzs_status status = analysis_electrodes(analysis, plant->input);
    return status == PZS_OK ? 0 : analysis_explain(analysis, status, error);
}

int plant_static_displacement(plant *plant, double *displacement, char *error)
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

static int no_open(plant *plant, char *error)
{
    (void)plant;
    (void)error;
    return 0;
}

static void no_close(plant *plant)
{
    (void)plant;
}

static void no_kick(plant *plant, int load, double seconds)
{
    (void)plant;
    (void)load;
    (void)seconds;
}

static int no_time(plant *plant, double seconds, char *error)
{
    (void)plant;
    (void)seconds;
    (void)error;
    return 0;
}

const plant_motion plant_quasi_static = {"quasi-static",
                                         no_open,
                                         no_close,
                                         no_kick,
                                         no_time,
                                         plant_static_shape,
                                         plant_static_outputs,
                                         plant_static_displacement};

/* ---- optimal voltages ------------------------------------------------- */

/*
 * Compute the displacements at the target rows (controlled displacements) that the voltages must
 * cause on the linear structure: target minus displacements under the present loads, both without
 * their part along the free functions (shapes that may be added to the target at no cost).
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
                plant->input[plant_input(plant, k)];
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
    if (failed)
        return -1;
    set_voltages(plant, best->voltage);
    return plant_static_shape(plant, shape, error);
}
