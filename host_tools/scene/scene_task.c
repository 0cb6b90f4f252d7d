/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Sections of a scene for the control task and the results: equilibrium, actuators, sensors,
 * limits, target and compare.
 */
#include "scene_file.h"
#include "scene_output.h"
#include "scene_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- equilibrium ---- */

static const range step_count = {1, 10000, 0, "must be from 1 to 10000"};
static const range extrapolated = {0, 1000, 0, "must be from 0 (plain Newton) to 1000"};
static const range ramp = {1, 20, 0, "must be from 1 to 20"};
static const range solve_count = {1, 1000000, 0, "must be from 1 to 1000000"};
static const range increment = {1e-12, 0.1, 0, "must lie between 1e-12 and 0.1"};

static const choice path_methods[] = {{"load_steps", 1}, {"arc_length", 0}, {NULL, 0}};

static const field equilibrium_fields[] = {
    {"load_steps", read_int, offsetof(scene_equilibrium, load_steps), &step_count, .of = OF_NUMBER,
     .help = "Number of load steps tried first; default 1."},
    {"tolerance", read_real, offsetof(scene_equilibrium, tolerance), &increment, .of = OF_NUMBER,
     .help = "Convergence tolerance: largest norm of the last increment relative to the "
             "displacement of the load step; default 1e-4."},
    {"extrapolated_iterations", read_int, offsetof(scene_equilibrium, extrapolated_iterations),
     &extrapolated, .of = OF_NUMBER,
     .help = "Number of iterations of a load step with extrapolated resultants before the true "
             "resultants are used; default 12; 0: plain Newton method."},
    {"ramp_solves", read_int, offsetof(scene_equilibrium, ramp_solves), &ramp, .of = OF_NUMBER,
     .help = "Number of linear solves over which the loads of a load step rise in equal parts; "
             "default: 1, and 8 where a load step would have to be shortened otherwise."},
    {"linear_solves", read_int, offsetof(scene_equilibrium, linear_solves), &solve_count,
     .of = OF_NUMBER, .help = "Largest number of linear solves; default 400."},
    {"path", read_either, offsetof(scene_equilibrium, path_in_steps), path_methods,
     .help = "How pzs solve --path follows the equilibria: arc_length (default, where it can), or "
             "load_steps: in equal parts of the loads, of prescribed displacements where supports "
             "have a value, 20 or load_steps where that is more."},
    {.key = NULL}};

const form equilibrium_form = {.type = FORM_MAP, .fields = equilibrium_fields};

int read_equilibrium(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    (void)rule;
    scene->equilibrium.at = node_at(reader, node);
    return read_map(reader, node, equilibrium_fields, &scene->equilibrium);
}

/* ---- actuators ---- */

static int read_patches_of(reader *reader, int node, void *to, const void *rule)
{
    const scene *scene = reader->s;
    (void)rule;
    return read_index(reader, node, scene->patches, scene->patch_grids, sizeof *scene->patches,
                      "there are no patches named '%s'; add them to patches", to);
}

/*
 * Return the name of the actuator or sensor that uses a given grid of patches as its electrodes, or
 * as its heaters (`is_heater`); NULL if there is none.
 */
static const char *driven_by(const scene_actuator *actuator, int actuators, int patches,
                             bool is_heater)
{
    int drive;
    for (; actuators > 0; actuators--, actuator++)
        for (drive = 0; drive < actuator->drives; drive++)
            if (actuator->drive[drive].patches == patches && actuator->is_temperature == is_heater)
                return actuator->name;
    return NULL;
}

/*
 * Check the patches of an actuator or sensor: their material must be piezoelectric, they may be
 * connected only once, and their grids must have equal sizes; the patches of a sensor also need a
 * permittivity. Returns 0, or -1 after writing an error message about the scene file.
 */
