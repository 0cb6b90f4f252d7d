/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Section `influence` of a scene file: a measured influence matrix in place of a structural model.
 * Each column of the matrix becomes an actuator of the scene.
 */
#include "scene_file.h"
#include "scene_parts.h"
#include "scene_points.h"
#include "scene_units.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_OUTPUTS = 60000, MOST_ACTUATORS = 4096, AXES = SCENE_AXES };

/*
 * The section `influence` as it is written in the scene file, and the table of numbers from its
 * file.
 */
typedef struct influence_text {
    int file, coordinates, actuators, outputs, ignore, mask, tied, curve,
        modes; /* YAML nodes of the keys of the section `influence`; 0 for a key that is absent */
    bool rows_are_actuators;
    double scale, drop_below, scatter;
    number_table table;
    int coordinate_column[AXES]; /* numbers of the columns that hold the coordinates x, y and z of
                                    the outputs in the table of a measured influence matrix; -1
                                    where there is none */
    int *column; /* [columns] indices, in the table of a measured influence matrix, of the columns
                    that belong to the matrix and do not hold coordinates of outputs */
    int columns;
    unsigned char *is_ignored; /* [outputs of the file] 1 for each output of the measured influence
                                  matrix that the scene file leaves out, else 0 */
} influence_text;

/* Standard deviation of the relative errors of a measured matrix where the scene states none. */
static const double usual_scatter = 0.01;

static const char *const axis_name[AXES] = {"x", "y", "z"};

/* ---- shape of the matrix ---------------------------------------------- */

/*
 * In the table of a measured influence matrix, separate the columns of coordinates from those of
 * the matrix; only a table whose rows are outputs can have coordinates. Returns 0, or -1 after
 * writing an error message about the scene file.
 */
static int separate_columns(reader *reader, influence_text *text)
{
    const number_table *table = &text->table;
    text->column = calloc(table->columns + 1, sizeof *text->column);
    if (!text->column)
        return tree_fault(reader->t, text->file, "out of memory");
    for (int coordinate = 0; coordinate < AXES; coordinate++)
        text->coordinate_column[coordinate] = -1;
    for (int k = 0; k < (int)table->columns; k++) {
        int axis = -1;
        if (table->column_name && !text->rows_are_actuators)
            axis = scene_file_axis(table->column_name[k]);
        if (axis >= 0 && axis < AXES)
            text->coordinate_column[axis] = k;
        else
            text->column[text->columns++] = k;
    }
    return 0;
}

/* Remove the unit in brackets from the end of the name of a column, and the blanks before it. */
static void remove_unit(char *name)
{
    char *end = strpbrk(name, "[(");
    while (end > name && end[-1] == ' ')
        end--;
    *end = '\0';
}

/*
 * Convert columns of a measured influence matrix whose names end with a unit, such as "a1 (um/V)",
 * to the units of the scene, and remove the unit from the name. Returns 0, or -1 after an error
 * message: it is no unit of an influence matrix, or `scale` also converts the numbers.
 */
static int convert_columns(reader *reader, influence_text *text)
{
    number_table *table = &text->table;
    if (!table->column_name || text->rows_are_actuators)
        return 0;
    for (int k = 0; k < text->columns; k++) {
        double factor;
        char *name = table->column_name[text->column[k]];
        const int found = scene_units_column(reader, text->file, OF_INFLUENCE, name, &factor);
        if (found < 0)
            return -1;
        if (found > 0 && factor != 1 && text->scale != 1)
            return tree_fault(reader->t, text->file,
                              "the column '%.60s' of the file has a unit, and scale: %g converts "
                              "its numbers again; remove one of the two",
                              name, text->scale);
        for (size_t row = 0; found > 0 && row < table->rows; row++)
            table->value[row * table->columns + (size_t)text->column[k]] *= factor;
        if (found > 0)
            remove_unit(name);
    }
    return 0;
}

static int outputs_of(const influence_text *text)
{
    return text->rows_are_actuators ? text->columns : (int)text->table.rows;
}

static int actuators_of(const influence_text *text)
{
    return text->rows_are_actuators ? (int)text->table.rows : text->columns;
}

/*
 * Return an entry of the measured influence matrix as its file states it, before it is multiplied
 * by the factor `scale` of the scene file.
 *   place [NUMBER_NAME] out  position of the entry in the file, as text
 */
