/* SPDX-License-Identifier: BSD-2-Clause */
/* Functions and lists of numbers that a scene gives in files of their own (scene_file.h). */
#include "scene_file.h"
#include "scene_units.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const axis_name[EXPR_AXES] = {"x", "y", "z", "theta1", "theta2"};

/* ---- tables ----------------------------------------------------------- */

char *scene_file_path(const reader *reader, const char *name)
{
    const char *scene = reader->t->path;
    const char *slash = strrchr(scene, '/');
    const size_t folder = slash && *name != '/' ? (size_t)(slash - scene) + 1 : 0;
    char *path = malloc(folder + strlen(name) + 1);
    if (!path)
        return NULL;
    memcpy(path, scene, folder);
    strcpy(path + folder, name);
    return path;
}

static void scale_column(number_table *table, size_t column, double factor)
{
    for (size_t row = 0; row < table->rows; row++)
        table->value[row * table->columns + column] *= factor;
}

/*
 * Convert the columns of a table that hold the coordinates x, y and z in a stated unit, such as "x
 * [mm]", to the unit of length of the scene. Returns 0, or -1 after writing an error message about
 * the scene file.
 */
static int convert_coordinates(reader *reader, int node, number_table *table)
{
    double factor;
    for (size_t k = 0; table->column_name && k < table->columns; k++) {
        const char *name = table->column_name[k];
        const int axis = scene_file_axis(name);
        if (axis < 0 || axis >= SCENE_AXES || strlen(name) == 1)
            continue;
        const int found = scene_units_column(reader, node, OF_LENGTH, name, &factor);
        if (found < 0)
            return -1;
        if (found == 0)
            return tree_fault(
                reader->t, node,
                "the column '%.60s' of the file has no unit of length; write %c [mm], "
                "or %c for the scene's own unit",
                name, *name, *name);
        scale_column(table, k, factor);
    }
    return 0;
}

int scene_table_read(reader *reader, int node, number_table *table)
{
    char error[NUMBER_ERROR];
    memset(table, 0, sizeof *table);
    if (require_kind(reader, node, TREE_SCALAR) != 0)
        return -1;
    char *path = scene_file_path(reader, node_text(reader, node));
    if (!path)
        return tree_fault(reader->t, node, "out of memory");
    int failed = number_table_read(table, path, error);
    if (!failed && number_table_check(table, path, error) < 0) {
        number_table_free(table);
        failed = -1;
    }
    free(path);
    if (failed)
        return tree_fault(reader->t, node, "%s", error);
    reader->s->hash = (reader->s->hash ^ table->hash) * 16777619u;
    if (convert_coordinates(reader, node, table) == 0)
        return 0;
    number_table_free(table);
    return -1;
}

/*
 * Check that one entry of a table is finite. Returns 0, or -1 after writing an error message about
 * the scene file, with the row and column of the entry in the file.
 */
static int check_finite(reader *reader, int node, const number_table *table, size_t row,
                        size_t column)
{
    char place[NUMBER_NAME];
    const double value = table->value[row * table->columns + column];
    if (isfinite(value))
        return 0;
    number_table_place(table, row, column, place);
    return tree_fault(reader->t, node, "%.80s: %s is %g; write a finite number",
                      node_text(reader, node), place, value);
}

static int read_list_node(reader *reader, int node, void *to, const void *rule)
{
    (void)rule;
    *(int *)to = node;
    return require_kind(reader, node, TREE_LIST);
}

/* ---- functions -------------------------------------------------------- */

/* Columns of a table that gives a function: one for each coordinate, and one for the value. */
typedef struct function_columns {
    int axes, axis[EXPR_AXES], column[EXPR_AXES]; /* coordinates of a function that a table gives:
                                                     how many; index of each among x, y, z (in
                                                     space), theta1, theta2 (on the surface); and
                                                     number of the column that holds it */
    int value; /* number of the column that holds the values of a function given by a table */
} function_columns;

typedef struct function_text {
    int file, columns, value; /* YAML nodes of the keys `file`, `columns` and `value` in a mapping
                                 by which a scene file takes a function from a table in another
                                 file; 0 for a key that is absent */
    double scale;
} function_text;

