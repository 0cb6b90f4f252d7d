/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Voltage optimisation problem of a scene: Hessian, voltage limits, step limits, reference voltages
 * (design.h).
 */
#include "curves.h"
#include "design_rows.h"
#include "modal_gains.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/control/control.h"
#include "../../lib/core/guard.h"

/*
 * Add to the vector `sum` a factor times the vector `row`, in the entries from index `first` on. A
 * factor of zero, as from an entry of a sparse influence matrix, changes nothing.
 *   sum, row [count]
 */
static void add_products(double *sum, double factor, const double *row, size_t first, size_t count)
{
    if (!(fabs(factor) > 0))
        return;
    for (size_t k = first; k < count; k++)
        sum[k] += factor * row[k];
}

static double hessian_trace(const design *design)
{
    const size_t amplifiers = (size_t)design->amplifiers;
    double trace = 0;
    for (size_t j = 0; j < amplifiers; j++)
        trace += design->hessian[j * amplifiers + j];
    return trace;
}

double design_mean_diagonal(const design *design)
{
    return hessian_trace(design) / (double)design->amplifiers;
}

/*
 * Compute the Hessian B'W^2 B of half the squared error, with influence matrix B and weights W. It
 * is symmetric to the last bit, and has the bits of the Hessian that a device computes in double.
 * Returns the weight of the regularisation term of the voltages (m2/V2).
 */
static double build_hessian(design *design)
{
    const size_t amplifiers = (size_t)design->amplifiers;
    for (size_t i = 0; i < (size_t)design->targets; i++) {
        const double square = design->weight[i] * design->weight[i];
        const double *row = design->influence + i * amplifiers;
        for (size_t j = 0; j < amplifiers; j++)
            add_products(design->hessian + j * amplifiers, square * row[j], row, j, amplifiers);
    }
    for (size_t j = 0; j < amplifiers; j++)
        for (size_t k = 0; k < j; k++)
            design->hessian[j * amplifiers + k] = design->hessian[k * amplifiers + j];
    return design->scene->limits.regularisation_is_relative
               ? design->scene->limits.regularisation * hessian_trace(design) / design->amplifiers
               : design->scene->limits.regularisation;
}

/* ---- limits ----------------------------------------------------------- */

/* Voltage limits of all amplifiers while they are being computed. */
typedef struct limits {
    const scene *scene;
    double *lower, *upper; /* [amplifiers] lowest and highest voltage that each amplifier may give
                              (V) */
} limits;

double design_depolarising_voltage(const scene *scene, const scene_drive *drive)
{
    const scene_layer *layer = &scene->layer[scene->patches[drive->patches].layer];
    const double field = scene->material[layer->material].field_limit;
    const bool is_along = abs(layer->poling) == 3 || layer->finger_distance > 0;
    if (field <= 0 || drive->factor == 0 || !is_along)
        return (double)INFINITY;
    /*
     * At the voltage V of an actuator, the field in a patch is -factor V / (distance of its
     * electrodes), where `factor` is the number by which the actuator multiplies V for its patches.
     * The field opposes a positive poling where factor times V is positive.
     */
    const double distance = layer->finger_distance > 0 ? layer->finger_distance : layer->thickness;
    const double most = field * distance / fabs(drive->factor);
    return (drive->factor > 0) == (layer->poling > 0) ? most : -most;
}

/*
 * Narrow the voltage limits of amplifier k so that its patches in one grid do not depolarise: the
 * electric field against the poling direction must stay below the depolarisation field of their
 * material.
 */
static void narrow_by_field(const limits *limits, int k, const scene_drive *drive)
{
    const double voltage = design_depolarising_voltage(limits->scene, drive);
    if (voltage > 0)
        limits->upper[k] = fmin(limits->upper[k], voltage);
    else
        limits->lower[k] = fmax(limits->lower[k], voltage);
}