static double entry(const influence_text *text, int output, int actuator, char *place)
{
    const int row = text->rows_are_actuators ? actuator : output;
    const int column = text->column[text->rows_are_actuators ? output : actuator];
    number_table_place(&text->table, (size_t)row, (size_t)column, place);
    return text->table.value[(size_t)row * text->table.columns + (size_t)column];
}

/*
 * Check that a list in the scene file (names, points or flags) has as many entries as the measured
 * influence matrix has outputs, or has actuators. If a list for outputs has the number of the
 * actuators, or the reverse, the message says that the matrix is transposed. Returns 0, or -1 after
 * writing the error message.
 */
static int check_count(reader *reader, int node, const influence_text *text, const char *what,
                       int count, int is_of_outputs)
{
    const int own = is_of_outputs ? outputs_of(text) : actuators_of(text);
    const int other = is_of_outputs ? actuators_of(text) : outputs_of(text);
    if (count == own)
        return 0;
    if (count == other)
        return tree_fault(reader->t, node,
                          "%d %s, but the matrix has %d outputs and %d actuators: it is "
                          "transposed; write rows: %s",
                          count, what, outputs_of(text), actuators_of(text),
                          text->rows_are_actuators ? "outputs" : "actuators");
    return tree_fault(
        reader->t, node,
        "%d %s for %d %s of the matrix; give one for each, in the order of the file%s", count, what,
        own, is_of_outputs ? "outputs" : "actuators", scene_transposed_hint(reader->s));
}

static int check_size(reader *reader, const influence_text *text)
{
    if (outputs_of(text) > MOST_OUTPUTS || actuators_of(text) > MOST_ACTUATORS)
        return tree_fault(reader->t, text->file,
                          "%d outputs and %d actuators; at most %d and %d are read",
                          outputs_of(text), actuators_of(text), MOST_OUTPUTS, MOST_ACTUATORS);
    if (actuators_of(text) == 0)
        return tree_fault(reader->t, text->file,
                          "%.80s has coordinates only; add a column for each actuator",
                          node_text(reader, text->file));
    return 0;
}

/* ---- actuators -------------------------------------------------------- */

/*
 * Return the names of the rows or columns of the table that are actuators, or NULL where the file
 * has no names.
 */
static number_name *actuator_names(const influence_text *text)
{
    return text->rows_are_actuators ? text->table.row_name : text->table.column_name;
}

/*
 * Find the name of an actuator of a measured influence matrix: the name in the list of the scene
 * file, otherwise the name in the table, otherwise v1, v2 and so on.
 */
static int name_actuator(reader *reader, const influence_text *text, int k, int item, char *name)
{
    number_name *names = actuator_names(text);
    const int index = text->rows_are_actuators ? k : text->column[k];
    if (item)
        return read_name(reader, item, name, NULL);
    if (names)
        return check_name(reader, names[index], node_at(reader, text->file), name);
    snprintf(name, SCENE_NAME, "v%d", k + 1);
    return 0;
}

static int make_actuators(reader *reader, const influence_text *text)
{
    scene *scene = reader->s;
    const int count = actuators_of(text), list = text->actuators;
    int item = list ? reader->t->node[list].first : 0;
    if (list && (require_kind(reader, list, TREE_LIST) != 0 ||
                 check_count(reader, list, text, "names of actuators", reader->t->node[list].count,
                             0) != 0))
        return -1;
    scene->actuator = calloc((size_t)count + 1, sizeof *scene->actuator);
    if (!scene->actuator)
        return tree_fault(reader->t, text->file, "out of memory");
    scene->influence.has_numbered_actuators = !list && !actuator_names(text);
    for (int k = 0; k < count; k++) {
        scene_actuator *actuator = &scene->actuator[k];
        actuator->at = node_at(reader, item ? item : text->file);
        actuator->grid[0] = actuator->grid[1] = 1;
        actuator->first = k;
        if (name_actuator(reader, text, k, item, actuator->name) != 0)
            return -1;
        scene->actuators = scene->amplifiers = k + 1;
        item = item ? reader->t->node[item].next : 0;
    }
    return 0;
}

/* ---- outputs ---------------------------------------------------------- */

