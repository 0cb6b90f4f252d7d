/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Key `curve` of the section `influence` of a scene: curves of actuators whose displacement is not
 * proportional to their voltage. A curve gives the effect of each voltage, the quantity to which
 * the displacement is proportional.
 */
#include "scene_file.h"
#include "scene_parts.h"
#include "scene_units.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const choice square_word[] = {{"quadratic", 1}, {NULL, 0}};
static const form square_form = {.type = FORM_WORD, .words = square_word};
static const form pair_form = {.type = FORM_LIST, .item = &number_form, .least = 2, .most = 2};
static const form points_form = {
    .type = FORM_LIST, .item = &pair_form, .least = 2, .most = SCENE_CURVE_POINTS};
static const field file_fields[] = {
    {"file", read_node, 0, .required = 1, .form = &label_form,
     .help = "File beside the scene file with a row for each point: the voltage, then the effect "
             "on all actuators, or on each of them in columns with their names."},
    {.key = NULL}};
static const form file_form = {.type = FORM_MAP, .fields = file_fields};
static const form *const forms[] = {&square_form, &points_form, &file_form, NULL};
const form curves_form = {.type = FORM_ANY, .any = forms};

/* ---- reading ---------------------------------------------------------- */

static bool allocate(scene_curves *curves, size_t sets, size_t points)
{
    curves->sets = (int)sets;
    curves->points = (int)points;
    curves->voltage = calloc(sets * points, sizeof *curves->voltage);
    curves->effect = calloc(sets * points, sizeof *curves->effect);
    curves->unit = calloc(sets, sizeof *curves->unit);
    return curves->voltage && curves->effect && curves->unit;
}

static int check_points(reader *reader, int node, size_t points)
{
    if (points >= 2 && points <= SCENE_CURVE_POINTS)
        return 0;
    return tree_fault(reader->t, node, "a curve of %zu points; write 2 to %d points", points,
                      SCENE_CURVE_POINTS);
}

static int read_curve_point(reader *reader, int node, double *voltage, double *effect)
{
    if (require_kind(reader, node, TREE_LIST) != 0)
        return -1;
    if (reader->t->node[node].count != 2)
        return tree_fault(reader->t, node, "a point of %d numbers; write [voltage, effect]",
                          reader->t->node[node].count);
    const int first = reader->t->node[node].first;
    reader->of = OF_VOLTAGE;
    if (read_real(reader, first, voltage, NULL) != 0)
        return -1;
    reader->of = OF_NUMBER;
    return read_real(reader, reader->t->node[first].next, effect, NULL);
}

static int read_list(reader *reader, int node, scene_curves *curves)
{
    const size_t points = (size_t)reader->t->node[node].count;
    size_t k = 0;
    if (check_points(reader, node, points) != 0)
        return -1;
    if (!allocate(curves, 1, points))
        return tree_fault(reader->t, node, "out of memory");
    for (int i = reader->t->node[node].first; i; i = reader->t->node[i].next, k++)
        if (read_curve_point(reader, i, &curves->voltage[k], &curves->effect[k]) != 0)
            return -1;
    return 0;
}

/*
 * Check that a table of actuator curves has one column of effects (values to which the displacement
 * is proportional) for all actuators together, or one for each of them. Returns 0, or -1 after
 * writing an error message about the scene file.
 */
static int check_columns(reader *reader, int node, const number_table *table)
{
    const scene *scene = reader->s;
    const char *file = node_text(reader, node);
    if (table->columns < 2)
        return tree_fault(reader->t, node, "%.80s has one column; write two, voltages and effects",
                          file);
    if (table->columns == 2)
        return 0;
    if (scene->influence.tied > 0)
        return tree_fault(reader->t, node,
                          "%.80s has curves of single actuators, and some are tied to one "
                          "amplifier; write one column of effects for all, or leave tied out",
                          file);
    if (table->columns == (size_t)scene->amplifiers + 1)
        return 0;
    return tree_fault(reader->t, node,
                      "%.80s has %zu columns of effects for %d actuators; write one for all "
                      "actuators, or one for each",
                      file, table->columns - 1, scene->amplifiers);
}

/*
 * Find the column of a table of curves that holds the effects of an actuator, values to which its
 * displacement is proportional: by the name of the actuator where the file has names, otherwise in
 * the order of the actuators. Returns the number of the column, or -1 after writing an error
 * message about the scene file.
 */