int scene_file_axis(const char *name)
{
    for (int axis = 0; axis < EXPR_AXES; axis++)
        if (tolower((unsigned char)*name) == *axis_name[axis] &&
            strcspn(name, " [(") == strlen(axis_name[axis]) &&
            strncmp(axis_name[axis] + 1, name + 1, strlen(axis_name[axis]) - 1) == 0)
            return axis;
    return -1;
}

/*
 * Return the number of the column that item k of the key `columns` stands for: the column with that
 * name, or column k if the table has no names. Returns -1 if there is no such column.
 */
static int listed_column(const number_table *table, const char *name, int k)
{
    for (size_t i = 0; table->column_name && i < table->columns; i++)
        if (number_table_is_named(table->column_name[i], name))
            return (int)i;
    return table->column_name || k >= (int)table->columns ? -1 : k;
}

/*
 * Find the columns of a table that hold a function, from the list of columns in the scene file: the
 * coordinates, then the value. Returns 0, or -1 after writing an error message about the scene
 * file.
 */
static int take_listed(reader *reader, const function_text *text, const number_table *table,
                       function_columns *columns)
{
    int k = 0;
    for (int i = reader->t->node[text->columns].first; i; i = reader->t->node[i].next, k++) {
        if (require_kind(reader, i, TREE_SCALAR) != 0)
            return -1;
        const int axis = scene_file_axis(node_text(reader, i));
        const int column = listed_column(table, node_text(reader, i), k);
        const int is_last = !reader->t->node[i].next;
        if (column < 0)
            return tree_fault(reader->t, i, "%.80s has no column '%.60s'; it has %d columns",
                              node_text(reader, text->file), node_text(reader, i),
                              (int)table->columns);
        if (axis < 0 && !is_last)
            return tree_fault(reader->t, i,
                              "'%.60s' is no coordinate; write x, y, z, theta1 or theta2, and the "
                              "value last",
                              node_text(reader, i));
        if (is_last) {
            columns->value = column;
            continue;
        }
        if (columns->axes == 3)
            return tree_fault(reader->t, i, "more than three coordinates; leave one out");
        columns->axis[columns->axes] = axis;
        columns->column[columns->axes++] = column;
    }
    return 0;
}

/*
 * Find the columns of a table that hold a function, from the names of the columns: coordinates by
 * their names, and one other column for the value. Returns 0, or -1 after writing an error message
 * about the scene file.
 */
static int take_named(reader *reader, const function_text *text, const number_table *table,
                      function_columns *columns)
{
    int values = 0;
    for (int i = 0; i < (int)table->columns; i++) {
        const int axis = table->column_name ? scene_file_axis(table->column_name[i]) : -1;
        if (axis >= 0 && columns->axes < 3) {
            columns->axis[columns->axes] = axis;
            columns->column[columns->axes++] = i;
        } else {
            columns->value = i;
            values++;
        }
    }
    if (text->value) {
        columns->value = number_table_column(table, node_text(reader, text->value));
        if (columns->value < 0)
            return tree_fault(reader->t, text->value, "%.80s has no column '%.60s'",
                              node_text(reader, text->file), node_text(reader, text->value));
        return 0;
    }
    if (values == 1)
        return 0;
    return tree_fault(reader->t, text->file,
                      "%.80s has %d columns of values; write columns: [x, y, value], in the order "
                      "of its columns",
                      node_text(reader, text->file), values);
}

/*
 * Convert the values of a column of a file to the units of the scene, if the head of the column
 * names a unit, such as "u3 [um]": multiply the scale of these values by the conversion factor.
 *   node  in      YAML node of the key that the values belong to
 *   text  in/out  in: scale as the scene file states it; out: scale to the units of the scene
 * Returns 0, or -1 after an error message about the scene file: the unit has another dimension than
 * the key, or unit and `scale` both convert the numbers.
 */
static int convert_values(reader *reader, int node, const number_table *table, int column,
                          function_text *text)
{
    double factor;
    if (!table->column_name)
        return 0;
    const char *name = table->column_name[column];
    const int found = scene_units_column(reader, node, reader->of, name, &factor);
    if (found > 0 && factor != 1 && fabs(text->scale) != 1)
        return tree_fault(reader->t, node,
                          "the column '%.60s' of the file has a unit, and scale: %g converts its "
                          "numbers again; remove one of the two",
                          name, text->scale);
    text->scale *= factor;
    return found < 0 ? -1 : 0;
}