static void narrow_by_fields(const limits *limits)
{
    for (int index = 0; index < limits->scene->actuators; index++) {
        const scene_actuator *actuator = &limits->scene->actuator[index];
        for (int cell = 0; cell < actuator->grid[0] * actuator->grid[1]; cell++)
            for (int k = 0; k < actuator->drives && scene_has_electrodes(actuator); k++)
                narrow_by_field(limits, actuator->first + cell, &actuator->drive[k]);
    }
}

/*
 * Give every amplifier the limits that it has of its own in the scene file, otherwise common limits
 * (V).
 */
static void set_all(const limits *limits, double lower, double upper)
{
    for (int k = 0; k < limits->scene->amplifiers; k++) {
        limits->lower[k] = lower;
        limits->upper[k] = upper;
        scene_own_limits(limits->scene, k, &limits->lower[k], &limits->upper[k]);
    }
}

/*
 * Narrow the voltage limits of all amplifiers by common limits (V). An amplifier that is held at
 * one voltage keeps this voltage.
 */
static void narrow_by_common(const limits *limits, double lower, double upper)
{
    for (int k = 0; k < limits->scene->amplifiers; k++)
        if (limits->lower[k] != limits->upper[k]) {
            limits->lower[k] = fmax(limits->lower[k], lower);
            limits->upper[k] = fmin(limits->upper[k], upper);
        }
}

/* Remove the voltage limits of all amplifiers that are not held at one voltage. */
static void remove_limits(const limits *limits)
{
    for (int k = 0; k < limits->scene->amplifiers; k++)
        if (limits->lower[k] != limits->upper[k]) {
            limits->lower[k] = -HUGE_VAL;
            limits->upper[k] = HUGE_VAL;
        }
}

/*
 * Check that every amplifier has an allowed voltage. Returns 0, or -1 with error filled.
 *   which  in  for the message: names of the limits that do not overlap if an amplifier has no
 *       allowed voltage
 */
static int check_limits(const limits *bounds, const char *which, char *error)
{
    for (int k = 0; k < bounds->scene->amplifiers; k++)
        if (bounds->lower[k] > bounds->upper[k]) {
            char name[SCENE_LABEL];
            scene_amplifier_name(bounds->scene, k, name);
            return scene_fault(bounds->scene->limits.at, error,
                               "%s has no voltage left between %g and %g: %s do not overlap; "
                               "widen one of them",
                               name, bounds->lower[k], bounds->upper[k], which);
        }
    return 0;
}

/*
 * Set the step limit of every amplifier (V a tick): the smallest of the step limit for all
 * amplifiers and those that the scene file gives for this one.
 */
static void build_step_limits(const design *design)
{
    const scene_limits *from = &design->scene->limits;
    for (int k = 0; k < design->amplifiers; k++)
        design->step_limit[k] = from->step_limit;
    for (int i = 0; i < from->each_count; i++)
        for (int k = from->each[i].first; k < from->each[i].first + from->each[i].count; k++)
            design->step_limit[k] = fmin(design->step_limit[k], from->each[i].step_limit);
}

/*
 * Compute the voltage limits from the scene file. An amplifier has its own limits, or else those
 * common to all amplifiers. The depolarisation fields of its patches narrow these limits. Returns
 * 0, or -1 with error filled.
 */
static int build_limits(const design *design, char *error)
{
    const limits limits = {design->scene, design->lower, design->upper};
    set_all(&limits, design->scene->limits.lower, design->scene->limits.upper);
    if (check_limits(&limits,
                     limits.scene->influence.tied > 0
                         ? "its own limits and those of the actuators tied to it"
                         : "its items of limits.each",
                     error) < 0)
        return -1;
    narrow_by_fields(&limits);
    build_step_limits(design);
    return check_limits(&limits, "its own limits and the material's field_limit", error);
}