/*
 * Copy the names of the outputs of a measured influence matrix to influence.output_name [outputs of
 * the file], which stays NULL if neither the scene nor the file has names.
 */
static int name_outputs(reader *reader, const influence_text *text)
{
    const number_table *table = &text->table;
    number_name *names = text->rows_are_actuators ? table->column_name : table->row_name;
    const int list = text->outputs;
    if (!list && !names)
        return 0;
    if (list &&
        (require_kind(reader, list, TREE_LIST) != 0 ||
         check_count(reader, list, text, "names of outputs", reader->t->node[list].count, 1) != 0))
        return -1;
    number_name *name = calloc((size_t)outputs_of(text) + 1, sizeof *name);
    reader->s->influence.output_name = name;
    if (!name)
        return tree_fault(reader->t, text->file, "out of memory");
    int item = list ? reader->t->node[list].first : 0;
    for (int i = 0; i < outputs_of(text); i++) {
        const int index = text->rows_are_actuators ? text->column[i] : i;
        if (item ? read_name(reader, item, name[i], NULL) != 0
                 : check_name(reader, names[index], node_at(reader, text->file), name[i]) != 0)
            return -1;
        item = item ? reader->t->node[item].next : 0;
    }
    return 0;
}

/*
 * Return the index of an output of the measured influence matrix that is given by its name or by
 * its number counted from 1, or -1 if there is none.
 */
static int find_output(const reader *reader, const influence_text *text, const char *word)
{
    number_name *name = reader->s->influence.output_name;
    char *end;
    for (int i = 0; name && i < outputs_of(text); i++)
        if (strcmp(name[i], word) == 0)
            return i;
    const long number = strtol(word, &end, 10);
    return *word && !*end && number >= 1 && number <= outputs_of(text) ? (int)number - 1 : -1;
}

static int read_ignored(reader *reader, influence_text *text)
{
    const int list = text->ignore;
    if (!list)
        return 0;
    if (require_kind(reader, list, TREE_LIST) != 0)
        return -1;
    for (int i = reader->t->node[list].first; i; i = reader->t->node[i].next) {
        if (require_kind(reader, i, TREE_SCALAR) != 0)
            return -1;
        const int output = find_output(reader, text, node_text(reader, i));
        if (output < 0)
            return tree_fault(reader->t, i,
                              "there is no output '%.60s'; give its name, or its number from 1 to "
                              "%d",
                              node_text(reader, i), outputs_of(text));
        text->is_ignored[output] = 1;
    }
    return 0;
}

static int read_mask(reader *reader, influence_text *text)
{
    scene_numbers mask;
    if (!text->mask)
        return 0;
    reader->of = OF_NUMBER;
    if (scene_numbers_read(reader, text->mask, &mask) != 0)
        return -1;
    int failed =
        check_count(reader, text->mask, text, "entries of the mask", mask.count, 1) != 0 ? -1 : 0;
    for (int i = 0; i < mask.count && !failed; i++) {
        if (mask.value[i] != 0 && mask.value[i] != 1)
            failed = tree_fault(reader->t, text->mask,
                                "entry %d of the mask is %g; write 1 for an output that is used "
                                "and 0 for one that is not",
                                i + 1, mask.value[i]);
        else
            text->is_ignored[i] |= mask.value[i] == 0;
    }
    free(mask.value);
    return failed;
}

/* List the rows of the measured influence matrix that are used, in influence.row [outputs]. */
static int list_rows(reader *reader, influence_text *text)
{
    scene_influence *influence = &reader->s->influence;
    const size_t count = (size_t)outputs_of(text);
    text->is_ignored = calloc(count + 1, 1);
    influence->row = calloc(count + 1, sizeof *influence->row);
    if (!text->is_ignored || !influence->row)
        return tree_fault(reader->t, text->file, "out of memory");
    if (read_ignored(reader, text) != 0 || read_mask(reader, text) != 0)
        return -1;
    for (int i = 0; i < (int)count; i++)
        if (!text->is_ignored[i])
            influence->row[influence->outputs++] = i;
    if (influence->outputs == 0)
        return tree_fault(reader->t, text->file, "all %d outputs are ignored; use some of them",
                          (int)count);
    return 0;
}

/* ---- coordinates ------------------------------------------------------ */