static int check_drive(reader *reader, int node, const scene_actuator *actuator, int drive,
                       int is_sensor)
{
    const scene *scene = reader->s;
    const scene_patches *patches = &scene->patches[actuator->drive[drive].patches],
                        *first = &scene->patches[actuator->drive[0].patches];
    const scene_material *material = &scene->material[scene->layer[patches->layer].material];
    const char *other = driven_by(scene->actuator, scene->actuators, actuator->drive[drive].patches,
                                  actuator->is_temperature);
    if (!other && !actuator->is_temperature)
        other = driven_by(scene->sensor, scene->sensors, actuator->drive[drive].patches, false);
    if (other)
        return tree_fault(reader->t, node,
                          "patches '%s' are driven by '%s' already; an electrode has one amplifier",
                          patches->name, other);
    if (is_sensor && !(material->permittivity > 0 && material->permittivity_across > 0))
        return tree_fault(reader->t, node,
                          "patches '%s' are of '%s', which has no permittivity; a sensor needs it",
                          patches->name, material->name);
    if (!actuator->is_temperature && !material->has_d && !material->has_e)
        return tree_fault(
            reader->t, node,
            "patches '%s' are of '%s', which has no piezoelectric constants; give it d31 or "
            "e31",
            patches->name, material->name);
    if (!actuator->is_temperature && scene->layer[patches->layer].bare != BARE_NONE)
        return tree_fault(reader->t, node,
                          "patches '%s' are electrodes on the layer '%s', which has a bare face; "
                          "remove 'bare' from the layer, or this drive",
                          patches->name, scene->layer[patches->layer].name);
    if (patches->grid[0] == first->grid[0] && patches->grid[1] == first->grid[1])
        return 0;
    return tree_fault(
        reader->t, node,
        "patches '%s' are %d x %d but '%s' %d x %d; grids tied to one actuator need the same "
        "shape",
        patches->name, patches->grid[0], patches->grid[1], first->name, first->grid[0],
        first->grid[1]);
}

static const field drive_fields[] = {
    {"patches", read_patches_of, offsetof(scene_drive, patches), .required = 1, .form = &name_form,
     .help = "Name of a grid of patches."},
    {"factor", read_real, offsetof(scene_drive, factor), .of = OF_NUMBER,
     .help = "Voltage of the patches over that of the amplifier or sensor; default 1."},
    {.key = NULL}};
static const form drive_form = {.type = FORM_MAP, .fields = drive_fields};
static const form drives_form = {.type = FORM_LIST, .item = &drive_form, .least = 1};

/*
 * Read the key `drives` of an actuator or a sensor, which lists the grids of patches with its
 * electrodes.
 *   rule in  NULL: actuator; any other pointer: sensor
 */
static int read_drives(reader *reader, int node, void *to, const void *rule)
{
    scene_actuator *actuator = to;
    int i, count;
    actuator->drive = new_items(reader, node, TREE_LIST, sizeof *actuator->drive, &count);
    if (!actuator->drive)
        return -1;
    if (count == 0)
        return tree_fault(reader->t, node,
                          "'drives' is empty; name the patches, as [{patches: up}]");
    for (i = reader->t->node[node].first; i; i = reader->t->node[i].next, actuator->drives++) {
        actuator->drive[actuator->drives].factor = 1;
        if (read_map(reader, i, drive_fields, &actuator->drive[actuator->drives]) != 0 ||
            check_drive(reader, i, actuator, actuator->drives, rule != NULL) != 0)
            return -1;
    }
    memcpy(actuator->grid, reader->s->patches[actuator->drive[0].patches].grid,
           sizeof actuator->grid);
    return 0;
}

static const form *const applied_forms[] = {&number_form, &list_form, &list_file_form, NULL};
static const form applied_form = {.type = FORM_ANY, .any = applied_forms};

/*
 * Read the voltage or temperature of an actuator in a solution without optimisation: one value for
 * all its amplifiers, or a list or file with one value for each.
 */
