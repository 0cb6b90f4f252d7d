/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The command `pzs calibrate`: reads voltages and shapes, computes the influence matrix, prints and
 * writes it (command_calibrate.h).
 */
#include "command_calibrate.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../data/number_table.h"
#include "../model/calibrate_model.h"
#include "../model/poke_drift.h"
#include "../model/poke_outliers.h"
#include "../system/progress.h"
#include "calibrate_vibration.h"
#include "calibrate_hysteresis.h"
#include "outfile.h"

/*
 * Calibration: its input files, its result and, where a scene describes the actuators, the wiring
 * faults found and the fitted factors of the scene's material constants.
 */
typedef struct run {
    const scene *scene;
    number_table voltages, shapes;
    pokes pokes;
    calibration_model model; /* model of the scene with fitted factors of its material constants,
                                whose influence matrix is compared with the measured one; empty
                                without a scene, or where the scene gives a measured matrix */
    int faults;
    wiring_fault fault[WIRING_FAULTS];
    int crosstalks;
    crosstalk crosstalk[WIRING_FAULTS];
    double size;    /* how large the measured shapes are compared with those that the scene's model
                       predicts: ratio of both root mean squares; 0 without a scene */
    double *acting; /* [pokes][actuators] voltages that reach the electrodes in each poke (shape
                       measured under known voltages), with the found wiring faults taken into
                       account (V) */
    poke_outliers outliers;
    poke_drift drift;
    double *shape; /* [pokes][outputs] shapes measured under known voltages, one row for each
                      measurement, without the drift that was found */
    calibration result;
} run;

/* Size of a list of actuators in a message (bytes). */
enum { IDLE_TEXT = 160 };

static int complain(const char *text, const char *detail)
{
    progress_stop();
    fprintf(stderr, "pzs: %s%s\n", text, detail);
    return OPTIONS_WRONG;
}

/* ---- files ------------------------------------------------------------ */

static int read_table(number_table *table, const char *path, bool is_record)
{
    const char *cure = is_record ? "; a record needs every sample: cut it before or behind this "
                                   "line in both files, or interpolate"
                                 : "; leave this poke out of both files";
    char error[NUMBER_ERROR], place[NUMBER_NAME];
    if (number_table_read(table, path, error) < 0 || number_table_check(table, path, error) < 0)
        return complain(error, "");
    for (size_t i = 0; i < table->rows * table->columns; i++)
        if (!isfinite(table->value[i])) {
            number_table_place(table, i / table->columns, i % table->columns, place);
            snprintf(error, sizeof error, "%.60s: %s is %g", path, place, table->value[i]);
            return complain(error, cure);
        }
    return 0;
}

static int read_pokes(run *run, const options *options)
{
    char text[160];
    const bool is_record = options->sample_rate > 0 || options->vibration_rate > 0;
    if (!options->voltages || !options->shapes)
        return complain("calibrate needs --voltages FILE and --shapes FILE; see ",
                        "pzs help calibrate");
    if (read_table(&run->voltages, options->voltages, is_record) != 0 ||
        read_table(&run->shapes, options->shapes, is_record) != 0)
        return OPTIONS_WRONG;
    if (run->voltages.rows != run->shapes.rows) {
        snprintf(text, sizeof text,
                 "%lu lines of voltages and %lu of shapes; write a line for each poke in both, "
                 "with a column for each ",
                 (unsigned long)run->voltages.rows, (unsigned long)run->shapes.rows);
        return complain(text, "actuator and for each output");
    }
    run->pokes = (pokes){run->voltages.rows,  run->voltages.columns, run->shapes.columns,
                         run->voltages.value, run->shapes.value,     0};
    return 0;
}

/* Name of an actuator: its name in the scene file, or in the file of voltages, or its number. */
static void actuator_name(const run *run, size_t k, char name[SCENE_LABEL])
{
    if (run->scene)
        scene_amplifier_name(run->scene, (int)k, name);
    else if (run->voltages.column_name)
        snprintf(name, SCENE_LABEL, "%s", run->voltages.column_name[k]);
    else
        snprintf(name, SCENE_LABEL, "v%lu", (unsigned long)k + 1);
}

