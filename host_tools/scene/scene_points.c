/* SPDX-License-Identifier: BSD-2-Clause */
/* Reading of points in space for a scene (scene_points.h). */
#include "scene_points.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/*
 * YAML nodes of the keys of a mapping that names a file of points in space; 0 for a key that is
 * absent.
 */
typedef struct points_text {
    int file, columns;
} points_text;

/*
 * Record that column k of a file of points in space holds coordinate number `axis` (0, 1, 2 for x,
 * y, z; others are ignored). Returns 0, or -1 after writing an error message about the scene file
 * if an earlier column holds the same coordinate.
 *   column [3] in/out  index of the column of x, y and z, or -1
 */
static int take_column(reader *reader, int node, int axis, int k, int column[SCENE_AXES])
{
    if (axis < 0 || axis >= SCENE_AXES)
        return 0;
    if (column[axis] >= 0)
        return tree_fault(reader->t, node,
                          "columns %d and %d of the points are both named %c; rename one of them",
                          column[axis] + 1, k + 1, 'x' + axis);
    column[axis] = k;
    return 0;
}

/*
 * Find the columns of the coordinates x, y and z in a file of points.
 *   column [3] out  index of the column of each coordinate, or -1 where the file has none
 * Returns 0, or -1 after writing an error message about the scene file if no column holds a
 * coordinate.
 */
static int find_columns(reader *reader, const points_text *text, const number_table *table,
                        int column[SCENE_AXES])
{
    int k = 0, found = 0;
    for (int axis = 0; axis < SCENE_AXES; axis++)
        column[axis] = -1;
    for (int i = text->columns ? reader->t->node[text->columns].first : 0; i;
         i = reader->t->node[i].next, k++) {
        if (require_kind(reader, i, TREE_SCALAR) != 0)
            return -1;
        const int axis = scene_file_axis(node_text(reader, i));
        if (k == (int)table->columns)
            return tree_fault(reader->t, i, "'columns' names more columns than the %d of %.80s", k,
                              node_text(reader, text->file));
        if (take_column(reader, i, axis, k, column) != 0)
            return -1;
    }
    for (k = 0; k < (int)table->columns && !text->columns; k++) {
        const int axis = table->column_name ? scene_file_axis(table->column_name[k]) : k;
        if (take_column(reader, text->file, axis, k, column) != 0)
            return -1;
    }
    for (int axis = 0; axis < SCENE_AXES; axis++)
        found += column[axis] >= 0;
    if (found > 0)
        return 0;
    return tree_fault(reader->t, text->file,
                      "%.80s has no columns x, y, z; write columns: [x, y], in the order of the "
                      "file",
                      node_text(reader, text->file));
}

/*
 * Read a YAML list of points [[x, y], ...] in space into a table with the columns x, y and z;
 * coordinates that are not given are 0.
 */
static int list_points(reader *reader, int list, number_table *table)
{
    const tree_node *node = reader->t->node;
    size_t k = 0;
    table->rows = (size_t)node[list].count;
    table->columns = SCENE_AXES;
    table->value = calloc(table->rows * SCENE_AXES + 1, sizeof *table->value);
    if (!table->value)
        return tree_fault(reader->t, list, "out of memory");
    for (int i = node[list].first; i; i = node[i].next, k++) {
        size_t axis = 0;
        if (require_kind(reader, i, TREE_LIST) != 0)
            return -1;
        if (node[i].count < 1 || node[i].count > SCENE_AXES)
            return tree_fault(reader->t, i, "a point has 1 to 3 coordinates, not %d; write [x, y]",
                              node[i].count);
        for (int j = node[i].first; j; j = node[j].next)
            if (read_real(reader, j, &table->value[k * SCENE_AXES + axis++], NULL) != 0)
                return -1;
    }
    return 0;
}

static const field file_fields[] = {
    {"file", read_node, offsetof(points_text, file), .required = 1, .form = &label_form,
     .help = "File with a row of coordinates for each point, beside the scene file."},
    {"columns", read_node, offsetof(points_text, columns), .form = &labels_form,
     .help = "Meaning of the columns in their order, as [x, y]; default the names in the file."},
    {.key = NULL}};