static int effect_column(reader *reader, int node, const number_table *table, int set)
{
    const char *name = reader->s->actuator[set].name;
    if (!table->column_name || table->columns == 2)
        return set + 1;
    for (size_t k = 1; k < table->columns; k++)
        if (number_table_is_named(table->column_name[k], name))
            return (int)k;
    return tree_fault(reader->t, node,
                      "%.80s has no column with the name of actuator '%s'; name the columns of "
                      "effects like the actuators",
                      node_text(reader, node), name);
}

/* Copy the entries of one column of a table of curves, times a factor. */
static int copy_column(reader *reader, int node, const number_table *table, int column,
                       double factor, double *value)
{
    char place[NUMBER_NAME];
    for (size_t row = 0; row < table->rows; row++) {
        value[row] = factor * table->value[row * table->columns + (size_t)column];
        if (isfinite(value[row]))
            continue;
        number_table_place(table, row, (size_t)column, place);
        return tree_fault(reader->t, node,
                          "%.80s: %s is %g; write a finite number, or leave this point out",
                          node_text(reader, node), place, value[row]);
    }
    return 0;
}

static int copy_table(reader *reader, int node, const number_table *table, scene_curves *curves)
{
    double factor = 1;
    if (check_columns(reader, node, table) != 0 || check_points(reader, node, table->rows) != 0)
        return -1;
    if (!allocate(curves, table->columns - 1, table->rows))
        return tree_fault(reader->t, node, "out of memory");
    if (table->column_name &&
        scene_units_column(reader, node, OF_VOLTAGE, table->column_name[0], &factor) < 0)
        return -1;
    for (int set = 0; set < curves->sets; set++) {
        const size_t first = (size_t)set * table->rows;
        const int column = effect_column(reader, node, table, set);
        if (column < 0 ||
            copy_column(reader, node, table, 0, factor, curves->voltage + first) != 0 ||
            copy_column(reader, node, table, column, 1, curves->effect + first) != 0)
            return -1;
    }
    return 0;
}

static int read_file(reader *reader, int node, scene_curves *curves)
{
    int file = 0;
    number_table table;
    if (read_map(reader, node, file_fields, &file) != 0 ||
        scene_table_read(reader, file, &table) != 0)
        return -1;
    const int failed = copy_table(reader, file, &table, curves);
    number_table_free(&table);
    return failed;
}

int read_curves(reader *reader, int node, void *to, const void *rule)
{
    scene_curves *curves = &((scene *)to)->influence.curve;
    int word;
    (void)rule;
    curves->given = true;
    curves->at = node_at(reader, node);
    if (reader->t->node[node].kind == TREE_LIST)
        return read_list(reader, node, curves);
    if (reader->t->node[node].kind == TREE_MAP)
        return read_file(reader, node, curves);
    curves->is_square = true;
    return read_choice(reader, node, &word, square_word);
}

/* ---- points ----------------------------------------------------------- */

/*
 * Return the words by which a message names the owner of an actuator curve: the name of one
 * actuator, or "all actuators" where they share one curve.
 */
static const char *owner(const scene *scene, int set)
{
    return scene->influence.curve.sets > 1 ? scene->actuator[set].name : "all actuators";
}

/*
 * Scale the effects of an actuator curve (values to which the displacement is proportional) so that
 * their largest absolute value equals that of the voltages. A curve that falls is reversed: its
 * scale factor becomes negative.
 */
static void scale_effects(scene_curves *curves, int set)
{
    const size_t points = (size_t)curves->points, first = (size_t)set * points;
    const double *voltage = curves->voltage + first;
    double *effect = curves->effect + first;
    double most_voltage = 0, most_effect = 0;
    for (size_t i = 0; i < points; i++) {
        most_voltage = fmax(most_voltage, fabs(voltage[i]));
        most_effect = fmax(most_effect, fabs(effect[i]));
    }
    const double size = most_effect > 0 && most_voltage > 0 ? most_effect / most_voltage : 1;
    curves->unit[set] = effect[points - 1] < effect[0] ? -size : size;
    for (size_t i = 0; i < points; i++)
        effect[i] /= curves->unit[set];
}

/*
 * Check that the points of an actuator curve ascend, also after rounding to single precision: both
 * their voltages and their scaled effects (values to which the displacement is proportional).
 * Returns 0, or -1 with error filled.
 */
