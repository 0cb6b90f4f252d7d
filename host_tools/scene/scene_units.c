/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Numbers of a scene with units: the dimension of every numeric key, and the conversion to the
 * units of the scene.
 */
#include "scene_units.h"

#include <stdio.h>
#include <string.h>
#include "surface.h"

/* ---- dimensions ------------------------------------------------------- */

/*
 * Physical dimension of a key. Values after DIMENSIONS stand for dimensions that follow from
 * neighbouring keys in the scene.
 */
typedef enum dimension {
    PURE,
    LENGTH,
    VOLUME,
    RADIANS,
    DEGREES,
    FORCE,
    LINE_FORCE,
    STRESS,
    ACCELERATION,
    DENSITY,
    AREA_DENSITY,
    RATE,
    TEMPERATURE,
    EXPANSION,
    VOLTAGE,
    VOLTAGE_RATE,
    FIELD,
    CHARGE,
    STRAIN_CONSTANT,
    STRESS_CONSTANT,
    PERMITTIVITY,
    PYROELECTRIC,
    REGULARISATION,
    DIMENSIONS,
    OF_THETA1 = DIMENSIONS,
    OF_THETA2,
    OF_SUPPORT,
    OF_LOAD,
    OF_OUTPUT,
    OF_READING,
    OF_ACTUATOR,
    OF_LIMIT,
    OF_COMPARE
} dimension;

/*
 * Name of each dimension for error messages, with a unit as an example, and its powers of length,
 * force, voltage, temperature, time and angle.
 */
static const struct {
    const char *name, *example;
    units_unit unit;
} dimensions[DIMENSIONS] = {
    [PURE] = {"a number without a unit", "0.3", {{0, 0, 0, 0, 0, 0}, 0, 0}},
    [LENGTH] = {"a length", "mm", {{1, 0, 0, 0, 0, 0}, 0, 0}},
    [VOLUME] = {"a volume", "mm3", {{3, 0, 0, 0, 0, 0}, 0, 0}},
    [RADIANS] = {"an angle", "deg or rad", {{0, 0, 0, 0, 0, 1}, 0, 0}},
    [DEGREES] = {"an angle", "deg or rad", {{0, 0, 0, 0, 0, 1}, 0, 1}},
    [FORCE] = {"a force", "N", {{0, 1, 0, 0, 0, 0}, 0, 0}},
    [LINE_FORCE] = {"a force per length", "N/m", {{-1, 1, 0, 0, 0, 0}, 0, 0}},
    [STRESS] = {"a stress or pressure", "MPa", {{-2, 1, 0, 0, 0, 0}, 0, 0}},
    [ACCELERATION] = {"an acceleration", "m/s2", {{1, 0, 0, 0, -2, 0}, 0, 0}},
    [DENSITY] = {"a density", "kg/m3", {{-4, 1, 0, 0, 2, 0}, 0, 0}},
    [AREA_DENSITY] = {"a mass per area", "kg/m2", {{-3, 1, 0, 0, 2, 0}, 0, 0}},
    [RATE] = {"a frequency", "Hz", {{0, 0, 0, 0, -1, 0}, 0, 0}},
    [TEMPERATURE] = {"a temperature", "K", {{0, 0, 0, 1, 0, 0}, 0, 0}},
    [EXPANSION] = {"a thermal expansion", "1/K", {{0, 0, 0, -1, 0, 0}, 0, 0}},
    [VOLTAGE] = {"a voltage", "V", {{0, 0, 1, 0, 0, 0}, 0, 0}},
    [VOLTAGE_RATE] = {"a voltage per time", "V/s", {{0, 0, 1, 0, -1, 0}, 0, 0}},
    [FIELD] = {"an electric field", "MV/m", {{-1, 0, 1, 0, 0, 0}, 0, 0}},
    [CHARGE] = {"a charge", "nC", {{1, 1, -1, 0, 0, 0}, 0, 0}},
    [STRAIN_CONSTANT] = {"a piezoelectric strain constant",
                         "pm/V or pC/N",
                         {{1, 0, -1, 0, 0, 0}, 0, 0}},
    [STRESS_CONSTANT] = {"a piezoelectric stress constant", "C/m2", {{-1, 1, -1, 0, 0, 0}, 0, 0}},
    [PERMITTIVITY] = {"a permittivity", "nF/m", {{0, 1, -2, 0, 0, 0}, 0, 0}},
    [PYROELECTRIC] = {"a pyroelectric constant", "C/(m2 K)", {{-1, 1, -1, -1, 0, 0}, 0, 0}},
    [REGULARISATION] = {"a squared length per squared voltage",
                        "m2/V2",
                        {{2, 0, -2, 0, 0, 0}, 0, 0}},
};