int design_limits(const design *design, common_limits common, double *lower, double *upper,
                  char *error)
{
    const limits bounds = {design->scene, lower, upper};
    const size_t bytes = (size_t)design->amplifiers * sizeof *lower;
    memcpy(lower, design->lower, bytes);
    memcpy(upper, design->upper, bytes);
    if (common.source == LIMITS_SCENE)
        return 0;
    if (common.source == LIMITS_NONE)
        remove_limits(&bounds);
    if (common.source == LIMITS_GIVEN) {
        set_all(&bounds, -HUGE_VAL, HUGE_VAL);
        narrow_by_fields(&bounds);
        narrow_by_common(&bounds, common.lower, common.upper);
    }
    curves_narrow(design, lower, upper);
    return check_limits(
        &bounds,
        curves_are_used(design)
            ? "the limits asked for, its own limits and the ends of its actuator curve"
            : "the limits asked for, its own limits and the material's field_limit",
        error);
}

bool design_is_held(const design *design, int amplifier)
{
    return design->lower[amplifier] == design->upper[amplifier];
}

const char *design_unit(const design *design, int amplifier)
{
    const bool is_heater = scene_is_heater(design->actuator, design->actuators, amplifier);
    return is_heater ? design->units.temperature : design->units.voltage;
}

design_inputs design_inputs_of(const design *design)
{
    int heaters = 0;
    for (int k = 0; k < design->amplifiers; k++)
        heaters += scene_is_heater(design->actuator, design->actuators, k);
    if (heaters > 0 && heaters == design->amplifiers)
        return (design_inputs){"temperature", "Temperature", design->units.temperature};
    return (design_inputs){"voltage", "Voltage", design->units.voltage};
}

/* ---- voltage optimisation problem -------------------------------------------------- */

static int allocate_control(design *design)
{
    const size_t amplifiers = (size_t)design->amplifiers;
    design->wanted = calloc((size_t)design->targets, sizeof *design->wanted);
    design->influence = calloc((size_t)design->targets * amplifiers, sizeof *design->influence);
    design->hessian = calloc(amplifiers * amplifiers, sizeof *design->hessian);
    design->lower = calloc(amplifiers, sizeof *design->lower);
    design->upper = calloc(amplifiers, sizeof *design->upper);
    design->step_limit = calloc(amplifiers, sizeof *design->step_limit);
    design->reference_voltage = calloc(amplifiers, sizeof *design->reference_voltage);
    design->park = calloc(amplifiers, sizeof *design->park);
    return design->park && design->wanted && design->influence && design->hessian &&
           design->lower && design->upper && design->step_limit && design->reference_voltage;
}

/*
 * Check that the park voltages (voltages of rest, also after a fault) violate no limit of a
 * weighted sum of voltages. Returns 0, or -1 with error filled.
 */
static int check_park_rows(const design *design, char *error)
{
    char name[4 * SCENE_LABEL], range[64];
    const int violated = design_rows_violated(design, design->park);
    if (violated < 0)
        return 0;
    design_row_name(design, violated, name, sizeof name);
    design_row_range(design, violated, range, sizeof range);
    if (design->scene->safety.park_is_common)
        return scene_fault(design->scene->safety.at, error,
                           "park: with all amplifiers at %g V, %s leaves its limits, %s; write "
                           "another voltage, or leave park out",
                           design->scene->safety.park[0], name, range);
    return scene_fault(design->scene->safety.at, error,
                       "park: with the park voltages of all amplifiers, %s leaves its limits, %s; "
                       "write other voltages of its amplifiers, or leave park out",
                       name, range);
}

/*
 * Check the park voltage (voltage after a fault) that the scene gives for amplifier k. If the scene
 * gives one park voltage for all amplifiers, it does not apply to an amplifier whose limits allow
 * only one voltage. Returns 0, or -1 with error filled.
 */
static int check_park(const design *design, size_t k, char *error)
{
    const scene_safety *safety = &design->scene->safety;
    const double lower = design->lower[k], upper = design->upper[k], park = safety->park[k];
    const bool is_exempt = safety->park_is_common && lower >= upper;
    if (isnan(park) || is_exempt || (park >= lower && park <= upper))
        return 0;
    return scene_fault(safety->at, error,
                       "park: %.9g V is outside the limits of %s, %.9g to %.9g; %s", park,
                       design->amplifier_name[k], lower, upper,
                       safety->park_is_common
                           ? "write a voltage inside the limits of all amplifiers, or leave park "
                             "out, with which each parks at the allowed voltage nearest to 0"
                           : "write a voltage inside them, or leave its name out, with which it "
                             "parks at the allowed voltage nearest to 0");
}

