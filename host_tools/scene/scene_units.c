/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Numbers of a scene with units of measurement: the unit of each physical dimension, and the
 * conversion to the units of the scene.
 */
#include "scene_units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "surface.h"

/* ---- physical dimensions ---------------------------------------------- */

/*
 * Name of each physical dimension for error messages, a unit as an example, and its powers of
 * length, force, voltage, temperature, time and angle.
 */
static const struct {
    const char *name, *example;
    units_unit unit;
} dimensions[DIMENSIONS] = {
    [OF_NUMBER] = {"a number without a unit", "0.3", {{0, 0, 0, 0, 0, 0}, 0, 0}},
    [OF_LENGTH] = {"a length", "mm", {{1, 0, 0, 0, 0, 0}, 0, 0}},
    [OF_VOLUME] = {"a volume", "mm3", {{3, 0, 0, 0, 0, 0}, 0, 0}},
    [OF_RADIANS] = {"an angle", "deg or rad", {{0, 0, 0, 0, 0, 1}, 0, 0}},
    [OF_DEGREES] = {"an angle", "deg or rad", {{0, 0, 0, 0, 0, 1}, 0, 1}},
    [OF_FORCE] = {"a force", "N", {{0, 1, 0, 0, 0, 0}, 0, 0}},
    [OF_LINE_FORCE] = {"a force per length", "N/m", {{-1, 1, 0, 0, 0, 0}, 0, 0}},
    [OF_STRESS] = {"a stress or pressure", "MPa", {{-2, 1, 0, 0, 0, 0}, 0, 0}},
    [OF_ACCELERATION] = {"an acceleration", "m/s2", {{1, 0, 0, 0, -2, 0}, 0, 0}},
    [OF_DENSITY] = {"a density", "kg/m3", {{-4, 1, 0, 0, 2, 0}, 0, 0}},
    [OF_AREA_DENSITY] = {"a mass per area", "kg/m2", {{-3, 1, 0, 0, 2, 0}, 0, 0}},
    [OF_LINE_DENSITY] = {"a mass per length", "kg/m", {{-2, 1, 0, 0, 2, 0}, 0, 0}},
    [OF_MASS] = {"a mass", "kg", {{-1, 1, 0, 0, 2, 0}, 0, 0}},
    [OF_INERTIA] = {"a moment of inertia", "kg m2", {{1, 1, 0, 0, 2, 0}, 0, 0}},
    [OF_RATE] = {"a frequency", "Hz", {{0, 0, 0, 0, -1, 0}, 0, 0}},
    [OF_TEMPERATURE] = {"a temperature", "K", {{0, 0, 0, 1, 0, 0}, 0, 0}},
    [OF_EXPANSION] = {"a thermal expansion", "1/K", {{0, 0, 0, -1, 0, 0}, 0, 0}},
    [OF_VOLTAGE] = {"a voltage", "V", {{0, 0, 1, 0, 0, 0}, 0, 0}},
    [OF_VOLTAGE_RATE] = {"a voltage per time", "V/s", {{0, 0, 1, 0, -1, 0}, 0, 0}},
    [OF_FIELD] = {"an electric field", "MV/m", {{-1, 0, 1, 0, 0, 0}, 0, 0}},
    [OF_CHARGE] = {"a charge", "nC", {{1, 1, -1, 0, 0, 0}, 0, 0}},
    [OF_STRAIN_CONSTANT] = {"a piezoelectric strain constant",
                            "pm/V or pC/N",
                            {{1, 0, -1, 0, 0, 0}, 0, 0}},
    [OF_STRESS_CONSTANT] = {"a piezoelectric stress constant",
                            "C/m2",
                            {{-1, 1, -1, 0, 0, 0}, 0, 0}},
    [OF_PERMITTIVITY] = {"a permittivity", "nF/m", {{0, 1, -2, 0, 0, 0}, 0, 0}},
    [OF_PYROELECTRIC] = {"a pyroelectric constant", "C/(m2 K)", {{-1, 1, -1, -1, 0, 0}, 0, 0}},
    [OF_REGULARISATION] = {"a squared length per squared voltage",
                           "m2/V2",
                           {{2, 0, -2, 0, 0, 0}, 0, 0}},
    [OF_STIFFNESS] = {"a stiffness", "N/mm", {{-1, 1, 0, 0, 0, 0}, 0, 0}},
    [OF_LINE_STIFFNESS] = {"a stiffness per length", "N/mm2", {{-2, 1, 0, 0, 0, 0}, 0, 0}},
    [OF_FOUNDATION] = {"a stiffness per area", "N/mm3", {{-3, 1, 0, 0, 0, 0}, 0, 0}},
    [OF_TORSION] = {"a torsional stiffness", "N m/rad", {{1, 1, 0, 0, 0, -1}, 0, 0}},
    [OF_FORCE_CONSTANT] = {"a force per voltage", "N/V", {{0, 1, -1, 0, 0, 0}, 0, 0}},
    [OF_INFLUENCE] = {"a displacement per voltage", "um/V", {{1, 0, -1, 0, 0, 0}, 0, 0}},
    [OF_MOMENT] = {"a moment", "N m", {{1, 1, 0, 0, 0, 0}, 0, 0}},
};