/*
 * Dimension of every numeric key, with one row for a key or for several keys of the same dimension.
 * A path lists the keys from the root: '.' separates keys, '|' separates alternatives, and '*' is
 * any key; the items of lists have no key of their own.
 */
static const struct {
    const char *path;
    dimension of;
} rows[] = {
    {"tolerance", PURE},
    {"element.tau|rho", PURE},
    {"equilibrium.load_steps|tolerance|extrapolated_iterations|linear_solves", PURE},
    {"surface.radius|waist|height|tube|inner|outer|meridian", LENGTH},
    {"surface.smoothing", VOLUME},
    {"surface.angle", DEGREES},
    {"surface.ends|turns", PURE},
    {"mesh.theta1.from|to|points", OF_THETA1},
    {"mesh.theta2.from|to|points", OF_THETA2},
    {"mesh.theta1|theta2.elements|grading|centre", PURE},
    {"materials.*.E|E1|E2|E3|G12|G13|G23", STRESS},
    {"materials.*.stiffness.c11|c22|c33|c12|c13|c23|c44|c55|c66", STRESS},
    {"materials.*.nu|nu12|nu13|nu23", PURE},
    {"materials.*.d31|d32|d33|d24|d15", STRAIN_CONSTANT},
    {"materials.*.e31|e32|e33|e24|e15", STRESS_CONSTANT},
    {"materials.*.permittivity", PERMITTIVITY},
    {"materials.*.pyroelectric", PYROELECTRIC},
    {"materials.*.alpha", EXPANSION},
    {"materials.*.density", DENSITY},
    {"materials.*.field_limit", FIELD},
    {"layers.thickness", LENGTH},
    {"layers.angle", DEGREES},
    {"reference", LENGTH},
    {"patches.theta1", OF_THETA1},
    {"patches.theta2", OF_THETA2},
    {"patches.grid", PURE},
    {"actuators|sensors.drives.factor", PURE},
    {"actuators.applied", OF_ACTUATOR},
    {"limits.voltage|step_limit", VOLTAGE},
    {"limits.rate_limit", VOLTAGE_RATE},
    {"limits.regularisation", REGULARISATION},
    {"limits.regularisation.relative", PURE},
    {"limits.each.voltage|hold", OF_LIMIT},
    {"supports|outputs|target.at.theta1", OF_THETA1},
    {"supports|outputs|target.at.theta2", OF_THETA2},
    {"supports.value", OF_SUPPORT},
    {"loads.point.theta1", OF_THETA1},
    {"loads.point.theta2", OF_THETA2},
    {"loads.u1|u2|u3|x|y|z|pressure", OF_LOAD},
    {"loads.weight.gravity", ACCELERATION},
    {"loads.temperature", TEMPERATURE},
    {"loads.temperature.inner|outer", TEMPERATURE},
    {"contact.body.point|radius", LENGTH},
    {"contact.body.normal|axis|value", PURE},
    {"contact.move", LENGTH},
    {"contact.stiffness", PURE},
    {"outputs.reference", OF_OUTPUT},
    {"target.value", LENGTH},
    {"target.modes.value", LENGTH},
    {"compare.values", OF_COMPARE},
    {"estimate.readings.noise", OF_READING},
    {"estimate.voltages", VOLTAGE},
    {"estimate.loads|tolerance", PURE},
    {"target.free", PURE},
    {"dynamics.damping|modes", PURE},
    {"dynamics.damping.rayleigh", PURE},
    {"dynamics.mass_per_area", AREA_DENSITY},
    {"simulate.ticks|seed", PURE},
    {"control.rate", RATE},
    {"simulate.plant.stiffness|d|hysteresis|creep|modes", PURE},
    {"simulate.sensors.drift|quantum", PURE},
    {"simulate.sensors.outliers.chance|size", PURE},
    {"simulate.amplifiers.bandwidth", RATE},
    {"simulate.events.frequency", RATE},
    {"simulate.events.late|jitter|delay|impulse", PURE},
    {"influence.scale", PURE},
    {"influence.coordinates", LENGTH},
    {"influence.mask", PURE},
    {"simulate.plant.gain|scatter", PURE},
    {"simulate.plant.gain.*", PURE},
    {"simulate.plant.stiffness|d.*", PURE},
    {"simulate.sensors.noise", LENGTH},
    {"simulate.sensors.delay", PURE},
    {"simulate.amplifiers.step|dead_band", VOLTAGE},
    {"simulate.faults.chance|until", PURE},
    {"simulate.events.value", LENGTH},
    {"simulate.events.temperature", TEMPERATURE},
    {"simulate.events.at|target|load|missing_sensors|stuck_sensors|missed_ticks|factor|ticks|"
     "announced",
     PURE},
};