/*
 * Copy the coordinates of the used outputs of a measured influence matrix from columns of a table.
 *   column [3] in  number of the column of x, y and z; -1 where the table has none: coordinate 0
 */
static int copy_coordinates(reader *reader, int node, const number_table *table,
                            const int column[AXES])
{
    scene_influence *influence = &reader->s->influence;
    char where[NUMBER_NAME];
    influence->place = calloc((size_t)influence->outputs, sizeof *influence->place);
    if (!influence->place)
        return tree_fault(reader->t, node, "out of memory");
    for (int i = 0; i < influence->outputs; i++)
        for (int axis = 0; axis < AXES; axis++) {
            const size_t row = (size_t)influence->row[i];
            const double value =
                column[axis] < 0 ? 0 : table->value[row * table->columns + (size_t)column[axis]];
            influence->place[i][axis] = value;
            if (isfinite(value))
                continue;
            number_table_place(table, row, (size_t)column[axis], where);
            return tree_fault(reader->t, node,
                              "the coordinate %s of an output is %g, at %s; write a finite number",
                              axis_name[axis], value, where);
        }
    return 0;
}

/*
 * Read the coordinates of the outputs of a measured influence matrix from the key `coordinates`: a
 * list of points, or a file.
 */
static int read_coordinates(reader *reader, const influence_text *text)
{
    const int node = text->coordinates;
    number_table table;
    int column[AXES];
    reader->of = OF_LENGTH;
    int failed = scene_points_table(reader, node, &table, column);
    if (!failed)
        failed =
            check_count(reader, node, text, "points of coordinates", (int)table.rows, 1) != 0 ||
            copy_coordinates(reader, node, &table, column) != 0;
    number_table_free(&table);
    return failed ? -1 : 0;
}

static int take_coordinates(reader *reader, const influence_text *text)
{
    int found = 0;
    for (int axis = 0; axis < AXES; axis++)
        found |= text->coordinate_column[axis] >= 0;
    if (found && text->coordinates)
        return tree_fault(reader->t, text->coordinates,
                          "the file of the matrix has columns x, y or z already; remove one of the "
                          "two");
    if (found)
        return copy_coordinates(reader, text->file, &text->table, text->coordinate_column);
    return text->coordinates ? read_coordinates(reader, text) : 0;
}

/* ---- matrix ----------------------------------------------------------- */

/* Return the name of an actuator of the file of the measured influence matrix. */
static const char *actuator_name(const scene *scene, int k)
{
    return scene->influence.tied > 0 ? scene->influence.tied_name[k] : scene->actuator[k].name;
}

/* Multiply the influence matrix by the factor `scale` of the scene file. */
static void scale_matrix(const scene *scene, double scale)
{
    const size_t entries = (size_t)scene->influence.outputs * (size_t)scene->amplifiers;
    for (size_t i = 0; i < entries; i++)
        scene->influence.matrix[i] *= scale;
}

/* Copy the measured influence matrix; the columns of tied actuators are added. */
static int copy_matrix(reader *reader, const influence_text *text)
{
    scene_influence *influence = &reader->s->influence;
    const size_t amplifiers = (size_t)reader->s->amplifiers;
    char place[NUMBER_NAME];
    double largest = 0;
    influence->matrix = calloc((size_t)influence->outputs * amplifiers, sizeof(double));
    if (!influence->matrix)
        return tree_fault(reader->t, text->file, "out of memory");
    for (int i = 0; i < influence->outputs; i++)
        for (int k = 0; k < actuators_of(text); k++) {
            const double value = entry(text, influence->row[i], k, place);
            const size_t amplifier = (size_t)scene_tied_amplifier(influence, k);
            if (!isfinite(value))
                return tree_fault(reader->t, text->file,
                                  "%.80s: %s, actuator '%s', is %g; measure it again, or ignore "
                                  "this output (ignore, mask)",
                                  node_text(reader, text->file), place, actuator_name(reader->s, k),
                                  value);
            influence->matrix[(size_t)i * amplifiers + amplifier] += value;
            largest = fmax(largest, fabs(value));
        }
    scale_matrix(reader->s, text->scale);
    if (largest > 0)
        return 0;
    return tree_fault(reader->t, text->file, "%.80s: every entry is 0; no voltage moves an output",
                      node_text(reader, text->file));
}