/*
 * Copy the coordinates and values of a function from a table.
 *   point  [rows][axes] out  coordinates of each point
 *   value  [rows]       out  value at each point
 * Returns 0, or -1 after writing an error message about the scene file if an entry is not finite.
 */
static int copy_columns(reader *reader, const function_text *text, const number_table *table,
                        const function_columns *columns, double *point, double *value)
{
    for (size_t i = 0; i < table->rows; i++) {
        const double *row = table->value + i * table->columns;
        for (int axis = 0; axis < columns->axes; axis++) {
            if (check_finite(reader, text->file, table, i, (size_t)columns->column[axis]) != 0)
                return -1;
            point[i * (size_t)columns->axes + (size_t)axis] = row[columns->column[axis]];
        }
        if (check_finite(reader, text->file, table, i, (size_t)columns->value) != 0)
            return -1;
        value[i] = text->scale * row[columns->value];
    }
    return 0;
}

/*
 * Make one column of an image or array: its numbers row by row. An image is a table without names
 * that comes from a binary file and has more columns than a list of points.
 */
static void take_image(const function_text *text, number_table *table)
{
    enum { POINT_COLUMNS = 4 }; /* x, y and z of a point, and a value there */
    if (table->line || table->column_name || text->value || text->columns ||
        table->columns <= POINT_COLUMNS)
        return;
    table->rows *= table->columns;
    table->columns = 1;
}

static int make_function(reader *reader, int node, function_text *text, const number_table *table,
                         expr **function)
{
    function_columns columns;
    char name[SCENE_NAME + 32];
    memset(&columns, 0, sizeof columns);
    if ((text->columns ? take_listed : take_named)(reader, text, table, &columns) != 0 ||
        convert_values(reader, node, table, columns.value, text) != 0)
        return -1;
    double *point = calloc(table->rows * 3 + 1, sizeof *point);
    double *value = calloc(table->rows + 1, sizeof *value);
    int failed = !point || !value ? tree_fault(reader->t, text->file, "out of memory")
                                  : copy_columns(reader, text, table, &columns, point, value);
    snprintf(name, sizeof name, "%.60s, %lu values", node_text(reader, text->file),
             (unsigned long)table->rows);
    if (failed == 0) {
        *function = columns.axes > 0 ? expr_from_points(name, columns.axes, columns.axis,
                                                        table->rows, point, value)
                                     : expr_from_list(name, table->rows, value);
        failed = *function ? 0 : tree_fault(reader->t, text->file, "out of memory");
    }
    free(point);
    free(value);
    return failed;
}

#define FILE_ROW                                                                                   \
    {                                                                                              \
        "file", read_scalar_node, offsetof(function_text, file), NULL, 1, OF_NOTHING, &label_form, \
            "File of the numbers, beside the scene file; of an image (FITS, .npy) its pixels row " \
            "by row."                                                                              \
    }
#define COLUMN_ROWS                                                                                \
    {"column",                                                                                     \
     read_scalar_node,                                                                             \
     offsetof(function_text, value),                                                               \
     NULL,                                                                                         \
     0,                                                                                            \
     OF_NOTHING,                                                                                   \
     &label_form,                                                                                  \
     "Name or number from 1 of the column of the values."},                                        \
    {                                                                                              \
        "scale", read_real, offsetof(function_text, scale), NULL, 0, OF_NUMBER, NULL,              \
            "Factor of the values of the file; default 1."                                         \
    }

static const field function_fields[] = {
    FILE_ROW,
    {"columns", read_list_node, offsetof(function_text, columns), .form = &labels_form,
     .help = "Meaning of the columns in their order: coordinates, and the value last, as [x, y, "
             "value]."},
    COLUMN_ROWS,
    {.key = NULL}};
static const form function_file_form = {.type = FORM_MAP, .fields = function_fields};

static const field list_fields[] = {FILE_ROW, COLUMN_ROWS, {.key = NULL}};
const form list_file_form = {.type = FORM_MAP, .fields = list_fields};

const form list_form = {.type = FORM_LIST, .item = &number_form};
static const form *const row_functions[] = {&formula_form, &list_form, &function_file_form, NULL};
const form row_function_form = {.type = FORM_ANY, .any = row_functions};
static const form *const place_functions[] = {&formula_form, &function_file_form, NULL};
const form place_function_form = {.type = FORM_ANY, .any = place_functions};
static const form *const lists[] = {&list_form, &list_file_form, NULL};
const form numbers_form = {.type = FORM_ANY, .any = lists};

