/* SPDX-License-Identifier: BSD-2-Clause */
/* Results as named arrays in files (export.h). */
#define _POSIX_C_SOURCE 200809L
#include "export.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include "../report/report.h"
#include "outfile.h"

/* Arrays to be written, and the memory of those that were computed for it. */
typedef struct arrays {
    named_array array[NAMED_ARRAY_MOST];
    double *owned[NAMED_ARRAY_MOST];
    size_t count, owners;
    bool is_full; /* memory ran out */
} arrays;

bool export_is_wanted(const options *options)
{
    return options->npz || options->csv_folder;
}

/* ---- arrays ----------------------------------------------------------- */

static void add(arrays *a, const char *name, const char *unit, size_t rows, size_t columns,
                const double *value)
{
    named_array *array = &a->array[a->count];
    if (a->count == NAMED_ARRAY_MOST || !value || rows == 0)
        return;
    snprintf(array->name, sizeof array->name, "%s", name);
    array->unit = unit;
    array->rows = rows;
    array->columns = columns;
    array->value = value;
    a->count++;
}

/* Memory for a computed array, or NULL. */
static double *own(arrays *a, size_t count)
{
    double *value = a->owners < NAMED_ARRAY_MOST ? calloc(count + 1, sizeof *value) : NULL;
    if (value)
        a->owned[a->owners++] = value;
    a->is_full |= !value;
    return value;
}

static void release(arrays *a)
{
    for (size_t k = 0; k < a->owners; k++)
        free(a->owned[k]);
}

/* Unit of the influence matrix, as "um/V"; empty where the scene names none. */
static const char *influence_unit(const scene *scene, char text[2 * SCENE_NAME])
{
    text[0] = '\0';
    if (*scene->unit_length && *scene->unit_voltage)
        snprintf(text, 2 * SCENE_NAME, "%s/%s", scene->unit_length, scene->unit_voltage);
    return text;
}

/* ---- files ------------------------------------------------------------ */

static int write_npz(const char *path, const arrays *a)
{
    outfile f;
    if (outfile_begin(&f, path))
        return 1;
    return outfile_end(&f, named_array_npz(f.file, a->array, a->count));
}

static int write_folder(const char *folder, const arrays *a)
{
    int status = 0;
    if (mkdir(folder, 0777) != 0 && errno != EEXIST) {
        fprintf(stderr, "pzs: cannot make the folder %s: %s\n", folder, strerror(errno));
        return 1;
    }
    for (size_t k = 0; k < a->count && status == 0; k++) {
        char path[OUTFILE_PATH];
        outfile f;
        snprintf(path, sizeof path, "%.3800s/%s.csv", folder, a->array[k].name);
        status = outfile_begin(&f, path);
        if (status == 0)
            status = outfile_end(&f, named_array_csv(f.file, &a->array[k]));
    }
    return status;
}

/* Write the arrays as the options ask, and release their memory. */
static int write_arrays(const options *options, arrays *a)
{
    int status = a->is_full;
    if (status)
        fputs("pzs: out of memory\n", stderr);
    if (status == 0 && options->npz)
        status = write_npz(options->npz, a);
    if (status == 0 && options->csv_folder)
        status = write_folder(options->csv_folder, a);
    release(a);
    return status;
}

/* ---- results ---------------------------------------------------------- */

/* Places of some nodes. node [count] in, NULL: all nodes */
static void add_places(arrays *a, const design *design, const char *name, const int *node,
                       size_t count)
{
    double *place = own(a, 3 * count);
    for (size_t i = 0; i < count && place; i++)
        memcpy(place + 3 * i, design->mesh.point[node ? (size_t)node[i] : i].x, 3 * sizeof *place);
    add(a, name, design->scene->unit_length, count, 3, place);
}

int export_solve(const options *options, const analysis *analysis, const double *u,
                 const double *value)
{
    const design *design = &analysis->design;
    const size_t nodes = (size_t)design->mesh.nodes;
    arrays a = {.count = 0};
    if (!export_is_wanted(options))
        return 0;
    double *vector = own(&a, 3 * nodes);
    add_places(&a, design, "node_place", NULL, nodes);
    if (vector)
        report_displacement(&design->mesh, u, vector);
    add(&a, "displacement", design->scene->unit_length, nodes, 3, vector);
    for (int k = 0; k < design->scene->outputs; k++) {
        const size_t first = (size_t)design->named_first[k],
                     rows = (size_t)design->named_first[k + 1] - first;
        char name[NAMED_ARRAY_NAME];
        snprintf(name, sizeof name, "output_%d", k + 1);
        add(&a, name, design->scene->unit_length, rows, 0, value + first);
    }
    return write_arrays(options, &a);
}