static const form file_form = {.type = FORM_MAP, .fields = file_fields};
static const form point_form_of_list = {
    .type = FORM_LIST, .item = &number_form, .least = 1, .most = SCENE_AXES};
static const form points_form = {.type = FORM_LIST, .item = &point_form_of_list, .least = 1};
static const form *const forms[] = {&points_form, &file_form, NULL};
const form scene_points_form = {.type = FORM_ANY, .any = forms};

int scene_points_table(reader *reader, int node, number_table *table, int column[SCENE_AXES])
{
    points_text text = {0, 0};
    memset(table, 0, sizeof *table);
    for (int axis = 0; axis < SCENE_AXES; axis++)
        column[axis] = axis;
    if (reader->t->node[node].kind == TREE_LIST)
        return list_points(reader, node, table);
    if (read_map(reader, node, file_fields, &text) != 0 ||
        (text.columns && require_kind(reader, text.columns, TREE_LIST) != 0))
        return -1;
    return scene_table_read(reader, text.file, table) != 0
               ? -1
               : find_columns(reader, &text, table, column);
}

/* ---- surface fitted to points ------------------------------------------- */

/*
 * Copy the rows of a table of points as coordinates x, y and z. Returns the number of points, or 0
 * after writing an error message about the scene file.
 */
static size_t copy_points(reader *reader, int node, const number_table *table, const int column[3],
                          double (*point)[3])
{
    for (int axis = 0; axis < 3; axis++)
        if (column[axis] < 0) {
            tree_fault(reader->t, node,
                       "the file of 'points' has no column %c; name the columns: "
                       "columns: [x, y, z], in the order of the file",
                       'x' + axis);
            return 0;
        }
    for (size_t row = 0; row < table->rows; row++)
        for (int axis = 0; axis < 3; axis++) {
            char place[NUMBER_NAME];
            point[row][axis] = table->value[row * table->columns + (size_t)column[axis]];
            if (isfinite(point[row][axis]))
                continue;
            number_table_place(table, row, (size_t)column[axis], place);
            tree_fault(reader->t, node,
                       "the points of the surface have no finite value at %s; "
                       "remove the point",
                       place);
            return 0;
        }
    return table->rows;
}

/* Check that every point of a list of points has three coordinates. */
static int check_list(reader *reader, int list)
{
    if (reader->t->node[list].kind != TREE_LIST)
        return 0;
    for (int i = reader->t->node[list].first; i; i = reader->t->node[i].next)
        if (reader->t->node[i].count != SCENE_AXES)
            return tree_fault(reader->t, i,
                              "a point of a surface has three coordinates, [x, y, z]");
    return 0;
}

/*
 * Fit the height z of a surface as a function of x and y to points, which are the rows of a table.
 */
static int fit_table(reader *reader, int node, const number_table *table, const int column[3],
                     const int cells[2], bicubic *function)
{
    double(*point)[3] = calloc(table->rows + 1, sizeof *point);
    if (!point)
        return tree_fault(reader->t, node, "out of memory");
    if (table->rows == 0)
        tree_fault(reader->t, node, "the list of points is empty; write [[x, y, z], ...]");
    const size_t count = copy_points(reader, node, table, column, point);
    int status = count ? 0 : -1;
    if (count && bicubic_fit(function, count, (const double(*)[3])point, cells) < 0)
        status = tree_fault(reader->t, node,
                            "the %zu points of the surface determine no plane; give at least three "
                            "that do not lie on a line of x and y, and remove points far from all "
                            "others",
                            count);
    free(point);
    return status;
}

int scene_points_fit(reader *reader, int node, const int cells[2], bicubic *function)
{
    number_table table;
    int column[SCENE_AXES];
    if (check_list(reader, node) != 0)
        return -1;
    const int status = scene_points_table(reader, node, &table, column) == 0
                           ? fit_table(reader, node, &table, column, cells, function)
                           : -1;
    number_table_free(&table);
    return status;
}
