/* SPDX-License-Identifier: BSD-2-Clause */
/* The command `pzs calibrate` (command_calibrate.h). */
#include "command_calibrate.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../data/number_table.h"
#include "../model/calibrate_model.h"
#include "../system/progress.h"
#include "outfile.h"

/* A calibration with its files and, where a scene is the model, what was fitted. */
typedef struct run {
    const scene *scene;
    number_table voltages, shapes;
    pokes pokes;
    calibration_model model; /* empty without a structure */
    int faults;
    wiring_fault fault[WIRING_FAULTS];
    double *acting; /* [pokes][actuators] voltages that act, with the faults of a measured model */
    calibration result;
} run;

static int complain(const char *text, const char *detail)
{
    progress_stop();
    fprintf(stderr, "pzs: %s%s\n", text, detail);
    return OPTIONS_WRONG;
}

/* ---- files ------------------------------------------------------------ */

static int read_table(number_table *table, const char *path)
{
    char error[NUMBER_ERROR], place[NUMBER_NAME];
    if (number_table_read(table, path, error) < 0)
        return complain(error, "");
    for (size_t i = 0; i < table->rows * table->columns; i++)
        if (!isfinite(table->value[i])) {
            number_table_place(table, i / table->columns, i % table->columns, place);
            snprintf(error, sizeof error, "%.60s: %s is %g", path, place, table->value[i]);
            return complain(error, "; leave this poke out of both files");
        }
    return 0;
}

static int read_pokes(run *r, const options *options)
{
    char text[160];
    if (!options->voltages || !options->shapes)
        return complain("calibrate needs --voltages FILE and --shapes FILE; see ",
                        "pzs help calibrate");
    if (read_table(&r->voltages, options->voltages) != 0 ||
        read_table(&r->shapes, options->shapes) != 0)
        return OPTIONS_WRONG;
    if (r->voltages.rows != r->shapes.rows) {
        snprintf(text, sizeof text,
                 "%lu lines of voltages and %lu of shapes; write a line for each poke in both, "
                 "with a column for each ",
                 (unsigned long)r->voltages.rows, (unsigned long)r->shapes.rows);
        return complain(text, "actuator and for each output");
    }
    r->pokes = (pokes){r->voltages.rows, r->voltages.columns, r->shapes.columns, r->voltages.value,
                       r->shapes.value};
    return 0;
}

/* Name of an actuator: that of the scene, or of the file of voltages, or a number. */
static void actuator_name(const run *r, size_t k, char name[SCENE_LABEL])
{
    if (r->scene)
        scene_amplifier_name(r->scene, (int)k, name);
    else if (r->voltages.column_name)
        snprintf(name, SCENE_LABEL, "%s", r->voltages.column_name[k]);
    else
        snprintf(name, SCENE_LABEL, "v%lu", (unsigned long)k + 1);
}

/* ---- fit -------------------------------------------------------------- */

/* Faults with a measured matrix as the model, and the fit. */
static int fit_to_matrix(run *r, char *error)
{
    const scene_influence *influence = &r->scene->influence;
    pokes acting = r->pokes;
    if ((size_t)influence->outputs != r->pokes.outputs ||
        (size_t)r->scene->amplifiers != r->pokes.actuators)
        return scene_fault(r->scene, influence->at, error,
                           "the matrix has %d outputs and %d actuators, the pokes %lu and %lu",
                           influence->outputs, r->scene->amplifiers,
                           (unsigned long)r->pokes.outputs, (unsigned long)r->pokes.actuators);
    r->acting = calloc(r->pokes.count * r->pokes.actuators + 1, sizeof *r->acting);
    r->faults = r->acting ? wiring_find(r->fault, &r->pokes, influence->matrix) : -1;
    if (r->faults < 0)
        return scene_fault(r->scene, influence->at, error, "out of memory");
    wiring_apply(r->fault, r->faults, &r->pokes, r->acting);
    acting.voltage = r->acting;
    return calibrate(&r->result, &acting, influence->matrix, error);
}

/* Material factors and faults of a structure, and the fit. */
static int fit_to_structure(run *r, char *error)
{
    pokes acting = r->pokes;
    if (calibration_model_fit(&r->model, r->scene, &r->pokes, error) < 0)
        return -1;
    r->faults = r->model.faults;
    memcpy(r->fault, r->model.fault, sizeof r->fault);
    acting.voltage = r->model.voltage;
    return calibrate(&r->result, &acting, r->model.influence, error);
}

static int fit(run *r, char *error)
{
    if (!r->scene)
        return calibrate(&r->result, &r->pokes, NULL, error);
    const int failed =
        r->scene->influence.given ? fit_to_matrix(r, error) : fit_to_structure(r, error);
    if (!failed)
        wiring_matrix(r->fault, r->faults, &r->pokes, r->result.influence, r->result.error);
    return failed;
}

/* ---- output ----------------------------------------------------------- */

static double largest_entry(const run *r)
{
    double most = 0;
    for (size_t i = 0; i < r->pokes.outputs * r->pokes.actuators; i++)
        most = fmax(most, fabs(r->result.influence[i]));
    return most;
}

static double largest_error(const run *r)
{
    double most = 0;
    for (size_t k = 0; k < r->pokes.actuators; k++)
        most = isnan(r->result.error[k]) ? (double)NAN : fmax(most, r->result.error[k]);
    return most;
}