/* Copy voltages, shapes and misfits of all results to matrices with a row for each result. */
static void add_results(arrays *a, const shape_run *run)
{
    const design *design = &run->analysis->design;
    const size_t n = (size_t)design->amplifiers, m = (size_t)design->targets,
                 count = (size_t)run->count;
    double *voltage = own(a, count * n), *shape = own(a, count * m), *misfit = own(a, count * m),
           *error = own(a, count);
    if (a->is_full)
        return;
    for (size_t r = 0; r < count; r++) {
        const voltages *result = &run->results[r];
        memcpy(voltage + r * n, result->voltage, n * sizeof *voltage);
        memcpy(shape + r * m, result->shape, m * sizeof *shape);
        for (size_t i = 0; i < m; i++)
            misfit[r * m + i] = result->shape[i] - result->aligned_target[i];
        error[r] = result->error;
    }
    add(a, "voltage", design->scene->unit_voltage, count, n, voltage);
    add(a, "shape", design->scene->unit_length, count, m, shape);
    add(a, "misfit", design->scene->unit_length, count, m, misfit);
    add(a, "error", "", count, 0, error);
}

int export_shape(const options *options, const shape_run *run)
{
    const design *design = &run->analysis->design;
    const scene *scene = design->scene;
    const size_t n = (size_t)design->amplifiers, m = (size_t)design->targets;
    char unit[2 * SCENE_NAME];
    arrays a = {.count = 0};
    if (!export_is_wanted(options))
        return 0;
    add_places(&a, design, "place", design->target_node, m);
    add(&a, "weight", "", m, 0, design->weight);
    add(&a, "target", scene->unit_length, m, 0, design->target);
    add(&a, "wanted", scene->unit_length, m, 0, design->wanted);
    add(&a, "influence", influence_unit(scene, unit), m, n, design->influence);
    add(&a, "lower", scene->unit_voltage, n, 0, design->lower);
    add(&a, "upper", scene->unit_voltage, n, 0, design->upper);
    add(&a, "step_limit", scene->unit_voltage, n, 0, design->step_limit);
    add_results(&a, run);
    return write_arrays(options, &a);
}

int export_modes(const options *options, const design *design, const vibration *vibration)
{
    const size_t nodes = (size_t)design->mesh.nodes, count = (size_t)vibration->count;
    arrays a = {.count = 0};
    if (!export_is_wanted(options))
        return 0;
    double *shape = own(&a, count * 3 * nodes);
    add_places(&a, design, "node_place", NULL, nodes);
    for (size_t k = 0; k < count && shape; k++)
        report_displacement(&design->mesh, vibration->shape + k * (size_t)design->mesh.free_dof,
                            shape + k * 3 * nodes);
    add(&a, "frequency", "Hz", count, 0, vibration->frequency);
    add(&a, "mode_shape", "", count, 3 * nodes, shape);
    return write_arrays(options, &a);
}

/* ---- simulation ------------------------------------------------------- */

int export_simulation(const options *options, const simulation *simulation, const history *history)
{
    static const char *const name[HISTORY_COLUMNS] = {"time",   "error",      "vibration", "missed",
                                                      "active", "iterations", "status",    "lost"};
    const design *design = &simulation->nominal->design;
    const size_t n = (size_t)design->amplifiers, m = (size_t)design->targets;
    char unit[2 * SCENE_NAME];
    arrays a = {.count = 0};
    if (!export_is_wanted(options))
        return 0;
    for (size_t k = 0; k < HISTORY_COLUMNS; k++) {
        double *column = own(&a, history->ticks);
        for (size_t t = 0; t < history->ticks && column; t++)
            column[t] = history->row[t * HISTORY_COLUMNS + k];
        add(&a, name[k], k == 0 ? "s" : "", history->ticks, 0, column);
    }
    add(&a, "voltage", design->scene->unit_voltage, history->ticks, n, history->voltage);
    add_places(&a, design, "place", design->target_node, m);
    add(&a, "target", design->scene->unit_length, m, 0, design->target);
    add(&a, "influence", influence_unit(design->scene, unit), m, n, design->influence);
    add(&a, "lower", design->scene->unit_voltage, n, 0, design->lower);
    add(&a, "upper", design->scene->unit_voltage, n, 0, design->upper);
    return write_arrays(options, &a);
}