/* ---- fit -------------------------------------------------------------- */

/*
 * Evaluate measured voltages and shapes where the scene file contains an influence matrix. Find
 * wiring faults by comparing the measurement with this matrix. Then compute a new influence matrix
 * from the measurement, with the faults corrected. Returns 0, or -1 with error filled.
 */
static int fit_to_matrix(run *run, char *error)
{
    const scene_influence *influence = &run->scene->influence;
    pokes acting = run->pokes;
    if (influence->curve.given)
        return scene_fault(influence->curve.at, error,
                           "calibrate finds displacements per volt, and influence.curve makes them "
                           "those of effects; write the effects of the pokes into the file of "
                           "voltages, and name no scene");
    if ((size_t)influence->outputs != run->pokes.outputs ||
        (size_t)run->scene->amplifiers != run->pokes.actuators)
        return scene_fault(influence->at, error,
                           "the matrix has %d outputs and %d actuators, the pokes %lu and %lu; "
                           "write a column for each in both files",
                           influence->outputs, run->scene->amplifiers,
                           (unsigned long)run->pokes.outputs, (unsigned long)run->pokes.actuators);
    run->acting = calloc(run->pokes.count * run->pokes.actuators + 1, sizeof *run->acting);
    run->faults = run->acting ? wiring_find(run->fault, &run->pokes, influence->matrix) : -1;
    if (run->faults < 0)
        return scene_fault(influence->at, error, "out of memory");
    wiring_apply(run->fault, run->faults, &run->pokes, run->acting);
    acting.voltage = run->acting;
    run->size = calibration_size(&acting, influence->matrix);
    return calibrate(&run->result, &acting, influence->matrix, error);
}

/*
 * Fit factors of the structure's material constants, find wiring faults, and compute the influence
 * matrix from the measured voltages and shapes. Returns 0, or -1 with error filled.
 */
static int fit_to_structure(run *run, char *error)
{
    pokes acting = run->pokes;
    if (calibration_model_fit(&run->model, run->scene, &run->pokes, error) < 0)
        return -1;
    run->faults = run->model.faults;
    run->size = run->model.size;
    memcpy(run->fault, run->model.fault, sizeof run->fault);
    acting.voltage = run->model.voltage;
    return calibrate(&run->result, &acting, run->model.influence, error);
}

/*
 * Names of the actuators whose voltage is 0 in all pokes (shapes measured under known voltages),
 * separated by commas; as many as fit into the text. Returns their number.
 */
static size_t idle_names(const run *run, char text[IDLE_TEXT])
{
    char name[SCENE_LABEL];
    size_t count = 0;
    text[0] = '\0';
    for (size_t k = 0; k < run->pokes.actuators; k++) {
        const size_t length = strlen(text);
        if (!calibration_is_idle(&run->pokes, k))
            continue;
        actuator_name(run, k, name);
        count++;
        if (length + strlen(name) + 3 < IDLE_TEXT)
            snprintf(text + length, IDLE_TEXT - length, "%s%s", length ? ", " : "", name);
    }
    return count;
}

/*
 * Compute the influence matrix without a model, which requires that every actuator has a voltage in
 * some measurement. Returns 0, or -1 with error filled.
 */
static int fit_alone(run *run, char *error)
{
    char names[IDLE_TEXT];
    const size_t idle = idle_names(run, names);
    if (idle == 0)
        return calibrate(&run->result, &run->pokes, NULL, error);
    snprintf(error, SCENE_ERROR,
             "the voltage of %s is 0 in all %lu pokes, so that nothing is known of %s; poke these "
             "amplifiers too, leave the column out, or give a scene with a model of the structure",
             names, (unsigned long)run->pokes.count, idle > 1 ? "them" : "it");
    return -1;
}

/*
 * Find cross-talk between amplifiers in the computed influence matrix, by comparison with the
 * matrix that the model predicts for the wiring as it is, faults included. Returns 0, or -1 with
 * error filled.
 */