static int check_ascending(const scene *scene, int set, char *error)
{
    const scene_curves *curves = &scene->influence.curve;
    const size_t first = (size_t)set * (size_t)curves->points;
    const double *v = curves->voltage + first, *e = curves->effect + first;
    const double unit = curves->unit[set];
    for (int i = 1; i < curves->points; i++) {
        if (!(v[i] > v[i - 1]))
            return scene_fault(curves->at, error,
                               "curve of %s: the voltage of point %d, %g, follows %g; sort the "
                               "points by ascending voltages, and write each voltage once",
                               owner(scene, set), i + 1, v[i], v[i - 1]);
        if (!(e[i] > e[i - 1]))
            return scene_fault(curves->at, error,
                               "curve of %s: the effect goes from %g at %g to %g at %g; it must "
                               "rise everywhere, or fall everywhere: leave points out, or end "
                               "curve and limits.voltage before",
                               owner(scene, set), unit * e[i - 1], v[i - 1], unit * e[i], v[i]);
        if (!((float)v[i] > (float)v[i - 1]) || !((float)e[i] > (float)e[i - 1]))
            return scene_fault(curves->at, error,
                               "curve of %s: points %d and %d, at %.10g and %.10g, are the same in "
                               "single precision; leave one of them out",
                               owner(scene, set), i, i + 1, v[i - 1], v[i]);
    }
    return 0;
}

/* ---- voltage limits --------------------------------------------------- */

static void limits_of(const scene *scene, int amplifier, double *lower, double *upper)
{
    *lower = scene->limits.lower;
    *upper = scene->limits.upper;
    scene_own_limits(scene, amplifier, lower, upper);
}

/* Check that no voltage limit of a scene is infinite. Returns 0, or -1 with error filled. */
static int check_finite(const scene *scene, char *error)
{
    for (int k = 0; k < scene->amplifiers; k++) {
        double lower, upper;
        limits_of(scene, k, &lower, &upper);
        if (!isfinite(lower) || !isfinite(upper))
            return scene_fault(scene->influence.curve.at, error,
                               "an actuator curve needs limits of the voltages, and '%s' has "
                               "none; add limits: {voltage: [lowest, highest]}",
                               scene->actuator[k].name);
    }
    return 0;
}

/*
 * Make the curve of an actuator whose displacement is proportional to the square of the voltage,
 * from 0 V to the highest voltage limit of all amplifiers. Returns 0, or -1 with error filled.
 */
static int make_square(scene *scene, char *error)
{
    scene_curves *curves = &scene->influence.curve;
    double most = 0;
    for (int k = 0; k < scene->amplifiers; k++) {
        double lower, upper;
        limits_of(scene, k, &lower, &upper);
        most = fmax(most, upper);
        if (lower < 0)
            return scene_fault(curves->at, error,
                               "curve: quadratic, but '%s' goes down to %g V, where the square "
                               "rises again; write limits: {voltage: [0, %g]}",
                               scene->actuator[k].name, lower, fmax(upper, -lower));
    }
    if (!(most > 0))
        return scene_fault(curves->at, error,
                           "curve: quadratic, but no voltage limit is above 0; write limits: "
                           "{voltage: [0, highest]}");
    curves->bend = calloc(1, sizeof *curves->bend);
    if (!allocate(curves, 1, 2) || !curves->bend)
        return scene_fault(curves->at, error, "out of memory");
    curves->voltage[1] = most;
    curves->effect[1] = most * most;
    curves->bend[0] = 1;
    return 0;
}

/*
 * Check that the curve of every amplifier is known between its voltage limits. Returns 0, or -1
 * with error filled.
 */
static int check_ends(const scene *scene, char *error)
{
    const scene_curves *curves = &scene->influence.curve;
    for (int k = 0; k < scene->amplifiers; k++) {
        double lower, upper;
        const int set = curves->sets > 1 ? k : 0;
        const double *voltage = curves->voltage + (size_t)set * (size_t)curves->points;
        const double last = voltage[curves->points - 1];
        limits_of(scene, k, &lower, &upper);
        if (lower >= voltage[0] && upper <= last)
            continue;
        return scene_fault(curves->at, error,
                           "the curve of '%s' goes from %g to %g V, and its voltage limits from %g "
                           "to %g V; give the curve up to the limits, or narrow limits.voltage",
                           scene->actuator[k].name, voltage[0], last, lower, upper);
    }
    return 0;
}