static int read_applied(reader *reader, int node, void *to, const void *rule)
{
    scene_actuator *actuator = to;
    const int amplifiers = actuator->grid[0] * actuator->grid[1];
    scene_numbers list;
    if (reader->t->node[node].kind == TREE_SCALAR)
        return read_real(reader, node, &actuator->applied, rule);
    if (scene_numbers_read(reader, node, &list) != 0)
        return -1;
    actuator->each = list.value;
    for (int k = 0; k < list.count; k++)
        if (fabs(list.value[k]) > fabs(actuator->applied))
            actuator->applied = list.value[k];
    if (list.count == amplifiers)
        return 0;
    return tree_fault(reader->t, node,
                      "%d values for %d amplifiers of '%s'; give one for each, theta2 fastest",
                      list.count, amplifiers, actuator->name);
}

static const choice temperatures[] = {{"uniform", 1}, {"patches", 1}, {NULL, 0}};

static const field actuator_fields[] = {
    {"name", read_name, offsetof(scene_actuator, name), .required = 1,
     .help = "Name; the amplifiers are name_1_1 ..., or name alone for a single patch."},
    {"temperature", read_either, offsetof(scene_actuator, is_temperature), temperatures,
     .help =
         "uniform: the input is the temperature of the whole shell instead of voltages; patches: "
         "each patch of the grids in 'drives' is a heater of the layer on which it lies."},
    {"drives", read_drives, .of = OF_NUMBER, .form = &drives_form,
     .help = "Grids of the same shape; patches at the same position share an amplifier."},
    {"stacks", read_stacks, .of = OF_NUMBER, .form = &stacks_form,
     .help = "Stacks or voice coils that push on points of the shell, one amplifier each."},
    {"applied", read_applied, .of = OF_ACTUATOR, .form = &applied_form,
     .help = "Voltage of each amplifier, or temperature, when the scene is solved: one for all, or "
             "a list or file with one for each amplifier; default 0."},
    {.key = NULL}};

static const form_case actuator_cases[] = {
    {"drives", "One amplifier for each patch of the grids, tied by factors."},
    {"temperature=uniform", "A temperature as an input."},
    {"temperature=patches drives", "One heater for each patch of the grids, tied by factors."},
    {"stacks", "Stacks or voice coils, one amplifier each."},
    {NULL, NULL}};
static const form actuator_form = {
    .type = FORM_MAP, .fields = actuator_fields, .cases = actuator_cases};
const form actuators_form = {.type = FORM_LIST, .item = &actuator_form};

/*
 * Check that an actuator has patches if it is a heater, and none if it stands for a uniform
 * temperature of the whole structure.
 */
static int check_temperature(reader *reader, int node, const scene_actuator *actuator)
{
    const int key = tree_find(reader->t, node, "temperature");
    const bool is_uniform = key && strcmp(node_text(reader, key), "uniform") == 0;
    if (!key || is_uniform == (actuator->drives == 0))
        return 0;
    if (is_uniform)
        return tree_fault(reader->t, key,
                          "a uniform temperature has no patches; write temperature: patches, or "
                          "remove 'drives'");
    return tree_fault(reader->t, key,
                      "'temperature: patches' needs the patches that are heated; add drives: "
                      "[{patches: name}]");
}

static int read_actuator(reader *reader, int node, void *item)
{
    scene_actuator *actuator = item;
    actuator->at = node_at(reader, node);
    actuator->grid[0] = actuator->grid[1] = 1;
    if (read_map(reader, node, actuator_fields, actuator) != 0)
        return -1;
    if (check_temperature(reader, node, actuator) != 0)
        return -1;
    if ((actuator->drives > 0 || actuator->is_temperature) + (actuator->stacks != NULL) != 1)
        return tree_fault(reader->t, node,
                          "actuator '%s' needs one of drives: [{patches: ...}], stacks: {at: ...} "
                          "and temperature: uniform or patches",
                          actuator->name);
    actuator->first = reader->s->amplifiers;
    reader->s->amplifiers += actuator->grid[0] * actuator->grid[1];
    return 0;
}