static int find_crosstalk(run *run, char *error)
{
    const size_t actuators = run->pokes.actuators, entries = run->pokes.outputs * actuators;
    const double *model =
        run->scene->influence.given ? run->scene->influence.matrix : run->model.influence;
    double *wired = calloc(entries + actuators + 1, sizeof *wired);
    if (!wired) {
        snprintf(error, SCENE_ERROR, "out of memory");
        return -1;
    }
    memcpy(wired, model, entries * sizeof *wired);
    wiring_matrix(run->fault, run->faults, &run->pokes, wired, wired + entries);
    run->crosstalks = crosstalk_find(run->crosstalk, &run->result, &run->pokes, wired);
    free(wired);
    return 0;
}

static int fit(run *run, char *error)
{
    if (!run->scene)
        return fit_alone(run, error);
    const int failed =
        run->scene->influence.given ? fit_to_matrix(run, error) : fit_to_structure(run, error);
    if (failed)
        return failed;
    wiring_matrix(run->fault, run->faults, &run->pokes, run->result.influence, run->result.error);
    return find_crosstalk(run, error);
}

/*
 * Estimate the drift of the measured shapes over time and subtract it from them. Returns 0, or -1
 * with error filled.
 */
static int remove_drift(run *run, char *error)
{
    run->shape = calloc(run->pokes.count * run->pokes.outputs + 1, sizeof *run->shape);
    if (!run->shape || poke_drift_remove(&run->drift, &run->pokes, run->shape) < 0) {
        snprintf(error, SCENE_ERROR, "out of memory");
        return -1;
    }
    run->pokes.shape = run->shape;
    run->pokes.trends = run->drift.drifts ? run->drift.trends : 0;
    return 0;
}

/* Find single readings that contradict all others. Returns 0, or -1 with error filled. */
static int find_outliers(run *run, char *error)
{
    if (poke_outliers_find(&run->outliers, &run->pokes) == 0)
        return 0;
    snprintf(error, SCENE_ERROR, "out of memory");
    return -1;
}

/* ---- output ----------------------------------------------------------- */

static double largest_entry(const run *run)
{
    double most = 0;
    for (size_t i = 0; i < run->pokes.outputs * run->pokes.actuators; i++)
        most = fmax(most, fabs(run->result.influence[i]));
    return most;
}

static double largest_error(const run *run)
{
    double most = 0;
    for (size_t k = 0; k < run->pokes.actuators; k++)
        most = isnan(run->result.error[k]) ? (double)NAN : fmax(most, run->result.error[k]);
    return most;
}

static void fault_text(const run *run, const wiring_fault *fault, char *text, size_t room)
{
    char name[SCENE_LABEL], other[SCENE_LABEL];
    actuator_name(run, fault->actuator, name);
    actuator_name(run, fault->other, other);
    if (fault->type == WIRING_SWAPPED)
        snprintf(text, room, "cables of %s and %s are swapped", name, other);
    else
        snprintf(text, room, "%s is %s", name, fault->type == WIRING_DEAD ? "dead" : "reversed");
}

static void crosstalk_text(const run *run, const crosstalk *crosstalk, char *text, size_t room)
{
    char name[SCENE_LABEL], other[SCENE_LABEL];
    actuator_name(run, crosstalk->actuator, name);
    actuator_name(run, crosstalk->other, other);
    snprintf(text, room, "cross-talk, %.3g of the voltage of %s acts on %s", crosstalk->part, name,
             other);
}

static void print_model(const run *run)
{
    for (int k = 0; k < run->model.factors; k++)
        printf("  %s of %s: %.4g of the scene's\n",
               run->model.factor[k].is_piezo ? "piezoelectric constants" : "stiffness",
               run->scene->material[run->model.factor[k].material].name,
               run->model.factor[k].value);
    if (run->model.factors > 0)
        printf("  the scene leaves %.3g%% of the measured shapes, with these factors%s %.3g%%\n",
               100 * run->model.before, run->faults ? " and faults" : "", 100 * run->model.after);
}