/*
 * Compute the park voltages, to which the supervisor returns after a fault: those of the scene, or,
 * where it gives none, those nearest to 0 within each amplifier's limits. Returns 0, or -1 with
 * error filled if a park voltage of the scene violates limits.
 */
static int build_park(design *design, char *error)
{
    const double *given = design->scene->safety.park;
    const size_t amplifiers = (size_t)design->amplifiers;
    for (size_t k = 0; k < amplifiers; k++) {
        if (given && check_park(design, k, error) < 0)
            return -1;
        const double wanted = given && !isnan(given[k]) ? given[k] : 0;
        design->park[k] = fmin(fmax(wanted, design->lower[k]), design->upper[k]);
    }
    if (given)
        return check_park_rows(design, error);
    /*
     * The park voltages nearest to 0 may violate limits between amplifiers. They are then replaced
     * by voltages that obey all limits.
     */
    if (design_rows_violated(design, design->park) >= 0)
        memcpy(design->park, design->rows.safe, amplifiers * sizeof *design->park);
    return 0;
}

/*
 * Let small entries of a measured influence matrix count as zero, if the scene file asks for it.
 * Returns 0, or -1 with error filled.
 */
static int drop_entries(design *design, char *error)
{
    double *sum = calloc((size_t)design->targets, sizeof *sum);
    if (!sum)
        return scene_fault(design->scene->limits.at, error, "%d outputs do not fit into memory",
                           design->targets);
    design_drop(design, sum);
    free(sum);
    return 0;
}

int design_control(design *design, const double *influence, char *error)
{
    const size_t amplifiers = (size_t)design->amplifiers, inputs = design->structure.input.count;
    pzs_problem *problem = &design->problem;
    if (!design->scene->target.given)
        return scene_fault(design->scene->limits.at, error,
                           design->measured.given
                               ? "no target: add `target: {value: ...}`, a formula of the "
                                 "coordinates, a list or a file with a number for each output"
                               : "no target: add `target: {u3: middle, at: nodes, value: ...}`");
    if (amplifiers == 0)
        return scene_fault(design->scene->limits.at, error, "no amplifiers: add `actuators`");
    if (!allocate_control(design))
        return scene_fault(design->scene->limits.at, error, "%d amplifiers do not fit into memory",
                           design->amplifiers);
    if (design->fixed_rows == design->targets)
        return scene_fault(design->scene->target.what.at, error,
                           "all %d target rows lie on constrained dof and "
                           "cannot move; choose other nodes or another direction",
                           design->targets);
    design_influence_free(design, influence, inputs, design->wanted, design->influence);
    for (size_t i = 0; i < (size_t)design->targets; i++) {
        design->wanted[i] = 0;
        for (size_t load = amplifiers; load < amplifiers + (size_t)design->loads; load++)
            design->wanted[i] += influence[i * inputs + load];
    }
    design_take_free(design, design->wanted);
    for (int i = 0; i < design->targets; i++)
        design->wanted[i] = design->target[i] - design->wanted[i];
    if (build_limits(design, error) < 0 || drop_entries(design, error) < 0)
        return -1;
    curves_fill(design);
    problem->regularisation = build_hessian(design);
    problem->format = PZS_TABLE_FORMAT;
    problem->scene = design->scene->hash;
    problem->inputs = (uint16_t)amplifiers;
    problem->outputs = (uint16_t)design->targets;
    problem->influence = design->influence;
    problem->hessian = design->hessian;
    problem->weight = design->weight;
    problem->lower = design->lower;
    problem->upper = design->upper;
    problem->step_limit = design->step_limit;
    problem->reference_voltage = design->reference_voltage;
    problem->dual_method = PZS_DUAL_METHOD(amplifiers);
    if (design_rows_build(design, error) < 0 || build_park(design, error) < 0)
        return -1;
    problem->crc = pzs_problem_crc(problem);
    return modal_gains_make(design, error);
}