int read_actuators(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    int count;
    (void)rule;
    scene->actuator = new_items(reader, node, TREE_LIST, sizeof *scene->actuator, &count);
    return read_items(reader, node, scene->actuator, sizeof *scene->actuator, read_actuator,
                      &scene->actuators);
}

/* ---- sensors ---- */

static const choice circuits[] = {{"open", 1}, {"short", 0}, {NULL, 0}};

/*
 * Table of the keys of a sensor. The key `drives` (patches whose electrodes the sensor reads) is
 * read by the same function as that of an actuator. This function recognises a sensor by the member
 * `rule` of the row, which is not NULL; any pointer would do, here it is `circuits`.
 */
static const field sensor_fields[] = {
    {"name", read_name, offsetof(scene_actuator, name), .required = 1,
     .help = "Name; the electrodes are name_1_1 ..., or name alone for a single patch."},
    {"circuit", read_either, offsetof(scene_actuator, open), circuits,
     .help = "open: no charge flows (default); short: no voltage."},
    {"drives", read_drives, 0, circuits, 1, .of = OF_NUMBER, .form = &drives_form,
     .help = "Grids of the same shape; patches at the same position share an electrode."},
    {.key = NULL}};

static const form sensor_form = {.type = FORM_MAP, .fields = sensor_fields};
const form sensors_form = {.type = FORM_LIST, .item = &sensor_form};

static int read_sensor(reader *reader, int node, void *item)
{
    scene_actuator *actuator = item;
    actuator->at = node_at(reader, node);
    actuator->open = true;
    if (read_map(reader, node, sensor_fields, actuator) != 0)
        return -1;
    actuator->first = reader->s->electrodes;
    reader->s->electrodes += actuator->grid[0] * actuator->grid[1];
    return 0;
}

int read_sensors(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    int count;
    (void)rule;
    scene->sensor = new_items(reader, node, TREE_LIST, sizeof *scene->sensor, &count);
    return read_items(reader, node, scene->sensor, sizeof *scene->sensor, read_sensor,
                      &scene->sensors);
}

/* ---- limits ---- */

static int read_voltage(reader *reader, int node, void *to, const void *rule)
{
    double *pair = to;
    if (read_pair(reader, node, pair, rule) != 0)
        return -1;
    if (pair[0] > pair[1])
        return tree_fault(reader->t, node,
                          "voltage from %g to %g is empty; write [lowest, highest]", pair[0],
                          pair[1]);
    return 0;
}

static const field relative_fields[] = {
    {"relative", read_real, 0, &not_negative, 1, .of = OF_NUMBER,
     .help = "Weight relative to the mean diagonal entry of the Hessian, tr(B'WB)/n."},
    {.key = NULL}};
static const form relative_form = {.type = FORM_MAP, .fields = relative_fields};
static const form *const regularisation_forms[] = {&not_negative_form, &relative_form, NULL};
static const form regularisation_form = {.type = FORM_ANY, .any = regularisation_forms};

static int read_regularisation(reader *reader, int node, void *to, const void *rule)
{
    scene_limits *limits = to;
    (void)rule;
    limits->regularisation_is_relative = reader->t->node[node].kind == TREE_MAP;
    if (limits->regularisation_is_relative)
        return read_map(reader, node, relative_fields, &limits->regularisation);
    return read_real(reader, node, &limits->regularisation, &not_negative);
}

static int read_amplifier(reader *reader, int node, void *to, const void *rule)
{
    scene_limit *limit = to;
    char name[SCENE_LABEL];
    if (reader->t->node[node].kind != TREE_SCALAR)
        return read_name(reader, node, name, rule);
    if (scene_find_amplifier(reader->s, node_text(reader, node), &limit->first, &limit->count))
        return 0;
    const scene_influence *influence = &reader->s->influence;
    limit->tied = scene_find_tied(influence, node_text(reader, node));
    limit->is_tied = limit->tied >= 0;
    if (!limit->is_tied)
        return refuse_amplifier(reader, node_at(reader, node), node_text(reader, node));
    limit->first = influence->amplifier_of[limit->tied];
    limit->count = 1;
    return 0;
}