static void print_faults(const run *run)
{
    char text[2 * SCENE_LABEL + 60], idle[IDLE_TEXT];
    const size_t idles = idle_names(run, idle);
    if (idles > 0)
        printf("  not poked: %s; all voltages are 0, and %s the model's\n", idle,
               idles > 1 ? "their columns are" : "its column is");
    for (int fault = 0; fault < run->faults; fault++) {
        fault_text(run, &run->fault[fault], text, sizeof text);
        printf("  fault: %s\n", text);
    }
    for (int k = 0; k < run->crosstalks; k++) {
        crosstalk_text(run, &run->crosstalk[k], text, sizeof text);
        printf("  fault: %s (standard error %.2g)\n", text, run->crosstalk[k].error);
    }
    for (size_t k = 0; k < run->pokes.actuators && !run->scene; k++)
        if (calibration_is_dead(&run->result, &run->pokes, k)) {
            actuator_name(run, k, text);
            printf("  fault: %s is dead\n", text);
        }
}

/*
 * Text of the unit of the shapes, with a blank before it: the scene's unit of length. The text is
 * empty without a scene, where the shapes may have any unit.
 */
static const char *length_unit(const run *run)
{
    static char text[SCENE_NAME + 2];
    snprintf(text, sizeof text, " %s", run->scene ? run->scene->units.length : "");
    return run->scene && run->scene->units.length[0] ? text : "";
}

/*
 * Warn where the root mean square of the measured shapes differs too much from that of the shapes
 * that the scene's model predicts.
 */
static void print_scale(const run *run)
{
    static const double most = 30;
    if (run->size >= 1 / most && run->size <= most)
        return;
    if (run->scene && run->size > 0)
        printf(
            "warning: the measured shapes are %.3g times those of the scene; write shapes in its "
            "unit of length,%s, and compare voltages and model\n",
            run->size, length_unit(run));
}

/*
 * Warn where the shapes do not follow the voltages: they do not change, entries of the matrix have
 * large standard errors, or earlier voltages seem to act more than the present ones.
 */
static void print_unrelated(const run *run)
{
    static const double most_error = 0.3, most_memory = 1;
    const double largest = largest_entry(run), error = largest_error(run);
    const bool is_noisy = isfinite(error) && error > most_error * largest;
    const bool is_late = run->drift.has_memory && fabs(run->drift.memory) > most_memory;
    if (!(largest > 0) || is_noisy || is_late)
        puts("warning: the shapes do not follow the voltages; compare both files: the shape of a "
             "line must be that under the voltages of the same line, in the same order");
}

/* Say where an outlier stands in the file of shapes, and how far it is off. */
static void outlier_text(const run *run, const poke_outlier *outlier, char *text, size_t room)
{
    char place[NUMBER_NAME];
    number_table_place(&run->shapes, outlier->poke, outlier->output, place);
    if (outlier->is_size)
        snprintf(text, room, "%s of the shapes is %.3g times as large as every other there", place,
                 outlier->times);
    else
        snprintf(text, room,
                 "%s of the shapes is %.3g times farther from the fit than the others scatter",
                 place, outlier->times);
}

static void print_outliers(const run *run)
{
    char text[NUMBER_NAME + 120];
    const poke_outliers *outliers = &run->outliers;
    for (size_t k = 0; k < outliers->count && k < POKE_OUTLIERS; k++) {
        outlier_text(run, &outliers->outlier[k], text, sizeof text);
        printf(
            "warning: %s, and spoils the matrix; mend it, or leave this poke out of both files\n",
            text);
    }
    if (outliers->count > POKE_OUTLIERS)
        printf("warning: %lu more readings are as far off\n",
               (unsigned long)(outliers->count - POKE_OUTLIERS));
}

