/* SPDX-License-Identifier: BSD-2-Clause */
/* Results as named arrays in NumPy and CSV files (export.h). */
#define _POSIX_C_SOURCE 200809L
#include "export.h"
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include "../model/stress_summary.h"
#include "../text/words.h"
#include "outfile.h"

/*
 * Arrays of the results of a command that are written to files, with the memory of those that were
 * computed for this purpose.
 */
typedef struct arrays {
    named_array array[NAMED_ARRAY_MOST];
    double *owned[NAMED_ARRAY_MOST];
    size_t count, owners;
    char *path_head; /* names of the columns of the load path; NULL: no load path */
    bool is_full;    /* whether an allocation of memory has failed */
} arrays;

bool export_is_wanted(const options *options)
{
    return options->npz || options->csv_folder;
}

/* ---- arrays ----------------------------------------------------------- */

static void add_array(arrays *arrays, const char *name, const char *unit, size_t rows,
                      size_t columns, const double *value)
{
    named_array *array = &arrays->array[arrays->count];
    if (arrays->count == NAMED_ARRAY_MOST || !value || rows == 0)
        return;
    snprintf(array->name, sizeof array->name, "%s", name);
    array->unit = unit;
    array->head = NULL;
    array->rows = rows;
    array->columns = columns;
    array->value = value;
    arrays->count++;
}

/* Allocate memory for a computed array. Returns NULL where memory runs out. */
static double *allocate_array(arrays *arrays, size_t count)
{
    double *value = arrays->owners < NAMED_ARRAY_MOST ? calloc(count + 1, sizeof *value) : NULL;
    if (value)
        arrays->owned[arrays->owners++] = value;
    arrays->is_full |= !value;
    return value;
}

static void release(arrays *arrays)
{
    for (size_t k = 0; k < arrays->owners; k++)
        free(arrays->owned[k]);
    free(arrays->path_head);
}

/* ---- files ------------------------------------------------------------ */

static int write_npz(const char *path, const arrays *arrays)
{
    outfile output;
    if (outfile_begin(&output, path))
        return 1;
    return outfile_end(&output, named_array_npz(output.file, arrays->array, arrays->count));
}

static int write_folder(const char *folder, const arrays *arrays)
{
    int status = 0;
    if (mkdir(folder, 0777) != 0 && errno != EEXIST) {
        fprintf(stderr, "pzs: cannot make the folder %s: %s\n", folder, strerror(errno));
        return 1;
    }
    for (size_t k = 0; k < arrays->count && status == 0; k++) {
        char path[OUTFILE_PATH];
        outfile output;
        snprintf(path, sizeof path, "%.3800s/%s.csv", folder, arrays->array[k].name);
        status = outfile_begin(&output, path);
        if (status == 0)
            status = outfile_end(&output, named_array_csv(output.file, &arrays->array[k]));
    }
    return status;
}

/*
 * Write the result arrays of a command (struct arrays) to the files that the command-line options
 * name, and release their memory.
 */
static int write_arrays(const options *options, arrays *arrays)
{
    int status = arrays->is_full;
    if (status)
        fputs("pzs: out of memory\n", stderr);
    if (status == 0 && options->npz)
        status = write_npz(options->npz, arrays);
    if (status == 0 && options->csv_folder)
        status = write_folder(options->csv_folder, arrays);
    release(arrays);
    return status;
}

/* ---- results ---------------------------------------------------------- */

/*
 * Append the coordinates of some nodes to the arrays that are written to files.
 *   node [count] in  node numbers; NULL: all nodes
 */
static void add_places(arrays *arrays, const design *design, const char *name, const int *node,
                       size_t count)
{
    double *place = allocate_array(arrays, 3 * count);
    for (size_t i = 0; i < count && place; i++)
        memcpy(place + 3 * i, design->mesh.point[node ? (size_t)node[i] : i].position,
               3 * sizeof *place);
    add_array(arrays, name, design->units.length, count, 3, place);
}

/*
 * Append the stress and the strain at each evaluated height of each layer of each element to the
 * arrays that are written to files; NAN where the layer is absent from the element.
 */
