/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Sections of a scene on control and results: equilibrium, actuators, sensors, limits, outputs,
 * target, compare.
 */
#include "scene_file.h"
#include "scene_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- equilibrium ---- */

int read_equilibrium(reader *reader, int node, void *to, const void *rule)
{
    static const range stepped = {1, 10000, 0, "must be from 1 to 10000"};
    static const range extrapolated = {0, 1000, 0, "must be from 0 (plain Newton) to 1000"};
    static const range allowed = {1, 1000000, 0, "must be from 1 to 1000000"};
    static const range small = {1e-12, 0.1, 0, "must lie between 1e-12 and 0.1"};
    static const field fields[] = {
        {"load_steps", read_int, offsetof(scene_equilibrium, load_steps), &stepped, 0},
        {"tolerance", read_real, offsetof(scene_equilibrium, tolerance), &small, 0},
        {"extrapolated_iterations", read_int, offsetof(scene_equilibrium, extrapolated_iterations),
         &extrapolated, 0},
        {"linear_solves", read_int, offsetof(scene_equilibrium, linear_solves), &allowed, 0},
        {NULL, NULL, 0, NULL, 0}};
    scene *scene = to;
    (void)rule;
    scene->equilibrium.at = node_at(reader, node);
    return read_map(reader, node, fields, &scene->equilibrium);
}

/* ---- actuators ---- */

static int read_patches_of(reader *reader, int node, void *to, const void *rule)
{
    const scene *scene = reader->s;
    char name[SCENE_NAME];
    int i;
    if (read_name(reader, node, name, rule) != 0)
        return -1;
    i = find_named(scene->patches, scene->patch_grids, sizeof *scene->patches, name);
    if (i < 0)
        return tree_fault(reader->t, node, "there are no patches named '%s'; add them to patches",
                          name);
    *(int *)to = i;
    return 0;
}

static const char *driven_by(const scene_actuator *actuator, int actuators, int patches)
{
    int d;
    for (; actuators > 0; actuators--, actuator++)
        for (d = 0; d < actuator->drives; d++)
            if (actuator->drive[d].patches == patches)
                return actuator->name;
    return NULL;
}

/*
 * Check the patches of an actuator or sensor: they must be piezoelectric, be connected only once,
 * and have grids of the same size; the patches of a sensor need a permittivity.
 */
static int check_drive(reader *reader, int node, const scene_actuator *actuator, int drive,
                       int is_sensor)
{
    const scene *scene = reader->s;
    const scene_patches *patches = &scene->patches[actuator->drive[drive].patches],
                        *first = &scene->patches[actuator->drive[0].patches];
    const scene_material *material = &scene->material[scene->layer[patches->layer].material];
    const char *other =
        driven_by(scene->actuator, scene->actuators, actuator->drive[drive].patches);
    if (!other)
        other = driven_by(scene->sensor, scene->sensors, actuator->drive[drive].patches);
    if (other)
        return tree_fault(reader->t, node,
                          "patches '%s' are driven by '%s' already; an electrode has one amplifier",
                          patches->name, other);
    if (is_sensor && !(material->permittivity > 0))
        return tree_fault(reader->t, node,
                          "patches '%s' are of '%s', which has no permittivity; a sensor needs it",
                          patches->name, material->name);
    if (!material->has_d && !material->has_e)
        return tree_fault(
            reader->t, node,
            "patches '%s' are of '%s', which has no piezoelectric constants; give it d31 or "
            "e31",
            patches->name, material->name);
    if (patches->grid[0] == first->grid[0] && patches->grid[1] == first->grid[1])
        return 0;
    return tree_fault(
        reader->t, node,
        "patches '%s' are %d x %d but '%s' %d x %d; grids tied to one actuator need the same "
        "shape",
        patches->name, patches->grid[0], patches->grid[1], first->name, first->grid[0],
        first->grid[1]);
}