/* ---- the row of a key ------------------------------------------------- */

/* Return whether a key is one of the alternatives between start and end. */
static int segment_has(const char *start, const char *end, const char *key)
{
    const size_t length = strlen(key);
    if (end == start + 1 && *start == '*')
        return 1;
    while (start < end) {
        size_t word = strcspn(start, "|.");
        if (word == length && strncmp(start, key, length) == 0)
            return 1;
        start += word + 1;
    }
    return 0;
}

static int matches(const char *path, const char *const *key, int keys)
{
    for (int i = 0; i < keys; i++) {
        const size_t length = strcspn(path, ".");
        if (length == 0 || !segment_has(path, path + length, key[i]))
            return 0;
        path += length;
        if (*path == '.')
            path++;
    }
    return *path == 0;
}

static int find_row(const char *const *key, int keys)
{
    for (int i = 0; i < (int)(sizeof rows / sizeof *rows); i++)
        if (matches(rows[i].path, key, keys))
            return i;
    return -1;
}

int scene_units_known(const char *const *key, int keys)
{
    return find_row(key, keys) >= 0;
}

/* Write the keys from the root to a node into key [TREE_DEPTH + 1]. Returns the number of keys. */
static int keys_to(const tree *tree, int node, const char **key)
{
    int keys = 0;
    for (; node; node = tree->node[node].parent)
        if (tree->node[node].key && keys <= TREE_DEPTH)
            key[keys++] = tree->node[node].key;
    for (int i = 0; i < keys / 2; i++) {
        const char *const swap = key[i];
        key[i] = key[keys - 1 - i];
        key[keys - 1 - i] = swap;
    }
    return keys;
}

/* ---- dimensions that follow from neighbours --------------------------- */

/* Return the mapping that contains the key of a node. */
static int map_of(const tree *tree, int node)
{
    while (node && !tree->node[node].key)
        node = tree->node[node].parent;
    return tree->node[node].parent;
}

static const char *text_of(const tree *tree, int map, const char *key)
{
    const int node = tree_find(tree, map, key);
    return node && tree->node[node].text ? tree->node[node].text : "";
}

/*
 * Return the dimension of a support value: a displacement is a length, while a difference of the
 * faces over the thickness is dimensionless.
 */
static dimension of_support(const tree *tree, int map)
{
    const int fix = tree_find(tree, map, "fix");
    int is_pure = strstr(text_of(tree, map, "fix"), "difference") ||
                  strcmp(text_of(tree, map, "fix"), "u3M") == 0;
    for (int i = fix ? tree->node[fix].first : 0; i; i = tree->node[i].next)
        is_pure |= tree->node[i].text && (strstr(tree->node[i].text, "difference") ||
                                          strcmp(tree->node[i].text, "u3M") == 0);
    return is_pure ? PURE : LENGTH;
}

static dimension of_load(const tree *tree, int map)
{
    if (tree_find(tree, map, "face"))
        return STRESS;
    return tree_find(tree, map, "line") ? LINE_FORCE : FORCE;
}