/*
 * Smallest permitted value of a step limit (V), which is the largest change of a voltage in one
 * tick. A smaller step limit is a typing error: the change would vanish in rounding when it is
 * added to a voltage.
 */
static const double smallest_step_limit = 1e-60;

/*
 * Read the largest rate of a voltage (V/s) and store it as a step limit (V a tick) in the number
 * `to`; the scene must give the tick rate.
 */
static int read_rate_limit(reader *reader, int node, void *to, const void *rule)
{
    double *step_limit = to;
    double rate_limit = 0;
    if (read_real(reader, node, &rate_limit, rule) != 0)
        return -1;
    if (tree_find(reader->t, reader->t->node[node].parent, "step_limit"))
        return tree_fault_at(reader->t, reader->t->node[node].key_at,
                             "'rate_limit' and 'step_limit' are both given; keep one");
    if (reader->s->control.rate == 0)
        return tree_fault(
            reader->t, node,
            "'rate_limit: %.60s' is per second, but the scene has no tick rate; add "
            "control: {rate: ...} in ticks a second, or give step_limit in volts a tick",
            node_text(reader, node));
    *step_limit = rate_limit / reader->s->control.rate;
    if (*step_limit >= smallest_step_limit)
        return 0;
    return tree_fault(reader->t, node,
                      "'rate_limit: %.60s' over the tick rate is below %g volts a tick; raise it",
                      node_text(reader, node), smallest_step_limit);
}

static const range some = {0, HUGE_VAL, 1, "must be above 0; leave it out for none"};
static const form some_form = {.type = FORM_NUMBER, .range = &some};

typedef struct each_text {
    scene_limit limit;
    double voltage[2], hold, step_limit;
} each_text;

static const form voltage_range_form = {
    .type = FORM_LIST, .item = &number_form, .least = 2, .most = 2};

static const field each_fields[] = {
    {"actuator", read_amplifier, offsetof(each_text, limit), .required = 1, .form = &label_form,
     .help = "Name of an amplifier, such as v_1_2, of an actuator for all its amplifiers, or of an "
             "actuator that is tied to others (influence.tied)."},
    {"voltage", read_voltage, offsetof(each_text, voltage), .of = OF_LIMIT,
     .form = &voltage_range_form, .help = "Voltage limits [lowest, highest]."},
    {"hold", read_real, offsetof(each_text, hold), .of = OF_LIMIT,
     .help = "Voltage at which the amplifier is held, such as 0 for a dead one."},
    {"step_limit", read_real, offsetof(each_text, step_limit), &some, .of = OF_LIMIT,
     .help = "Largest change of this voltage in one tick; the narrowest applies; not with "
             "rate_limit."},
    {"rate_limit", read_rate_limit, offsetof(each_text, step_limit), &some, .of = OF_VOLTAGE_RATE,
     .form = &some_form,
     .help = "Largest rate of this voltage; needs control: {rate: ...}; the narrowest applies."},
    {.key = NULL}};

static const form_case each_cases[] = {{"actuator voltage ?step_limit", NULL},
                                       {"actuator voltage rate_limit", NULL},
                                       {"actuator hold", NULL},
                                       {"actuator step_limit|rate_limit", NULL},
                                       {NULL, NULL}};
static const form each_item_form = {.type = FORM_MAP, .fields = each_fields, .cases = each_cases};
static const form each_form = {.type = FORM_LIST, .item = &each_item_form};

/*
 * Check the keys of an item of the list `each` in the scene file, which limits the voltages of some
 * amplifiers. Refused are an item without any limit, one with both a voltage range and a fixed
 * voltage, and one with both a fixed voltage and a limit of the voltage's change.
 */