static void add_points(arrays *arrays, const stress_field *field, const char *unit)
{
    const size_t rows = (size_t)field->elements * (size_t)field->layers * STRESS_HEIGHTS;
    double *stress = allocate_array(arrays, rows * STRESS_COMPONENTS),
           *strain = allocate_array(arrays, rows * STRESS_COMPONENTS);
    for (size_t row = 0; row < rows && !arrays->is_full; row++) {
        const int layer = (int)(row / STRESS_HEIGHTS) % field->layers;
        const int element = (int)(row / STRESS_HEIGHTS) / field->layers;
        stress_layer result;
        for (int i = 0; i < STRESS_COMPONENTS; i++)
            stress[row * STRESS_COMPONENTS + (size_t)i] =
                strain[row * STRESS_COMPONENTS + (size_t)i] = (double)NAN;
        if (!stress_is_present(field, element, layer))
            continue;
        stress_layer_of(field, element, layer, &result);
        memcpy(stress + row * STRESS_COMPONENTS, result.at[row % STRESS_HEIGHTS].stress,
               sizeof result.at[0].stress);
        memcpy(strain + row * STRESS_COMPONENTS, result.at[row % STRESS_HEIGHTS].strain,
               sizeof result.at[0].strain);
    }
    add_array(arrays, "stress", unit, rows, STRESS_COMPONENTS, stress);
    add_array(arrays, "strain", "", rows, STRESS_COMPONENTS, strain);
}

/*
 * Append the centres, stresses, strains and stress resultants of all elements to the arrays that
 * are written to files.
 */
static void add_stress(arrays *arrays, const stress_field *field, char unit[WORDS_UNIT])
{
    const scene_unit_names *units = &field->state.design->units;
    const size_t elements = (size_t)field->elements;
    double *place = allocate_array(arrays, 3 * elements),
           *resultant = allocate_array(arrays, STRESS_RESULTANTS * elements);
    for (int element = 0; element < field->elements && !arrays->is_full; element++) {
        memcpy(place + 3 * element, field->element[element].place, 3 * sizeof *place);
        stress_resultants(field, element, resultant + STRESS_RESULTANTS * element);
    }
    add_array(arrays, "element_place", units->length, elements, 3, place);
    add_array(arrays, "stress_resultant", "", elements, STRESS_RESULTANTS, resultant);
    add_points(arrays, field, words_unit(units, QUANTITY_PRESSURE, unit));
}

/*
 * Return the names of the columns of the load path: load factor, negative pivots, and the outputs
 * with their units; NULL where memory runs out.
 */
static char *path_head(const analysis *analysis)
{
    enum { COLUMN = SCENE_LABEL + WORDS_UNIT + 8 };
    const design *design = &analysis->design;
    const size_t size = COLUMN * ((size_t)design->outputs + 2);
    char *head = malloc(size), unit[WORDS_UNIT];
    size_t used = 0;
    if (head)
        used = (size_t)snprintf(head, size, "load factor,negative pivots");
    for (int k = 0; k < design->outputs && head; k++) {
        words_unit(&design->units, words_of_output(&design->output[k]), unit);
        used += (size_t)snprintf(head + used, size - used, ",%s", design->output[k].name);
        if (*unit)
            used += (size_t)snprintf(head + used, size - used, " (%s)", unit);
    }
    return head;
}

/*
 * Append the table of the load path to the arrays that are written to files: a row for each point,
 * with the load factor, the number of negative pivots, and the first value of each output.
 */
static void add_path(arrays *arrays, const analysis *analysis)
{
    const load_path *path = &analysis->load_path;
    const size_t columns = 2 + (size_t)path->outputs, points = (size_t)path->points;
    if (points == 0)
        return;
    double *table = allocate_array(arrays, points * columns);
    for (size_t i = 0; i < points && table; i++) {
        table[i * columns] = path->point[i].load_factor;
        table[i * columns + 1] = path->point[i].negative_pivots;
        memcpy(table + i * columns + 2, path->value + i * (size_t)path->outputs,
               (size_t)path->outputs * sizeof *table);
    }
    const size_t index = arrays->count;
    arrays->path_head = path_head(analysis);
    add_array(arrays, "path", "", points, columns, table);
    if (arrays->count > index)
        arrays->array[index].head = arrays->path_head;
}