/*
 * Return the effect (value to which the displacement is proportional) at 0 V on an actuator curve
 * whose segments are straight; where 0 V lies outside the curve, the effect at the nearer end.
 */
static double effect_of_zero(const scene_curves *curves, int set)
{
    const size_t points = (size_t)curves->points, first = (size_t)set * points;
    const double *v = curves->voltage + first, *e = curves->effect + first;
    size_t i = 1;
    while (i + 1 < points && v[i] < 0)
        i++;
    const double t = fmin(fmax(-v[i - 1] / (v[i] - v[i - 1]), 0), 1);
    return e[i - 1] + (e[i] - e[i - 1]) * t;
}

/*
 * Refuse a regularisation of the voltages if the curve of an actuator does not go through 0 at 0 V.
 * The optimiser computes with effects, values to which the displacements of the actuators are
 * proportional, and would draw these to 0 instead of the voltages. Returns 0, or -1 with error
 * filled.
 */
static int check_reference(const scene *scene, char *error)
{
    const scene_curves *curves = &scene->influence.curve;
    for (int set = 0; set < curves->sets && scene->limits.regularisation > 0; set++) {
        const double *voltage = curves->voltage + (size_t)set * (size_t)curves->points;
        const double zero = effect_of_zero(curves, set);
        const double most = fmax(fabs(voltage[0]), fabs(voltage[curves->points - 1]));
        if (!curves->is_square && !(fabs(zero) <= 1e-12 * most))
            return scene_fault(scene->limits.at, error,
                               "regularisation draws the effects to 0, and by the curve of %s 0 V "
                               "has the effect %g; subtract this effect from all points of the "
                               "curve, or leave regularisation out",
                               owner(scene, set), curves->unit[set] * zero);
    }
    return 0;
}

/* ---- the whole scene -------------------------------------------------- */

/* Refuse functions of the control loop that assume linear actuators. */
static int check_others(const scene *scene, char *error)
{
    const struct {
        bool is_given;
        const char *key, *reason;
    } other[] = {
        {scene->hysteresis.given, "hysteresis", "has a curve of its own"},
        {scene->limits.rows > 0, "limits.difference, limits.sum and limits.absolute_sum",
         "hold for voltages, not for their effects"},
        {scene->simulate.detects_faults, "detected faults (simulate.events)",
         "assume linear actuators"},
        {scene->safety.amplitude > 0, "safety.selftest", "assumes linear actuators"},
        {scene->influence.modes > 0, "influence.modes", "assume linear actuators"},
    };
    for (size_t k = 0; k < sizeof other / sizeof *other; k++)
        if (other[k].is_given)
            return scene_fault(scene->influence.curve.at, error,
                               "influence.curve does not go together with %s, which %s; leave one "
                               "of them out",
                               other[k].key, other[k].reason);
    return 0;
}

/*
 * Convert the influence matrix from displacement per unit of the effect in the file to displacement
 * per volt of the scaled effect, where the displacement of an actuator is proportional to its
 * effect. Each column is multiplied by the conversion factor (curve.unit) of its actuator.
 */
static void scale_matrix(scene *scene)
{
    const scene_influence *influence = &scene->influence;
    const size_t amplifiers = (size_t)scene->amplifiers;
    for (size_t i = 0; i < (size_t)influence->outputs * amplifiers; i++)
        influence->matrix[i] *=
            influence->curve.unit[influence->curve.sets > 1 ? i % amplifiers : 0];
}

int scene_check_curves(scene *scene, char *error)
{
    scene_curves *curves = &scene->influence.curve;
    if (!curves->given)
        return scene->simulate.curve_error != 0
                   ? scene_fault(scene->simulate.at, error,
                                 "curve_error is the error of an actuator curve; add "
                                 "influence.curve, or leave it out")
                   : 0;
    if (check_others(scene, error) != 0 || check_finite(scene, error) != 0 ||
        (curves->is_square && make_square(scene, error) != 0))
        return -1;
    for (int set = 0; set < curves->sets; set++) {
        scale_effects(curves, set);
        if (check_ascending(scene, set, error) != 0)
            return -1;
    }
    if (check_ends(scene, error) != 0 || check_reference(scene, error) != 0)
        return -1;
    scale_matrix(scene);
    return 0;
}