static const double degree = 0.017453292519943295; /* one degree of an angle in radians */

/* ---- dimensions that follow from other keys --------------------------- */

/* Return the YAML mapping that contains the key of a node. */
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
 * Return the physical dimension of the value that a support prescribes: an angle for a rotation; a
 * dimensionless number for displacements divided by the thickness (difference of both faces, middle
 * surface relative to them); otherwise a length.
 */
static dimension of_support(const tree *tree, int map)
{
    const int fix = tree_find(tree, map, "fix");
    if (tree_find(tree, map, "about"))
        return OF_RADIANS;
    int is_pure = strstr(text_of(tree, map, "fix"), "difference") ||
                  strcmp(text_of(tree, map, "fix"), "u3M") == 0;
    for (int i = fix ? tree->node[fix].first : 0; i; i = tree->node[i].next)
        is_pure |= tree->node[i].text && (strstr(tree->node[i].text, "difference") ||
                                          strcmp(tree->node[i].text, "u3M") == 0);
    return is_pure ? OF_NUMBER : OF_LENGTH;
}

static dimension of_load(const tree *tree, int map)
{
    if (tree_find(tree, map, "face"))
        return OF_STRESS;
    return tree_find(tree, map, "line") ? OF_LINE_FORCE : OF_FORCE;
}

static dimension of_spring(const tree *tree, int map)
{
    const char *const per = text_of(tree, map, "per");
    if (tree_find(tree, map, "about"))
        return OF_TORSION;
    if (strcmp(per, "area") == 0)
        return OF_FOUNDATION;
    return strcmp(per, "length") == 0 ? OF_LINE_STIFFNESS : OF_STIFFNESS;
}

static dimension of_added_mass(const tree *tree, int map)
{
    const char *const per = text_of(tree, map, "per");
    if (strcmp(per, "area") == 0)
        return OF_AREA_DENSITY;
    return strcmp(per, "length") == 0 ? OF_LINE_DENSITY : OF_MASS;
}

static dimension of_reading(const reader *reader, int map)
{
    const int k = find_named(reader->s->output, reader->s->outputs, sizeof *reader->s->output,
                             text_of(reader->t, map, "output"));
    return k < 0 ? OF_LENGTH : scene_output_info_of(reader->s->output[k].type)->of;
}

/*
 * Return the physical dimension of the input of the amplifier with index k: voltage, or temperature
 * for a heater.
 */
static dimension of_amplifier(const scene *scene, int k)
{
    return scene_is_heater(scene->actuator, scene->actuators, k) ? OF_TEMPERATURE : OF_VOLTAGE;
}