static void fault_text(const run *r, const wiring_fault *fault, char *text, size_t room)
{
    char name[SCENE_LABEL], other[SCENE_LABEL];
    actuator_name(r, fault->actuator, name);
    actuator_name(r, fault->other, other);
    if (fault->type == WIRING_SWAPPED)
        snprintf(text, room, "cables of %s and %s are swapped", name, other);
    else
        snprintf(text, room, "%s is %s", name, fault->type == WIRING_DEAD ? "dead" : "reversed");
}

static void print_model(const run *r)
{
    for (int k = 0; k < r->model.factors; k++)
        printf("  %s of %s: %.4g of the scene's\n",
               r->model.factor[k].is_piezo ? "piezoelectric constants" : "stiffness",
               r->scene->material[r->model.factor[k].material].name, r->model.factor[k].value);
    if (r->model.factors > 0)
        printf("  the scene leaves %.3g%% of the measured shapes, with these factors%s %.3g%%\n",
               100 * r->model.before, r->faults ? " and faults" : "", 100 * r->model.after);
}

static void print_faults(const run *r)
{
    char text[2 * SCENE_LABEL + 40];
    for (int f = 0; f < r->faults; f++) {
        fault_text(r, &r->fault[f], text, sizeof text);
        printf("  fault: %s\n", text);
    }
    for (size_t k = 0; k < r->pokes.actuators && !r->scene; k++)
        if (calibration_is_dead(&r->result, &r->pokes, k)) {
            actuator_name(r, k, text);
            printf("  fault: %s is dead\n", text);
        }
}

static void print_result(const run *r, const char *path)
{
    printf("%lu pokes of %lu actuators, %lu outputs: they tell %d actuators apart\n",
           (unsigned long)r->pokes.count, (unsigned long)r->pokes.actuators,
           (unsigned long)r->pokes.outputs, r->result.rank);
    print_model(r);
    print_faults(r);
    if (isfinite(r->result.noise))
        printf("  noise of the shapes: %.3g (standard deviation)\n", r->result.noise);
    else
        puts("  noise of the shapes: not known; measure more pokes than actuators");
    printf("  largest entry %.4g", largest_entry(r));
    if (isfinite(largest_error(r)))
        printf(", largest standard error %.3g (%.3g%% of it)", largest_error(r),
               100 * largest_error(r) / largest_entry(r));
    printf("\n  the matrix leaves %.3g of the shapes (root mean square)\n", r->result.residual);
    if (path)
        printf("%s: write influence: {file: %s} in a scene\n", path, path);
}

static void print_json(const run *r)
{
    char text[2 * SCENE_LABEL + 40];
    json json = {.file = stdout};
    json_open(&json, NULL, '{');
    json_number(&json, "pokes", (double)r->pokes.count);
    json_number(&json, "actuators", (double)r->pokes.actuators);
    json_number(&json, "outputs", (double)r->pokes.outputs);
    json_number(&json, "rank", r->result.rank);
    json_number(&json, "noise", r->result.noise);
    json_number(&json, "residual", r->result.residual);
    if (r->model.factors > 0) {
        json_number(&json, "left_by_scene", r->model.before);
        json_number(&json, "left_by_fitted_scene", r->model.after);
    }
    json_open(&json, "standard_error", '{');
    for (size_t k = 0; k < r->pokes.actuators; k++) {
        actuator_name(r, k, text);
        json_number(&json, text, r->result.error[k]);
    }
    json_close(&json, '}');
    json_open(&json, "faults", '[');
    for (int f = 0; f < r->faults; f++) {
        fault_text(r, &r->fault[f], text, sizeof text);
        json_string(&json, NULL, text);
    }
    json_close(&json, ']');
    json_close(&json, '}');
}

/* Places of the outputs where the model has some, else NULL. [outputs][3] */
static double (*places(const run *r))[3]
{
    return r->scene && r->scene->influence.given ? r->scene->influence.place : r->model.place;
}

static void write_matrix(FILE *file, const run *r)
{
    char name[SCENE_LABEL];
    double(*place)[3] = places(r);
    fputs(place ? "x,y,z," : "", file);
    for (size_t k = 0; k < r->pokes.actuators; k++) {
        actuator_name(r, k, name);
        fprintf(file, "%s%s", k ? "," : "", name);
    }
    fputc('\n', file);
    for (size_t i = 0; i < r->pokes.outputs; i++) {
        for (int a = 0; a < 3 && place; a++)
            fprintf(file, "%.17g,", place[i][a]);
        for (size_t k = 0; k < r->pokes.actuators; k++)
            fprintf(file, "%.17g%c", r->result.influence[i * r->pokes.actuators + k],
                    k + 1 < r->pokes.actuators ? ',' : '\n');
    }
}

static int write_file(const run *r, const char *path)
{
    outfile f;
    if (outfile_begin(&f, path))
        return 1;
    write_matrix(f.file, r);
    return outfile_end(&f, ferror(f.file));
}

int command_calibrate(const options *options, const scene *scene)
{
    char error[SCENE_ERROR];
    run r;
    memset(&r, 0, sizeof r);
    r.scene = scene;
    int status = read_pokes(&r, options);
    progress_start();
    progress_stage("fitting the matrix");
    if (status == 0 && fit(&r, error) < 0)
        status = complain(error, "");
    progress_stop();
    if (status == 0 && options->output)
        status = write_file(&r, options->output);
    if (status == 0 && options->as_json)
        print_json(&r);
    else if (status == 0)
        print_result(&r, options->output);
    calibration_free(&r.result);
    calibration_model_free(&r.model);
    number_table_free(&r.voltages);
    number_table_free(&r.shapes);
    free(r.acting);
    return status;
}