static dimension of_output(const tree *tree, int map)
{
    const char *const contact = text_of(tree, map, "contact");
    if (tree_find(tree, map, "voltage"))
        return VOLTAGE;
    if (tree_find(tree, map, "charge"))
        return CHARGE;
    if (!*contact)
        return LENGTH;
    if (strcmp(contact, "nodes") == 0)
        return PURE;
    return strcmp(contact, "pressure") == 0 ? STRESS : FORCE;
}

static dimension of_reading(const reader *reader, int map)
{
    const int k = find_named(reader->s->output, reader->s->outputs, sizeof *reader->s->output,
                             text_of(reader->t, map, "output"));
    if (k < 0 || reader->s->output[k].electric == ELECTRIC_NONE)
        return LENGTH;
    return reader->s->output[k].electric == ELECTRIC_VOLTAGE ? VOLTAGE : CHARGE;
}

/* Return the dimension of the output of amplifier k. */
static dimension of_amplifier(const scene *scene, int k)
{
    for (int i = 0; i < scene->actuators; i++)
        if (scene->actuator[i].is_temperature && scene->actuator[i].first == k)
            return TEMPERATURE;
    return VOLTAGE;
}

static dimension of_limit(const reader *reader, int map)
{
    int first, count;
    const int found =
        scene_find_amplifier(reader->s, text_of(reader->t, map, "actuator"), &first, &count);
    return found ? of_amplifier(reader->s, first) : VOLTAGE;
}

/* Return the dimension of a value to compare; values are in the order of the amplifiers. */
static dimension of_compare(const reader *reader, int node)
{
    int k = 0;
    for (int i = reader->t->node[reader->t->node[node].parent].first; i && i != node;
         i = reader->t->node[i].next)
        k++;
    return of_amplifier(reader->s, k);
}

static dimension of_theta(const reader *reader, int direction)
{
    return surface_is_angle(&reader->s->surface, direction) ? RADIANS : LENGTH;
}

static dimension resolve(const reader *reader, int node, dimension of)
{
    const int map = map_of(reader->t, node);
    switch (of) {
    case OF_THETA1: return of_theta(reader, 1);
    case OF_THETA2: return of_theta(reader, 2);
    case OF_SUPPORT: return of_support(reader->t, map);
    case OF_LOAD: return of_load(reader->t, map);
    case OF_OUTPUT: return of_output(reader->t, map);
    case OF_READING: return of_reading(reader, map);
    case OF_ACTUATOR: return tree_find(reader->t, map, "temperature") ? TEMPERATURE : VOLTAGE;
    case OF_LIMIT: return of_limit(reader, map);
    case OF_COMPARE: return of_compare(reader, node);
    default: return of;
    }
}

static dimension dimension_of(const reader *reader, int node)
{
    const char *key[TREE_DEPTH + 1] = {NULL};
    const int row = find_row(key, keys_to(reader->t, node, key));
    return row < 0 ? PURE : resolve(reader, node, rows[row].of);
}

/* ---- the scene's units ------------------------------------------------ */

static const char *const base_key[UNITS_BASES] = {"length",      "force", "voltage",
                                                  "temperature", "",      ""};
static const dimension base_dimension[UNITS_BASES] = {LENGTH,      FORCE, VOLTAGE,
                                                      TEMPERATURE, RATE,  RADIANS};

/*
 * Return the scene's text for a base unit, or NULL for the second and the radian, which are fixed.
 */
static const char *base_text(const scene *scene, int base)
{
    switch (base) {
    case UNITS_LENGTH: return scene->unit_length;
    case UNITS_FORCE: return scene->unit_force;
    case UNITS_VOLTAGE: return scene->unit_voltage;
    case UNITS_TEMPERATURE: return scene->unit_temperature;
    default: return NULL;
    }
}

/*
 * Find the power of ten of the scene's unit for a base unit. Returns 0, or -1 if the scene has no
 * such unit or if it is not an SI unit of that base.
 */
static int base_ten(const scene *scene, int base, int *ten)
{
    const char *const text = base_text(scene, base);
    const char *why;
    units_unit unit;
    *ten = 0;
    if (!text)
        return 0;
    if (!*text || units_parse(text, &unit, &why) < 0 ||
        !units_alike(&unit, &dimensions[base_dimension[base]].unit))
        return -1;
    *ten = unit.ten;
    return 0;
}