/* Print how a scene file can use the file to which the influence matrix was written. */
static void print_use(const run *run, const char *path)
{
    if (path && strcmp(path, "-") == 0)
        path = "FILE";
    if (path && run->scene)
        printf("%s: write influence: {file: %s} in a scene, without scale: the entries have the "
               "scene's units\n",
               path, path);
    else if (path)
        printf("%s: write influence: {file: %s} in a scene whose units.length is the unit of the "
               "shapes, without scale; else with scale: unit of the shapes over units.length\n",
               path, path);
}

/*
 * Print what the pokes (shapes measured under known voltages) tell about two errors of the
 * measurement: drift of the shapes over time, and memory, the effect of earlier voltages on a
 * shape.
 */
static void print_drift(const run *run)
{
    const poke_drift *drift = &run->drift;
    if (isfinite(drift->drift) && drift->drifts)
        printf("  drift of the shapes: %.3g%s a poke (root mean square; standard error %.2g); it "
               "and a constant offset were taken out\n",
               drift->drift, length_unit(run), drift->drift_error);
    else if (drift->drifts)
        puts("  the shapes have a constant offset, which was taken out");
    if (isfinite(drift->memory))
        printf("  hysteresis: %.3g%% of the voltages before a poke act on its shape (standard "
               "error %.2g%%)%s\n",
               100 * drift->memory, 100 * drift->memory_error,
               drift->has_memory ? "; return to 0 V between pokes, or see --hysteresis" : "");
}

static void print_result(const run *run, const char *path)
{
    printf("%lu pokes of %lu actuators, %lu outputs: they tell %d actuators apart\n",
           (unsigned long)run->pokes.count, (unsigned long)run->pokes.actuators,
           (unsigned long)run->pokes.outputs, run->result.rank);
    print_model(run);
    print_faults(run);
    if (isfinite(run->result.noise))
        printf("  noise of the shapes: %.3g%s (standard deviation)\n", run->result.noise,
               length_unit(run));
    else
        puts("  noise of the shapes: not known; measure more pokes than actuators");
    print_drift(run);
    printf("  largest entry %.4g%s per volt", largest_entry(run), length_unit(run));
    if (isfinite(largest_error(run)) && largest_entry(run) > 0)
        printf(", largest standard error %.3g (%.3g%% of it)", largest_error(run),
               100 * largest_error(run) / largest_entry(run));
    printf("\n  the matrix leaves %.3g%s of the shapes (root mean square)\n", run->result.residual,
           length_unit(run));
    print_scale(run);
    print_unrelated(run);
    print_outliers(run);
    print_use(run, path);
}

static void print_json(const run *run)
{
    char text[2 * SCENE_LABEL + NUMBER_NAME + 120];
    json json = {.file = stdout};
    json_open(&json, NULL, '{');
    json_number(&json, "pokes", (double)run->pokes.count);
    json_number(&json, "actuators", (double)run->pokes.actuators);
    json_number(&json, "outputs", (double)run->pokes.outputs);
    json_number(&json, "rank", run->result.rank);
    json_number(&json, "noise", run->result.noise);
    json_number(&json, "residual", run->result.residual);
    json_number(&json, "drift", run->drift.drift);
    json_number(&json, "drift_error", run->drift.drift_error);
    json_number(&json, "memory", run->drift.memory);
    json_number(&json, "memory_error", run->drift.memory_error);
    if (run->scene)
        json_number(&json, "shapes_over_scene", run->size);
    if (run->model.factors > 0) {
        json_number(&json, "left_by_scene", run->model.before);
        json_number(&json, "left_by_fitted_scene", run->model.after);
    }
    json_open(&json, "standard_error", '{');
    for (size_t k = 0; k < run->pokes.actuators; k++) {
        actuator_name(run, k, text);
        json_number(&json, text, run->result.error[k]);
    }
    json_close(&json, '}');
    json_open(&json, "not_poked", '[');
    for (size_t k = 0; k < run->pokes.actuators; k++) {
        actuator_name(run, k, text);
        if (calibration_is_idle(&run->pokes, k))
            json_string(&json, NULL, text);
    }
    json_close(&json, ']');
    json_open(&json, "outliers", '[');
    for (size_t k = 0; k < run->outliers.count && k < POKE_OUTLIERS; k++) {
        outlier_text(run, &run->outliers.outlier[k], text, sizeof text);
        json_string(&json, NULL, text);
    }
    json_close(&json, ']');
    json_open(&json, "faults", '[');
    for (int fault = 0; fault < run->faults; fault++) {
        fault_text(run, &run->fault[fault], text, sizeof text);
        json_string(&json, NULL, text);
    }
    for (int k = 0; k < run->crosstalks; k++) {
        crosstalk_text(run, &run->crosstalk[k], text, sizeof text);
        json_string(&json, NULL, text);
    }
    json_close(&json, ']');
    json_close(&json, '}');
}