static int read_function_file(reader *reader, int node, expr **function)
{
    function_text text = {0, 0, 0, 1};
    number_table table;
    if (read_map(reader, node, function_fields, &text) != 0 ||
        scene_table_read(reader, text.file, &table) != 0)
        return -1;
    take_image(&text, &table);
    const int failed = make_function(reader, node, &text, &table, function);
    number_table_free(&table);
    return failed;
}

int read_row_function(reader *reader, int node, void *to, const void *rule)
{
    scene_numbers list = {0, NULL};
    expr **function = to;
    char name[40];
    if (reader->t->node[node].kind == TREE_MAP)
        return read_function_file(reader, node, function);
    if (reader->t->node[node].kind != TREE_LIST)
        return read_expr(reader, node, to, rule);
    if (scene_numbers_read(reader, node, &list) != 0)
        return -1;
    snprintf(name, sizeof name, "list of %d values", list.count);
    *function = expr_from_list(name, (size_t)list.count, list.value);
    free(list.value);
    return *function ? 0 : tree_fault(reader->t, node, "out of memory");
}

int read_place_function(reader *reader, int node, void *to, const void *rule)
{
    expr **function = to;
    if (reader->t->node[node].kind != TREE_MAP)
        return read_expr(reader, node, to, rule);
    if (read_function_file(reader, node, function) != 0)
        return -1;
    if (expr_rows(*function) < 0)
        return 0;
    return tree_fault(reader->t, node,
                      "the table has no coordinates; write columns: [x, y, value], or name its "
                      "columns in its first line");
}

/* ---- lists ------------------------------------------------------------ */

static int read_list(reader *reader, int node, scene_numbers *numbers)
{
    numbers->value = new_items(reader, node, TREE_LIST, sizeof *numbers->value, &numbers->count);
    if (!numbers->value)
        return -1;
    int k = 0;
    for (int i = reader->t->node[node].first; i; i = reader->t->node[i].next)
        if (read_real(reader, i, &numbers->value[k++], NULL) != 0)
            return -1;
    return 0;
}

/*
 * Copy a list of numbers from a column of a table, or from its only row. Returns 0, or -1 after
 * writing an error message about the scene file.
 */
static int copy_list(reader *reader, int node, function_text *text, const number_table *table,
                     scene_numbers *numbers)
{
    const int is_row = table->rows == 1 && table->columns > 1 && !text->value;
    const int column = text->value ? number_table_column(table, node_text(reader, text->value)) : 0;
    if (column < 0 || (!text->value && !is_row && table->columns > 1))
        return tree_fault(reader->t, text->value ? text->value : text->file,
                          "%.80s has %d columns; write column: its name or its number from 1",
                          node_text(reader, text->file), (int)table->columns);
    if (!is_row && convert_values(reader, node, table, column, text) != 0)
        return -1;
    numbers->count = is_row ? (int)table->columns : (int)table->rows;
    numbers->value = calloc((size_t)numbers->count + 1, sizeof *numbers->value);
    if (!numbers->value)
        return tree_fault(reader->t, text->file, "out of memory");
    for (size_t i = 0; i < (size_t)numbers->count; i++) {
        const size_t row = is_row ? 0 : i;
        const size_t from = is_row ? i : (size_t)column;
        if (check_finite(reader, text->file, table, row, from) != 0)
            return -1;
        numbers->value[i] = text->scale * table->value[row * table->columns + from];
    }
    return 0;
}

int scene_numbers_read(reader *reader, int node, scene_numbers *numbers)
{
    function_text text = {0, 0, 0, 1};
    number_table table;
    int failed;
    memset(numbers, 0, sizeof *numbers);
    if (reader->t->node[node].kind == TREE_MAP) {
        if (read_map(reader, node, list_fields, &text) != 0 ||
            scene_table_read(reader, text.file, &table) != 0)
            return -1;
        take_image(&text, &table);
        failed = copy_list(reader, node, &text, &table, numbers);
        number_table_free(&table);
    } else {
        failed = read_list(reader, node, numbers);
    }
    if (failed) {
        free(numbers->value);
        memset(numbers, 0, sizeof *numbers);
    }
    return failed;
}