static int build(reader *reader, influence_text *text)
{
    if (scene_table_read(reader, text->file, &text->table) != 0 ||
        separate_columns(reader, text) != 0 || convert_columns(reader, text) != 0 ||
        check_size(reader, text) != 0)
        return -1;
    reader->s->influence.rows_are_actuators = text->rows_are_actuators;
    reader->s->influence.drop_below = text->drop_below;
    reader->s->influence.scatter = text->scatter;
    reader->s->influence.file_outputs = outputs_of(text);
    if (make_actuators(reader, text) != 0 || name_outputs(reader, text) != 0 ||
        list_rows(reader, text) != 0 || take_coordinates(reader, text) != 0)
        return -1;
    if ((text->tied && scene_tie(reader, text->tied) != 0) || copy_matrix(reader, text) != 0)
        return -1;
    if (text->curve && read_curves(reader, text->curve, reader->s, NULL) != 0)
        return -1;
    return text->modes ? read_measured_modes(reader, text->modes, reader->s, NULL) : 0;
}

static const choice row_meanings[] = {{"outputs", 0}, {"actuators", 1}, {NULL, 0}};

static const range below_half = {0, 0.5, 0, "must be from 0 to 0.5"};

static const field influence_fields[] = {
    {"file", read_node, offsetof(influence_text, file), .required = 1, .form = &label_form,
     .help = "File of the matrix, beside the scene file: displacement per volt, a row for each "
             "output and a column for each actuator; columns x, y, z are coordinates. With curve, "
             "displacement per unit of effect."},
    {"rows", read_either, offsetof(influence_text, rows_are_actuators), row_meanings,
     .help = "Meaning of the rows of the file; default outputs."},
    {"scale", read_real, offsetof(influence_text, scale), &above_zero, .of = OF_NUMBER,
     .help = "Factor of the entries; default 1."},
    {"drop_below", read_real, offsetof(influence_text, drop_below), &below_half, .of = OF_NUMBER,
     .help = "Entries smaller than this part of the largest entry of their actuator count as zero "
             "in the controller, so that its tables may be sparse; default 0. `check` prints the "
             "largest error that this causes."},
    {"scatter", read_real, offsetof(influence_text, scatter), &below_half, .of = OF_NUMBER,
     .help = "Standard deviation of the relative errors that the measured entries must be expected "
             "to have; default 0.01. `check` and `tables` refuse a control loop that such errors "
             "make unstable."},
    {"actuators", read_node, offsetof(influence_text, actuators), .form = &labels_form,
     .help = "Names of the actuators in the order of the file; default those of the file, or v1, "
             "v2 ..."},
    {"tied", read_node, offsetof(influence_text, tied), .form = &tied_form,
     .help = "Groups of actuators that one amplifier drives, as {left: [a1, a2], right: [a3, a4]}: "
             "their columns are added, and the group is an actuator with the narrowest limits of "
             "its members."},
    {"curve", read_node, offsetof(influence_text, curve), .of = OF_VOLTAGE, .form = &curves_form,
     .help = "Effect of a voltage, to which the displacement of an actuator is proportional: "
             "quadratic (its square), points [[voltage, effect], ...] with straight lines between "
             "them, or a file with a column of voltages and one of effects, or one for each "
             "actuator; default the voltage itself."},
    {"outputs", read_node, offsetof(influence_text, outputs), .form = &labels_form,
     .help = "Names of the outputs in the order of the file."},
    {"coordinates", read_node, offsetof(influence_text, coordinates), .of = OF_LENGTH,
     .form = &scene_points_form,
     .help = "Places of the outputs, as [[x, y, z], ...] or {file: ...}."},
    {"ignore", read_node, offsetof(influence_text, ignore), .form = &labels_form,
     .help = "Outputs that are left out, by name or number from 1."},
    {"mask", read_node, offsetof(influence_text, mask), .of = OF_NUMBER, .form = &numbers_form,
     .help = "1 for each output that is used and 0 for each that is not, as a list or {file: "
             "...}."},
    {"modes", read_node, offsetof(influence_text, modes), .form = &measured_modes_form,
     .help = "Vibration modes of the structure, lowest first, so that the control loop is assessed "
             "and damped like that of a structural model."},
    {.key = NULL}};