static int check_each_keys(reader *reader, int node)
{
    const bool has_voltage = tree_find(reader->t, node, "voltage"),
               is_held = tree_find(reader->t, node, "hold"),
               has_step = tree_find(reader->t, node, "step_limit") ||
                          tree_find(reader->t, node, "rate_limit");
    if ((has_voltage && is_held) || (!has_voltage && !is_held && !has_step))
        return tree_fault(reader->t, node,
                          "an item of 'each' needs either voltage: [lowest, highest] or hold: "
                          "value; or only a step_limit or rate_limit");
    if (is_held && has_step)
        return tree_fault(reader->t, node,
                          "'hold' keeps the voltage where it is; leave step_limit and rate_limit "
                          "out");
    return 0;
}

static int read_each_item(reader *reader, int node, void *item)
{
    scene_limit *limit = item;
    each_text text;
    memset(&text, 0, sizeof text);
    text.step_limit = HUGE_VAL;
    if (read_map(reader, node, each_fields, &text) != 0 || check_each_keys(reader, node) != 0)
        return -1;
    const bool is_range = tree_find(reader->t, node, "voltage");
    *limit = text.limit;
    limit->at = node_at(reader, node);
    limit->has_voltage = is_range || tree_find(reader->t, node, "hold");
    limit->lower = is_range ? text.voltage[0] : text.hold;
    limit->upper = is_range ? text.voltage[1] : text.hold;
    limit->step_limit = text.step_limit;
    return 0;
}

static int read_each(reader *reader, int node, void *to, const void *rule)
{
    scene_limits *limits = to;
    (void)rule;
    limits->each = new_items(reader, node, TREE_LIST, sizeof *limits->each, &limits->each_count);
    return read_items(reader, node, limits->each, sizeof *limits->each, read_each_item, NULL);
}

static const field limits_fields[] = {
    {"voltage", read_voltage, offsetof(scene_limits, lower), .of = OF_VOLTAGE,
     .form = &voltage_range_form,
     .help =
         "Voltage limits [lowest, highest] of all amplifiers; pzs shape --limit replaces them."},
    {"step_limit", read_real, offsetof(scene_limits, step_limit), &some, .of = OF_VOLTAGE,
     .help = "Largest change of a voltage in one tick; not with rate_limit."},
    {"rate_limit", read_rate_limit, offsetof(scene_limits, step_limit), &some,
     .of = OF_VOLTAGE_RATE, .form = &some_form,
     .help = "Largest rate of a voltage; needs control: {rate: ...}; not with step_limit."},
    {"regularisation", read_regularisation, .of = OF_REGULARISATION, .form = &regularisation_form,
     .help = "Weight of the squared voltages in the optimum: absolute, or {relative: ...}."},
    {"each", read_each, .of = OF_LIMIT, .form = &each_form,
     .help = "Limits of individual amplifiers: voltage in place of the common one (pzs shape "
             "--limit narrows it and does not move a held voltage), step_limit or rate_limit where "
             "it is narrower; of several items for one amplifier the narrowest apply."},
    {"difference", read_difference, .of = OF_LIMIT, .form = &difference_form,
     .help = "Largest difference of the voltages of neighbours."},
    {"sum", read_sum, .of = OF_LIMIT, .form = &sum_form,
     .help = "Limits of the sum of several voltages."},
    {"absolute_sum", read_absolute_sum, .of = OF_LIMIT, .form = &absolute_sum_form,
     .help = "Largest weighted sum of the absolute values of voltages, or a list of such limits: "
             "what a common supply gives."},
    {.key = NULL}};

static const form_case limits_cases[] = {{"?step_limit", NULL}, {"rate_limit", NULL}, {NULL, NULL}};
const form limits_form = {.type = FORM_MAP, .fields = limits_fields, .cases = limits_cases};