/* Read the patch grids of an actuator, or of a sensor if rule is not NULL. */
static int read_drives(reader *reader, int node, void *to, const void *rule)
{
    static const field fields[] = {
        {"patches", read_patches_of, offsetof(scene_drive, patches), NULL, 1},
        {"factor", read_real, offsetof(scene_drive, factor), NULL, 0},
        {NULL, NULL, 0, NULL, 0}};
    scene_actuator *actuator = to;
    int i, n;
    actuator->drive = new_items(reader, node, TREE_LIST, sizeof *actuator->drive, &n);
    if (!actuator->drive)
        return -1;
    if (n == 0)
        return tree_fault(reader->t, node,
                          "'drives' is empty; name the patches, as [{patches: up}]");
    for (i = reader->t->node[node].first; i; i = reader->t->node[i].next, actuator->drives++) {
        actuator->drive[actuator->drives].factor = 1;
        if (read_map(reader, i, fields, &actuator->drive[actuator->drives]) != 0 ||
            check_drive(reader, i, actuator, actuator->drives, rule != NULL) != 0)
            return -1;
    }
    memcpy(actuator->grid, reader->s->patches[actuator->drive[0].patches].grid,
           sizeof actuator->grid);
    return 0;
}

static int read_uniform(reader *reader, int node, void *to, const void *rule)
{
    static const choice only[] = {{"uniform", 1}, {NULL, 0}};
    (void)rule;
    return read_choice(reader, node, to, only);
}

static int read_actuator(reader *reader, int node, scene_actuator *actuator)
{
    static const field fields[] = {
        {"name", read_name, offsetof(scene_actuator, name), NULL, 1},
        {"drives", read_drives, 0, NULL, 0},
        {"temperature", read_uniform, offsetof(scene_actuator, is_temperature), NULL, 0},
        {"applied", read_real, offsetof(scene_actuator, applied), NULL, 0},
        {NULL, NULL, 0, NULL, 0}};
    actuator->at = node_at(reader, node);
    actuator->grid[0] = actuator->grid[1] = 1;
    if (read_map(reader, node, fields, actuator) != 0)
        return -1;
    if ((actuator->drives > 0) == actuator->is_temperature)
        return tree_fault(
            reader->t, node,
            "actuator '%s' needs either drives: [{patches: ...}] or temperature: uniform",
            actuator->name);
    actuator->first = reader->s->amplifiers;
    reader->s->amplifiers += actuator->grid[0] * actuator->grid[1];
    return 0;
}

int read_actuators(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    int i, n;
    (void)rule;
    scene->actuator = new_items(reader, node, TREE_LIST, sizeof *scene->actuator, &n);
    if (!scene->actuator)
        return -1;
    for (i = reader->t->node[node].first; i; i = reader->t->node[i].next) {
        scene->actuators++;
        if (read_actuator(reader, i, &scene->actuator[scene->actuators - 1]) != 0)
            return -1;
    }
    return 0;
}

/* ---- sensors ---- */

static int read_sensor(reader *reader, int node, scene_actuator *actuator)
{
    static const choice circuits[] = {{"open", 1}, {"short", 0}, {NULL, 0}};
    static const field fields[] = {
        {"name", read_name, offsetof(scene_actuator, name), NULL, 1},
        {"circuit", read_choice, offsetof(scene_actuator, open), circuits, 0},
        {"drives", read_drives, 0, circuits, 1},
        {NULL, NULL, 0, NULL, 0}};
    actuator->at = node_at(reader, node);
    actuator->open = 1;
    if (read_map(reader, node, fields, actuator) != 0)
        return -1;
    actuator->first = reader->s->electrodes;
    reader->s->electrodes += actuator->grid[0] * actuator->grid[1];
    return 0;
}