const form influence_form = {.type = FORM_MAP, .fields = influence_fields};

int read_influence(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    influence_text text;
    (void)rule;
    memset(&text, 0, sizeof text);
    text.scale = 1;
    text.scatter = usual_scatter;
    scene->influence.at = node_at(reader, node);
    scene->influence.given = true;
    const int failed =
        read_map(reader, node, influence_fields, &text) != 0 || build(reader, &text) != 0;
    if (!failed)
        snprintf(scene->influence.file, sizeof scene->influence.file, "%.250s",
                 node_text(reader, text.file));
    number_table_free(&text.table);
    free(text.column);
    free(text.is_ignored);
    return failed ? -1 : 0;
}

/* ---- target ----------------------------------------------------------- */

const char *scene_transposed_hint(const scene *scene)
{
    if (!scene->influence.given || scene->amplifiers <= scene->influence.file_outputs)
        return "";
    return scene->influence.rows_are_actuators
               ? "; the matrix has more actuators than outputs: if the rows of its file are "
                 "outputs, write rows: outputs"
               : "; the matrix has more actuators than outputs: if the rows of its file are "
                 "actuators, write rows: actuators";
}

/*
 * Return the name of an actuator that looks like a coordinate with its unit, such as x_mm, or NULL
 * where there is none. With such a name, a column of coordinates in the file of the influence
 * matrix has probably been read as an actuator.
 */
static const char *coordinate_like(const scene *scene)
{
    for (int k = 0; k < scene->actuators; k++) {
        const char *name = scene->actuator[k].name;
        if (strchr("xyzXYZ", *name) && (name[1] == '_' || name[1] == '-' || name[1] == '/'))
            return name;
    }
    return NULL;
}

/*
 * Check that a function can be evaluated at the outputs of a measured influence matrix: it uses
 * only coordinates that the outputs have, and a list has one value for each output of the file.
 */
static int check_function(const scene *scene, const expr *function, scene_at at, char *error)
{
    const int rows = expr_rows(function);
    if (rows >= 0 && rows != scene->influence.file_outputs)
        return scene_fault(at, error,
                           "%d values for %d outputs of the matrix; give one for each, ignored "
                           "ones included%s",
                           rows, scene->influence.file_outputs, scene_transposed_hint(scene));
    if (expr_uses_theta(function))
        return scene_fault(at, error,
                           "theta1 and theta2 are coordinates of a surface; a measured matrix has "
                           "x, y, z");
    if (rows >= 0 || expr_is_constant(function) || scene->influence.place)
        return 0;
    const char *name = coordinate_like(scene);
    if (name)
        return scene_fault(at, error,
                           "a function of the coordinates, but the outputs have none, and the "
                           "column '%s' of the matrix counts as an actuator; name the columns of "
                           "coordinates x [mm], y [mm]",
                           name);
    return scene_fault(at, error,
                       "a function of the coordinates, but the outputs have none; add "
                       "influence.coordinates, or give a list of values%s",
                       scene_transposed_hint(scene));
}

int scene_check_influence(const scene *scene, char *error)
{
    const scene_target *target = &scene->target;
    const scene_modal_gains *gains = &scene->control.modal_gains;
    if (!target->given)
        return 0;
    for (int k = 0; k < gains->functions; k++)
        if (check_function(scene, gains->function[k].value, gains->function[k].at, error) != 0)
            return -1;
    if (check_function(scene, target->value, target->what.at, error) != 0)
        return -1;
    for (int k = 0; k < target->modes; k++)
        if (check_function(scene, target->mode[k].value, target->mode[k].at, error) != 0)
            return -1;
    for (int k = 0; k < target->frees; k++)
        if (check_function(scene, target->free[k].value, target->free[k].at, error) != 0)
            return -1;
    for (int k = 0; k < scene->simulate.events; k++)
        if (scene->simulate.event[k].value &&
            check_function(scene, scene->simulate.event[k].value, scene->simulate.event[k].at,
                           error) != 0)
            return -1;
    if (!target->weight_area || scene->influence.place)
        return 0;
    return scene_fault(target->what.at, error,
                       "weight: area needs the places of the outputs; add influence.coordinates");
}