int read_limits(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    (void)rule;
    scene->limits.at = node_at(reader, node);
    return read_map(reader, node, limits_fields, &scene->limits);
}

/* ---- target, compare ---- */

static const field mode_fields[] = {
    {"name", read_name, offsetof(scene_mode, name), .required = 1,
     .help = "Name of the shape in the results."},
    {"value", read_row_function, offsetof(scene_mode, value), .required = 1, .of = OF_LENGTH,
     .form = &row_function_form,
     .help = "Wanted displacement, such as 1e-6*zernike(4, theta1/0.03, theta2)."},
    {.key = NULL}};
static const form mode_form = {.type = FORM_MAP, .fields = mode_fields};
static const form modes_form = {.type = FORM_LIST, .item = &mode_form};

static int read_mode(reader *reader, int node, void *item)
{
    scene_mode *mode = item;
    mode->at = node_at(reader, node);
    return read_map(reader, node, mode_fields, mode);
}

static int read_modes(reader *reader, int node, void *to, const void *rule)
{
    scene_target *target = &reader->s->target;
    (void)to;
    (void)rule;
    target->mode = new_items(reader, node, TREE_LIST, sizeof *target->mode, &target->modes);
    return read_items(reader, node, target->mode, sizeof *target->mode, read_mode, NULL);
}

int read_shape_function(reader *reader, int node, void *item)
{
    scene_mode *to = item;
    static const char *const word[3][2] = {{"piston", "1"}, {"tip", "x"}, {"tilt", "y"}};
    const char *why;
    int i, column;
    to->at = node_at(reader, node);
    if (reader->t->node[node].kind == TREE_SCALAR)
        snprintf(to->name, sizeof to->name, "%.60s", node_text(reader, node));
    for (i = 0; i < 3; i++)
        if (strcmp(to->name, word[i][0]) == 0) {
            to->value = expr_compile(word[i][1], &column, &why);
            return to->value ? 0 : tree_fault(reader->t, node, "out of memory");
        }
    if (read_row_function(reader, node, &to->value, NULL) != 0)
        return -1;
    if (reader->t->node[node].kind != TREE_SCALAR)
        snprintf(to->name, sizeof to->name, "%.60s", expr_text(to->value));
    return 0;
}

static int read_free(reader *reader, int node, void *to, const void *rule)
{
    scene_target *target = &reader->s->target;
    int count;
    (void)to;
    (void)rule;
    target->free = new_items(reader, node, TREE_LIST, sizeof *target->free, &count);
    if (!target->free)
        return -1;
    if (count > SCENE_FREE)
        return tree_fault(reader->t, node, "%d free functions; at most %d are read", count,
                          SCENE_FREE);
    return read_items(reader, node, target->free, sizeof *target->free, read_shape_function,
                      &target->frees);
}

static const choice target_weights[] = {{"equal", 0}, {"area", 1}, {NULL, 0}};
static const form free_form = {.type = FORM_LIST, .item = &row_function_form, .most = SCENE_FREE};

/*
 * Macro that expands to those rows of a table of scene keys which all types of targets share:
 * values, weights, a list of shapes for which the voltages are optimised one by one, and functions,
 * such as rigid motions, that are removed from the misfit.
 */
#define TARGET_VALUES                                                                              \
    {"value",                                                                                      \
     read_row_function,                                                                            \
     offsetof(output_text, value),                                                                 \
     NULL,                                                                                         \
     1,                                                                                            \
     OF_LENGTH,                                                                                    \
     &row_function_form,                                                                           \
     "Wanted displacement: a formula of x, y, z, theta1, theta2, a list of values in the order "   \
     "of the rows, or {file: ...}."},                                                              \
        {"weight",                                                                                 \
         read_either,                                                                              \
         offsetof(output_text, weight_area),                                                       \
         target_weights,                                                                           \
         0,                                                                                        \
         OF_NOTHING,                                                                               \
         NULL,                                                                                     \
         "Weight of the nodes in the error: equal (default), or by area."},                        \
        {"modes",                                                                                  \
         read_modes,                                                                               \
         0,                                                                                        \
         NULL,                                                                                     \
         0,                                                                                        \
         OF_LENGTH,                                                                                \
         &modes_form,                                                                              \
         "Shapes to try one by one, in the direction and at the place of the target; pzs shape "   \
         "prints what is left of each."},                                                          \
    {                                                                                              \
        "free", read_free, 0, NULL, 0, OF_NUMBER, &free_form,                                      \
            "Functions that are taken out of target and error by weighted projection: piston "     \
            "(1), tip (x), tilt (y), or functions; control image only."                            \
    }