/*
 * Coordinates [outputs][3] of the points at which the measured shapes give the displacements
 * (outputs), or NULL where the model has no coordinates.
 */
static double (*places(const run *run))[3]
{
    return run->scene && run->scene->influence.given ? run->scene->influence.place
                                                     : run->model.place;
}

/*
 * Write a table with the coordinates of the outputs, where they are known, and a column for each
 * actuator: the influence matrix, or the standard errors of its entries.
 */
static void write_table(FILE *file, const run *run, bool are_errors)
{
    char name[SCENE_LABEL];
    double(*place)[3] = places(run);
    fputs(place ? "x,y,z," : "", file);
    for (size_t k = 0; k < run->pokes.actuators; k++) {
        actuator_name(run, k, name);
        fprintf(file, "%s%s", k ? "," : "", name);
    }
    fputc('\n', file);
    for (size_t i = 0; i < run->pokes.outputs; i++) {
        for (int axis = 0; axis < 3 && place; axis++)
            fprintf(file, "%.17g,", place[i][axis]);
        for (size_t k = 0; k < run->pokes.actuators; k++) {
            const double value = are_errors
                                     ? calibration_entry_error(&run->result, &run->pokes, i, k)
                                     : run->result.influence[i * run->pokes.actuators + k];
            fprintf(file, "%.17g%c", value, k + 1 < run->pokes.actuators ? ',' : '\n');
        }
    }
}

static int write_file(const run *run, const char *path, bool are_errors)
{
    outfile output;
    if (outfile_begin(&output, path))
        return 1;
    write_table(output.file, run, are_errors);
    return outfile_end(&output, ferror(output.file));
}

/*
 * Compute the influence matrix from pokes (shapes measured under known voltages), and print and
 * write it. Returns an exit code.
 */
static int calibrate_matrix(run *run, const options *options)
{
    char error[SCENE_ERROR];
    int status = 0;
    progress_start();
    progress_stage("fitting the matrix");
    if (find_outliers(run, error) < 0 || remove_drift(run, error) < 0 || fit(run, error) < 0)
        status = complain(error, "");
    progress_stop();
    if (status == 0 && options->standard_errors && !isfinite(largest_error(run)))
        status = complain("the pokes are too few to tell noise from the matrix, so there are no "
                          "--standard-errors; measure more pokes than actuators",
                          "");
    if (status == 0 && options->output)
        status = write_file(run, options->output, false);
    if (status == 0 && options->standard_errors)
        status = write_file(run, options->standard_errors, true);
    if (status == 0 && options->as_json)
        print_json(run);
    else if (status == 0)
        print_result(run, options->output);
    return status;
}

int command_calibrate(const options *options, const scene *scene)
{
    run run;
    memset(&run, 0, sizeof run);
    run.scene = scene;
    int status = read_pokes(&run, options);
    if (status == 0 && options->sample_rate > 0)
        status = calibrate_hysteresis(options, &run.pokes);
    else if (status == 0 && options->vibration_rate > 0)
        status = calibrate_vibration(options, &run.pokes);
    else if (status == 0)
        status = calibrate_matrix(&run, options);
    calibration_free(&run.result);
    calibration_model_free(&run.model);
    number_table_free(&run.voltages);
    number_table_free(&run.shapes);
    poke_drift_free(&run.drift);
    free(run.shape);
    free(run.acting);
    return status;
}