static dimension of_limit(const reader *reader, int map)
{
    int first, count;
    const int found =
        scene_find_amplifier(reader->s, text_of(reader->t, map, "actuator"), &first, &count);
    return found ? of_amplifier(reader->s, first) : OF_VOLTAGE;
}

/*
 * Return the physical dimension of a number in the list of reference values of the section
 * `compare`, which has one value for each amplifier: voltage or temperature, by its position in the
 * list.
 */
static dimension of_compare(const reader *reader, int node)
{
    int k = 0;
    for (int i = reader->t->node[reader->t->node[node].parent].first; i && i != node;
         i = reader->t->node[i].next)
        k++;
    return of_amplifier(reader->s, k);
}

/*
 * Return the physical dimension (length or angle) of a number that stands below the key theta1 or
 * theta2 of a scene file: that of this surface coordinate.
 */
static dimension of_coordinate(const reader *reader, int node)
{
    const tree_node *const named = reader->t->node;
    int direction = 1;
    for (; node; node = named[node].parent)
        if (named[node].key && strncmp(named[node].key, "theta", 5) == 0)
            break;
    if (node)
        direction = strcmp(named[node].key, "theta2") == 0 ? 2 : 1;
    return surface_is_angle(&reader->s->surface, direction) ? OF_RADIANS : OF_LENGTH;
}

/*
 * Return the physical dimension (length or angle) of a coordinate of a point, by its position in
 * the list of coordinates.
 */
static dimension of_point(const reader *reader, int node)
{
    const int first = reader->t->node[reader->t->node[node].parent].first;
    const int direction = node == first ? 1 : 2;
    if (reader->s->quads)
        return OF_LENGTH;
    return surface_is_angle(&reader->s->surface, direction) ? OF_RADIANS : OF_LENGTH;
}

/*
 * Return the YAML node of an item of the section `patches`, given any YAML node inside its key
 * `outlines` (electrode outlines).
 */
static int outlines_owner(const tree *tree, int node)
{
    while (node && !(tree->node[node].key && strcmp(tree->node[node].key, "outlines") == 0))
        node = tree->node[node].parent;
    return tree->node[node].parent;
}

/*
 * Return the physical dimension of a number in the outline of an electrode: a length in a plane of
 * space; over theta1 and theta2, the two numbers of a point have the dimensions of these
 * coordinates. A radius or gap there is a length if both coordinates are lengths, else a number
 * without unit.
 */
static dimension of_outline(const reader *reader, int node)
{
    const tree_node *const named = reader->t->node;
    const int map = outlines_owner(reader->t, node), list = named[node].parent;
    const char *plane = text_of(reader->t, map, "plane");
    const int is_pair = named[list].kind == TREE_LIST && named[list].count == 2 &&
                        !(named[list].key && strcmp(named[list].key, "radii") == 0);
    const int angle[2] = {surface_is_angle(&reader->s->surface, 1),
                          surface_is_angle(&reader->s->surface, 2)};
    if (reader->s->quads || (*plane && strcmp(plane, "theta") != 0))
        return OF_LENGTH;
    if (is_pair)
        return angle[node != named[list].first] ? OF_RADIANS : OF_LENGTH;
    return angle[0] || angle[1] ? OF_NUMBER : OF_LENGTH;
}

static dimension resolve(const reader *reader, int node, dimension of)
{
    const int map = map_of(reader->t, node);
    switch (of) {
    case OF_NOTHING: return OF_NUMBER;
    case OF_COORDINATE: return of_coordinate(reader, node);
    case OF_POINT: return of_point(reader, node);
    case OF_SPRING: return of_spring(reader->t, map);
    case OF_ADDED_MASS: return of_added_mass(reader->t, map);
    case OF_OUTLINE: return of_outline(reader, node);
    case OF_SUPPORT: return of_support(reader->t, map);
    case OF_LOAD: return of_load(reader->t, map);
    case OF_READING: return of_reading(reader, map);
    case OF_ACTUATOR: return tree_find(reader->t, map, "temperature") ? OF_TEMPERATURE : OF_VOLTAGE;
    case OF_LIMIT: return of_limit(reader, map);
    case OF_COMPARE: return of_compare(reader, node);
    default: return of;
    }
}