/*
 * Append the values of the outputs to the arrays that are written to files.
 *   value        in  [rows of all outputs] values of the outputs that are displacements or strains
 *   output_unit  [outputs] out  units, texts to which the arrays refer until they are written
 */
static void add_outputs(arrays *arrays, const analysis *analysis, const double *value,
                        char (*output_unit)[WORDS_UNIT])
{
    const design *design = &analysis->design;
    size_t count = 0;
    for (int k = 0; k < design->outputs; k++)
        count += (size_t)analysis_outputs(analysis, k);
    double *entry = allocate_array(arrays, count);
    for (int k = 0; k < design->outputs && entry; k++) {
        const int rows = analysis_outputs(analysis, k);
        char name[NAMED_ARRAY_NAME];
        for (int i = 0; i < rows; i++)
            entry[i] = analysis_output(analysis, k, i, value);
        snprintf(name, sizeof name, "output_%d", k + 1);
        words_unit(&design->units, words_of_output(&design->output[k]), output_unit[k]);
        add_array(arrays, name, output_unit[k], (size_t)rows, 0, entry);
        entry += rows;
    }
}

int export_solve(const options *options, const analysis *analysis, const double *displacement,
                 const double *value, const stress_field *stress)
{
    const design *design = &analysis->design;
    const size_t nodes = (size_t)design->mesh.nodes;
    arrays arrays = {.count = 0};
    char unit[WORDS_UNIT];
    if (!export_is_wanted(options))
        return 0;
    double *vector = allocate_array(&arrays, 3 * nodes);
    add_places(&arrays, design, "node_place", NULL, nodes);
    if (vector)
        design_vectors(&design->mesh, displacement, vector);
    add_array(&arrays, "displacement", design->units.length, nodes, 3, vector);
    char(*output_unit)[WORDS_UNIT] = calloc((size_t)design->outputs + 1, sizeof *output_unit);
    arrays.is_full |= !output_unit;
    if (output_unit)
        add_outputs(&arrays, analysis, value, output_unit);
    add_array(&arrays, "reaction", "", (size_t)analysis->reactions.nodes, 6,
              analysis->reactions.nodes > 0 ? analysis->reactions.node[0] : NULL);
    add_path(&arrays, analysis);
    if (stress)
        add_stress(&arrays, stress, unit);
    const int status = write_arrays(options, &arrays);
    free(output_unit);
    return status;
}

/*
 * Append the voltage limits, voltages, shapes and misfits (shape minus target) of all results of
 * `pzs shape` to the arrays that are written to files, as matrices with one row for each result.
 */
static void add_results(arrays *arrays, const shape_run *run)
{
    const design *design = &run->analysis->design;
    const size_t amplifiers = (size_t)design->amplifiers, targets = (size_t)design->targets,
                 count = (size_t)run->count;
    double *lower = allocate_array(arrays, count * amplifiers),
           *upper = allocate_array(arrays, count * amplifiers),
           *voltage = allocate_array(arrays, count * amplifiers),
           *shape = allocate_array(arrays, count * targets),
           *misfit = allocate_array(arrays, count * targets),
           *error = allocate_array(arrays, count);
    if (arrays->is_full)
        return;
    for (size_t row = 0; row < count; row++) {
        const voltages *result = &run->results[row];
        memcpy(lower + row * amplifiers, result->bounds, amplifiers * sizeof *lower);
        memcpy(upper + row * amplifiers, result->bounds + amplifiers, amplifiers * sizeof *upper);
        memcpy(voltage + row * amplifiers, result->voltage, amplifiers * sizeof *voltage);
        memcpy(shape + row * targets, result->shape, targets * sizeof *shape);
        for (size_t i = 0; i < targets; i++)
            misfit[row * targets + i] = result->shape[i] - result->aligned_target[i];
        error[row] = result->error;
    }
    add_array(arrays, "lower", design->units.voltage, count, amplifiers, lower);
    add_array(arrays, "upper", design->units.voltage, count, amplifiers, upper);
    add_array(arrays, "voltage", design->units.voltage, count, amplifiers, voltage);
    add_array(arrays, "shape", design->units.length, count, targets, shape);
    add_array(arrays, "misfit", design->units.length, count, targets, misfit);
    add_array(arrays, "error", "", count, 0, error);
}