static void keep_target(scene *scene, const output_text *text)
{
    scene->target.given = true;
    scene->target.what = text->output;
    scene->target.what.reference = (double)NAN;
    strcpy(scene->target.what.name, "target");
    scene->target.weight_area = text->weight_area;
}

static const field target_fields[] = {
    DIRECTIONS(read_displacement, OF_NOTHING, &face_form, "Displacement of a face"),
    PLACE(offsetof(output_text, output.where)),
    TARGET_VALUES,
    {.key = NULL}};

static const form_case target_cases[] = {{"u1|u2|u3|x|y|z edge|at|set value", NULL}, {NULL, NULL}};
const form target_form = {.type = FORM_MAP, .fields = target_fields, .cases = target_cases};

int read_target(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    output_text text;
    int status;
    (void)rule;
    memset(&text, 0, sizeof text);
    status = read_map(reader, node, target_fields, &text);
    scene->target.value = text.value;
    if (status != 0 || finish_output(reader, node, &text) != 0)
        return -1;
    keep_target(scene, &text);
    if (scene->amplifiers == 0)
        return tree_fault(reader->t, node, "a target needs actuators to reach it; add actuators");
    return 0;
}

static const field measured_target_fields[] = {TARGET_VALUES, {.key = NULL}};
const form measured_target_form = {.type = FORM_MAP, .fields = measured_target_fields};

int read_measured_target(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    output_text text;
    int status;
    (void)rule;
    memset(&text, 0, sizeof text);
    status = read_map(reader, node, measured_target_fields, &text);
    scene->target.value = text.value;
    text.output.at = node_at(reader, node);
    text.output.component = COMPONENT_Z;
    keep_target(scene, &text);
    return status;
}

static int read_values(reader *reader, int node, void *to, const void *rule)
{
    scene_compare *compare = to;
    scene_numbers list;
    (void)rule;
    if (scene_numbers_read(reader, node, &list) != 0)
        return -1;
    compare->count = list.count;
    compare->value = list.value;
    if (compare->count == reader->s->amplifiers)
        return 0;
    return tree_fault(reader->t, node,
                      "%d values for %d amplifiers; give one for each, in the order of actuators, "
                      "theta2 fastest",
                      compare->count, reader->s->amplifiers);
}

static const field compare_fields[] = {
    {"name", read_name, offsetof(scene_compare, name), .required = 1, .help = "Name of the set."},
    {"values", read_values, .required = 1, .of = OF_COMPARE, .form = &numbers_form,
     .help = "Voltages of all amplifiers, in the order of the actuators, theta2 fastest."},
    {.key = NULL}};
static const form compare_item_form = {.type = FORM_MAP, .fields = compare_fields};
const form compare_form = {.type = FORM_LIST, .item = &compare_item_form};

static int read_comparison(reader *reader, int node, void *item)
{
    scene_compare *compare = item;
    compare->at = node_at(reader, node);
    return read_map(reader, node, compare_fields, compare);
}

int read_compare(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    (void)rule;
    scene->compare = new_items(reader, node, TREE_LIST, sizeof *scene->compare, &scene->compares);
    return read_items(reader, node, scene->compare, sizeof *scene->compare, read_comparison, NULL);
}