int scene_units_ten(const scene *scene, const units_unit *unit, int *ten)
{
    int own;
    *ten = unit->ten;
    for (int base = 0; base < UNITS_BASES; base++) {
        if (unit->power[base] == 0)
            continue;
        if (base_ten(scene, base, &own) < 0)
            return base;
        *ten -= unit->power[base] * own;
    }
    return -1;
}

/* ---- numbers with units ----------------------------------------------- */

static int refuse_unit(reader *reader, int node, const char *suffix, const char *why)
{
    return tree_fault(reader->t, node,
                      "'%.60s: %.60s': '%.30s' is no unit: %s; the numbers of a formula carry none",
                      tree_name(reader->t, node), node_text(reader, node), suffix, why);
}

/* Return the dimension of a unit, or DIMENSIONS if no known dimension has that unit. */
static dimension name_dimension(const units_unit *unit)
{
    int of = 0;
    while (of < DIMENSIONS && !units_alike(unit, &dimensions[of].unit))
        of++;
    return (dimension)of;
}

static int refuse_dimension(reader *reader, int node, const char *suffix, const units_unit *unit,
                            dimension expected)
{
    const dimension found = name_dimension(unit);
    char has[80], wants[80];
    if (found < DIMENSIONS)
        snprintf(has, sizeof has, "the unit of %s", dimensions[found].name);
    else
        snprintf(has, sizeof has, "the unit '%.30s'", suffix);
    if (expected == PURE)
        snprintf(wants, sizeof wants, "%s", dimensions[PURE].name);
    else
        snprintf(wants, sizeof wants, "that of %s, as %s", dimensions[expected].name,
                 dimensions[expected].example);
    return tree_fault(reader->t, node, "'%.60s: %.60s' has %s; expected %s",
                      tree_name(reader->t, node), node_text(reader, node), has, wants);
}

static int refuse_base(reader *reader, int node, int base)
{
    const char *const key = base_key[base], *const text = base_text(reader->s, base);
    const char *const example = dimensions[base_dimension[base]].example;
    if (!*text)
        return tree_fault(
            reader->t, node,
            "'%.60s: %.60s' has a unit but the scene has no unit of %s; add %s: %s to units, or "
            "remove the unit",
            tree_name(reader->t, node), node_text(reader, node), key, key, example);
    return tree_fault(
        reader->t, node,
        "'%.60s: %.60s' has a unit, but '%s: %.30s' of the scene's units is no SI unit of %s; "
        "write one as %s, or remove the unit",
        tree_name(reader->t, node), node_text(reader, node), key, text,
        dimensions[base_dimension[base]].name, example);
}

/* Return the factor, as text after the number, that converts degrees to radians or the reverse. */
static const char *turn(const units_unit *unit, const units_unit *key)
{
    if (unit->degrees == key->degrees)
        return "";
    return unit->degrees ? "*pi/180" : "*180/pi";
}

int scene_units_text(reader *reader, int node, char text[SCENE_UNITS_TEXT], const char **plain)
{
    char number[UNITS_NUMBER];
    units_unit unit;
    const char *why;
    size_t length;
    int ten;
    const char *const suffix = units_suffix(node_text(reader, node), &length);
    *plain = node_text(reader, node);
    if (!suffix)
        return 0;
    if (units_parse(suffix, &unit, &why) < 0)
        return refuse_unit(reader, node, suffix, why);
    const dimension expected = dimension_of(reader, node);
    if (expected == PURE || !units_alike(&unit, &dimensions[expected].unit))
        return refuse_dimension(reader, node, suffix, &unit, expected);
    const int missing = scene_units_ten(reader->s, &unit, &ten);
    if (missing >= 0)
        return refuse_base(reader, node, missing);
    if (units_shift(node_text(reader, node), length, ten, number) < 0)
        return tree_fault(reader->t, node, "'%.60s: %.60s' is too long a number; give fewer digits",
                          tree_name(reader->t, node), node_text(reader, node));
    snprintf(text, SCENE_UNITS_TEXT, "%s%s", number, turn(&unit, &dimensions[expected].unit));
    *plain = text;
    return 0;
}