/*
 * Append the influence matrix to the arrays that are written to files.
 *   unit out  unit of the influence matrix, a text to which the array refers until it is written
 */
static void add_influence(arrays *arrays, const design *design, char unit[WORDS_UNIT])
{
    words_unit(&design->units, QUANTITY_INFLUENCE, unit);
    add_array(arrays, "influence", unit, (size_t)design->targets, (size_t)design->amplifiers,
              design->influence);
}

int export_shape(const options *options, const shape_run *run)
{
    const design *design = &run->analysis->design;
    const size_t amplifiers = (size_t)design->amplifiers, targets = (size_t)design->targets;
    char unit[WORDS_UNIT];
    arrays arrays = {.count = 0};
    if (!export_is_wanted(options))
        return 0;
    add_places(&arrays, design, "place", design->target_node, targets);
    add_array(&arrays, "weight", "", targets, 0, design->weight);
    add_array(&arrays, "target", design->units.length, targets, 0, design->target);
    add_array(&arrays, "wanted", design->units.length, targets, 0, design->wanted);
    add_influence(&arrays, design, unit);
    add_array(&arrays, "step_limit", design->units.voltage, amplifiers, 0, design->step_limit);
    add_results(&arrays, run);
    return write_arrays(options, &arrays);
}

int export_modes(const options *options, const loaded_modes *modes)
{
    const design *design = &modes->analysis.design;
    const vibration *vibration = &modes->vibration;
    const coupling *coupling = &modes->coupling;
    const size_t nodes = (size_t)design->mesh.nodes, count = (size_t)vibration->count;
    arrays arrays = {.count = 0};
    if (!export_is_wanted(options))
        return 0;
    double *shape = allocate_array(&arrays, count * 3 * nodes);
    add_places(&arrays, design, "node_place", NULL, nodes);
    for (size_t k = 0; k < count && shape; k++)
        design_vectors(&design->mesh, vibration->shape + k * (size_t)design->mesh.free_dof,
                       shape + k * 3 * nodes);
    add_array(&arrays, "frequency", "Hz", count, 0, vibration->frequency);
    add_array(&arrays, "mode_shape", "", count, 3 * nodes, shape);
    if (coupling->count > 0) {
        add_array(&arrays, "short_frequency", "Hz", count, 0, coupling->short_frequency);
        add_array(&arrays, "coupling_squared", "", count, 0, coupling->squared);
    }
    return write_arrays(options, &arrays);
}

/* ---- simulation ------------------------------------------------------- */

int export_simulation(const options *options, const simulation *simulation, const history *history)
{
    static const char *const name[HISTORY_COLUMNS] = {
        "time",   "error",      "vibration", "measurement_error",
        "active", "iterations", "status",    "missed_tick"};
    const design *design = &simulation->nominal->design;
    const size_t amplifiers = (size_t)design->amplifiers, targets = (size_t)design->targets;
    char unit[WORDS_UNIT];
    arrays arrays = {.count = 0};
    if (!export_is_wanted(options))
        return 0;
    for (size_t k = 0; k < HISTORY_COLUMNS; k++) {
        double *column = allocate_array(&arrays, history->ticks);
        for (size_t tick = 0; tick < history->ticks && column; tick++)
            column[tick] = history->row[tick * HISTORY_COLUMNS + k];
        add_array(&arrays, name[k], k == 0 ? "s" : "", history->ticks, 0, column);
    }
    add_array(&arrays, "voltage", design->units.voltage, history->ticks, amplifiers,
              history->voltage);
    add_places(&arrays, design, "place", design->target_node, targets);
    add_array(&arrays, "target", design->units.length, targets, 0, design->target);
    add_influence(&arrays, design, unit);
    add_array(&arrays, "lower", design->units.voltage, amplifiers, 0, design->lower);
    add_array(&arrays, "upper", design->units.voltage, amplifiers, 0, design->upper);
    return write_arrays(options, &arrays);
}