int read_sensors(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    int i, n;
    (void)rule;
    scene->sensor = new_items(reader, node, TREE_LIST, sizeof *scene->sensor, &n);
    if (!scene->sensor)
        return -1;
    for (i = reader->t->node[node].first; i; i = reader->t->node[i].next) {
        scene->sensors++;
        if (read_sensor(reader, i, &scene->sensor[scene->sensors - 1]) != 0)
            return -1;
    }
    return 0;
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

static int read_regularisation(reader *reader, int node, void *to, const void *rule)
{
    static const field fields[] = {{"relative", read_real, 0, &not_negative, 1},
                                   {NULL, NULL, 0, NULL, 0}};
    scene_limits *limits = to;
    (void)rule;
    limits->regularisation_is_relative = reader->t->node[node].kind == TREE_MAP;
    if (limits->regularisation_is_relative)
        return read_map(reader, node, fields, &limits->regularisation);
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
    if (reader->s->amplifiers == 0)
        return tree_fault(reader->t, node, "there is no actuator '%.60s'; add actuators first",
                          node_text(reader, node));
    scene_amplifier_name(reader->s, 0, name);
    return tree_fault(reader->t, node, "there is no actuator '%.60s'; the first one is '%s'",
                      node_text(reader, node), name);
}

static int read_each_item(reader *reader, int node, scene_limit *limit)
{
    typedef struct each_text {
        scene_limit limit;
        double voltage[2], hold;
    } each_text;
    static const field fields[] = {
        {"actuator", read_amplifier, offsetof(each_text, limit), NULL, 1},
        {"voltage", read_voltage, offsetof(each_text, voltage), NULL, 0},
        {"hold", read_real, offsetof(each_text, hold), NULL, 0},
        {NULL, NULL, 0, NULL, 0}};
    each_text text;
    memset(&text, 0, sizeof text);
    if (read_map(reader, node, fields, &text) != 0)
        return -1;
    if (!tree_find(reader->t, node, "voltage") == !tree_find(reader->t, node, "hold"))
        return tree_fault(
            reader->t, node,
            "an item of 'each' needs either voltage: [lowest, highest] or hold: value");
    *limit = text.limit;
    limit->at = node_at(reader, node);
    limit->lower = limit->upper = text.hold;
    if (!tree_find(reader->t, node, "voltage"))
        return 0;
    limit->lower = text.voltage[0];
    limit->upper = text.voltage[1];
    return 0;
}

static int read_each(reader *reader, int node, void *to, const void *rule)
{
    scene_limits *limits = to;
    int i, k = 0;
    (void)rule;
    limits->each = new_items(reader, node, TREE_LIST, sizeof *limits->each, &limits->each_count);
    if (!limits->each)
        return -1;
    for (i = reader->t->node[node].first; i; i = reader->t->node[i].next)
        if (read_each_item(reader, i, &limits->each[k++]) != 0)
            return -1;
    return 0;
}

/* A step limit below this one is a typing error, and vanishes when it is added to a voltage. */
static const double smallest_step_limit = 1e-60;

/* Read the largest rate of a voltage (V/s) as a step limit (V a tick), which needs the tick rate.
 */
static int read_rate_limit(reader *reader, int node, void *to, const void *rule)
{
    scene_limits *limits = to;
    double rate_limit = 0;
    if (read_real(reader, node, &rate_limit, rule) != 0)
        return -1;
    if (tree_find(reader->t, reader->t->node[node].parent, "step_limit"))
        return tree_fault_at(reader->t, reader->t->node[node].key_at,
                             "'rate_limit' and 'step_limit' are both given; keep one");
    if (reader->s->control.rate == 0)
        return tree_fault(reader->t, node,
                          "'rate_limit: %.60s' is per second, but the scene has no tick rate; add "
                          "control: {rate: 1000}, or give step_limit in volts a tick",
                          node_text(reader, node));
    limits->step_limit = rate_limit / reader->s->control.rate;
    if (limits->step_limit >= smallest_step_limit)
        return 0;
    return tree_fault(reader->t, node,
                      "'rate_limit: %.60s' over the tick rate is below %g volts a tick; raise it",
                      node_text(reader, node), smallest_step_limit);
}

int read_limits(reader *reader, int node, void *to, const void *rule)
{
    static const range some = {0, HUGE_VAL, 1, "must be above 0; leave it out for none"};
    static const field fields[] = {
        {"voltage", read_voltage, offsetof(scene_limits, lower), NULL, 0},
        {"step_limit", read_real, offsetof(scene_limits, step_limit), &some, 0},
        {"rate_limit", read_rate_limit, 0, &some, 0},
        {"regularisation", read_regularisation, 0, NULL, 0},
        {"each", read_each, 0, NULL, 0},
        {NULL, NULL, 0, NULL, 0}};
    scene *scene = to;
    (void)rule;
    scene->limits.at = node_at(reader, node);
    return read_map(reader, node, fields, &scene->limits);
}

/* ---- outputs, target, compare ---- */

typedef struct output_text {
    scene_output output;
    expr *value;
    int weight_area, directions;
} output_text;

static int read_component(reader *reader, int node, void *to, const void *rule)
{
    output_text *text = to;
    int face = 0;
    if (text->directions++)
        return tree_fault_at(reader->t, reader->t->node[node].key_at,
                             "an output has one direction; write a second item for '%s'",
                             reader->t->node[node].key);
    if (read_choice(reader, node, &face, place_faces) != 0)
        return -1;
    text->output.component = (scene_component) * (const int *)rule;
    text->output.face = (scene_face)face;
    return 0;
}

#define PLACE(member)                                                                              \
    {"edge", read_edge, offsetof(output_text, member), NULL, 0},                                   \
    {                                                                                              \
        "at", read_at, offsetof(output_text, member), NULL, 0                                      \
    }

static int read_contact_output(reader *reader, int node, void *to, const void *rule)
{
    static const choice results[] = {{"x", CONTACT_X},
                                     {"y", CONTACT_Y},
                                     {"z", CONTACT_Z},
                                     {"nodes", CONTACT_NODES},
                                     {"pressure", CONTACT_PRESSURE},
                                     {NULL, 0}};
    output_text *text = to;
    int result = 0;
    (void)rule;
    if (!reader->s->contact.given)
        return tree_fault_at(reader->t, reader->t->node[node].key_at,
                             "no contact in this scene; add contact: {face: outer, "
                             "body: ...}");
    if (text->directions++)
        return tree_fault_at(reader->t, reader->t->node[node].key_at,
                             "an output is a displacement or of contact; write a second "
                             "item");
    if (read_choice(reader, node, &result, results) != 0)
        return -1;
    text->output.contact = (scene_contact_output)result;
    return 0;
}

/* Read an output that is the voltages or charges of the electrodes of a sensor or an actuator. */
static int read_electric_output(reader *reader, int node, void *to, const void *rule)
{
    output_text *text = to;
    scene_output *output = &text->output;
    char name[SCENE_NAME];
    int i;
    if (text->directions++)
        return tree_fault_at(reader->t, reader->t->node[node].key_at,
                             "an output is one of displacement, contact, voltage and "
                             "charge; write a second item for '%s'",
                             reader->t->node[node].key);
    if (read_name(reader, node, name, NULL) != 0)
        return -1;
    output->electric = (scene_electric_output) * (const int *)rule;
    output->of_sensor = scene_find_sensor(reader->s, name, &output->first, &output->count);
    if (output->of_sensor)
        return 0;
    if (scene_find_amplifier(reader->s, name, &output->first, &output->count)) {
        for (i = 0; i < reader->s->actuators; i++)
            if (reader->s->actuator[i].is_temperature &&
                reader->s->actuator[i].first == output->first)
                return tree_fault(reader->t, node,
                                  "'%s' is a temperature; it has neither voltage nor charge", name);
        return 0;
    }
    return tree_fault(reader->t, node, "there is no sensor or actuator '%s'; add it to sensors",
                      name);
}

static int finish_output(reader *reader, int node, output_text *text)
{
    const scene_contact_output contact = text->output.contact;
    text->output.at = node_at(reader, node);
    if (text->output.electric != ELECTRIC_NONE) {
        if (text->output.where.at.column == 0)
            return 0;
        return tree_fault_at(reader->t, text->output.where.at,
                             "an electrode has one voltage and one charge; remove the place");
    }
    if (contact != CONTACT_NONE && contact != CONTACT_PRESSURE) {
        if (text->output.where.at.column == 0)
            return 0;
        return tree_fault_at(reader->t, text->output.where.at,
                             "the whole contact has one force and one number of nodes; remove "
                             "the place");
    }
    if (text->directions == 0)
        return tree_fault(reader->t, node,
                          "no direction in this item of %.60s; add one, as u3: middle or z: outer",
                          tree_name(reader->t, node));
    return require_place(reader, node, &text->output.where);
}

static int read_output(reader *reader, int node, scene_output *to)
{
    static const int electric[] = {ELECTRIC_VOLTAGE, ELECTRIC_CHARGE};
    static const field fields[] = {
        {"name", read_name, offsetof(output_text, output.name), NULL, 1},
        DIRECTIONS(read_component),
        {"contact", read_contact_output, 0, NULL, 0},
        {"voltage", read_electric_output, 0, &electric[0], 0},
        {"charge", read_electric_output, 0, &electric[1], 0},
        PLACE(output.where),
        {"reference", read_real, offsetof(output_text, output.reference), NULL, 0},
        {NULL, NULL, 0, NULL, 0}};
    output_text text;
    memset(&text, 0, sizeof text);
    text.output.reference = (double)NAN;
    if (read_map(reader, node, fields, &text) != 0 || finish_output(reader, node, &text) != 0)
        return -1;
    *to = text.output;
    return 0;
}

int read_outputs(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    int i, k = 0;
    (void)rule;
    scene->output = new_items(reader, node, TREE_LIST, sizeof *scene->output, &scene->outputs);
    if (!scene->output)
        return -1;
    for (i = reader->t->node[node].first; i; i = reader->t->node[i].next)
        if (read_output(reader, i, &scene->output[k++]) != 0)
            return -1;
    return 0;
}

static int read_modes(reader *reader, int node, void *to, const void *rule)
{
    static const field fields[] = {
        {"name", read_name, offsetof(scene_mode, name), NULL, 1},
        {"value", read_row_function, offsetof(scene_mode, value), NULL, 1},
        {NULL, NULL, 0, NULL, 0}};
    scene_target *target = &reader->s->target;
    int i, k = 0;
    (void)to;
    (void)rule;
    target->mode = new_items(reader, node, TREE_LIST, sizeof *target->mode, &target->modes);
    if (!target->mode)
        return -1;
    for (i = reader->t->node[node].first; i; i = reader->t->node[i].next, k++) {
        target->mode[k].at = node_at(reader, i);
        if (read_map(reader, i, fields, &target->mode[k]) != 0)
            return -1;
    }
    return 0;
}

/* Read a function of the coordinates, given by a predefined word or by an expression. */
static int read_free_item(reader *reader, int node, scene_mode *to)
{
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
    int i, n;
    (void)to;
    (void)rule;
    target->free = new_items(reader, node, TREE_LIST, sizeof *target->free, &n);
    if (!target->free)
        return -1;
    if (n > SCENE_FREE)
        return tree_fault(reader->t, node, "%d free functions; at most %d are read", n, SCENE_FREE);
    for (i = reader->t->node[node].first; i; i = reader->t->node[i].next)
        if (read_free_item(reader, i, &target->free[target->frees++]) != 0)
            return -1;
    return 0;
}

static const choice target_weights[] = {{"equal", 0}, {"area", 1}, {NULL, 0}};

/* Rows that every target has: values, weights, modes and free functions. */
#define TARGET_VALUES                                                                              \
    {"value", read_row_function, offsetof(output_text, value), NULL, 1},                           \
        {"weight", read_choice, offsetof(output_text, weight_area), target_weights, 0},            \
        {"modes", read_modes, 0, NULL, 0},                                                         \
    {                                                                                              \
        "free", read_free, 0, NULL, 0                                                              \
    }

static void keep_target(scene *scene, const output_text *text)
{
    scene->target.given = 1;
    scene->target.what = text->output;
    scene->target.what.reference = (double)NAN;
    strcpy(scene->target.what.name, "target");
    scene->target.weight_area = text->weight_area;
}

int read_target(reader *reader, int node, void *to, const void *rule)
{
    static const field fields[] = {
        DIRECTIONS(read_component), PLACE(output.where), TARGET_VALUES, {NULL, NULL, 0, NULL, 0}};
    scene *scene = to;
    output_text text;
    int status;
    (void)rule;
    memset(&text, 0, sizeof text);
    status = read_map(reader, node, fields, &text);
    scene->target.value = text.value;
    if (status != 0 || finish_output(reader, node, &text) != 0)
        return -1;
    keep_target(scene, &text);
    if (scene->amplifiers == 0)
        return tree_fault(reader->t, node, "a target needs actuators to reach it; add actuators");
    return 0;
}

int read_measured_target(reader *reader, int node, void *to, const void *rule)
{
    static const field fields[] = {TARGET_VALUES, {NULL, NULL, 0, NULL, 0}};
    scene *scene = to;
    output_text text;
    int status;
    (void)rule;
    memset(&text, 0, sizeof text);
    status = read_map(reader, node, fields, &text);
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

int read_compare(reader *reader, int node, void *to, const void *rule)
{
    static const field fields[] = {{"name", read_name, offsetof(scene_compare, name), NULL, 1},
                                   {"values", read_values, 0, NULL, 1},
                                   {NULL, NULL, 0, NULL, 0}};
    scene *scene = to;
    int i, k = 0;
    (void)rule;
    scene->compare = new_items(reader, node, TREE_LIST, sizeof *scene->compare, &scene->compares);
    if (!scene->compare)
        return -1;
    for (i = reader->t->node[node].first; i; i = reader->t->node[i].next, k++) {
        scene->compare[k].at = node_at(reader, i);
        if (read_map(reader, i, fields, &scene->compare[k]) != 0)
            return -1;
    }
    return 0;
}