/* ---- the scene's units ------------------------------------------------ */

static const char *const base_key[UNITS_BASES] = {"length",      "force", "voltage",
                                                  "temperature", "",      ""};
static const dimension base_dimension[UNITS_BASES] = {OF_LENGTH,      OF_FORCE, OF_VOLTAGE,
                                                      OF_TEMPERATURE, OF_RATE,  OF_RADIANS};

/*
 * Return the text by which the scene file names its unit of a base dimension (length, force,
 * voltage, temperature), or NULL for the second and the radian, which are fixed.
 */
static const char *base_text(const scene *scene, int base)
{
    switch (base) {
    case UNITS_LENGTH: return scene->units.length;
    case UNITS_FORCE: return scene->units.force;
    case UNITS_VOLTAGE: return scene->units.voltage;
    case UNITS_TEMPERATURE: return scene->units.temperature;
    default: return NULL;
    }
}

/*
 * Find the power of ten of the scene's unit for a base dimension. Returns 0, or -1 if the scene has
 * no such unit or if it is not an SI unit.
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

/*
 * Return the physical dimension that a unit of measurement belongs to, or DIMENSIONS, the number of
 * dimensions, if it belongs to none.
 */
static dimension name_dimension(const units_unit *unit)
{
    int of = OF_NUMBER;
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
    if (expected == OF_NUMBER)
        snprintf(wants, sizeof wants, "%s", dimensions[OF_NUMBER].name);
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

/*
 * Return a factor as text to be written after a number, which converts an angle in the unit of the
 * number from degrees to radians or back. The text is empty if the unit of the number and the
 * required unit have the same unit of angle.
 */
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
    const dimension expected = resolve(reader, node, reader->of);
    if (expected == OF_NUMBER || !units_alike(&unit, &dimensions[expected].unit))
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

/*
 * Copy the unit in the brackets at the end of the name of a column of a table, such as "u3 [um]".
 * Returns whether there are brackets.
 *   text  [SCENE_UNITS_TEXT] out  text in the brackets
 */
static bool text_in_brackets(const char *column, char text[SCENE_UNITS_TEXT])
{
    const char *open = strpbrk(column, "[(");
    const size_t length = open ? strlen(open) : 0;
    if (length < 3 || length > SCENE_UNITS_TEXT || !strchr("])", open[length - 1]))
        return false;
    memcpy(text, open + 1, length - 2);
    text[length - 2] = '\0';
    return true;
}

int scene_units_column(reader *reader, int node, dimension of, const char *column, double *factor)
{
    char text[SCENE_UNITS_TEXT];
    const dimension expected = resolve(reader, node, of);
    units_unit unit;
    const char *why;
    int ten;
    *factor = 1;
    if (!text_in_brackets(column, text) || units_parse(text, &unit, &why) < 0)
        return 0;
    if (!units_alike(&unit, &dimensions[expected].unit))
        return tree_fault(reader->t, node,
                          "the column '%.60s' of the file has a unit that is none of %s; correct "
                          "the unit, or remove it",
                          column, dimensions[expected].name);
    if (scene_units_ten(reader->s, &unit, &ten) >= 0)
        return 1;
    *factor = pow(10, ten);
    if (unit.degrees != dimensions[expected].unit.degrees)
        *factor *= unit.degrees ? degree : 1 / degree;
    return 1;
}

const char *scene_units_example(dimension of)
{
    return of > OF_NUMBER && of < DIMENSIONS ? dimensions[of].example : NULL;
}
