/* SPDX-License-Identifier: BSD-2-Clause */
/* Results of `pzs shape` (print_shape.h). */
#include "print_shape.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/model/model.h"
#include "../model/voltages_words.h"
#include "print_head.h"
#include "print_mesh_error.h"
#include "print_modes.h"
#include "print_outputs.h"

static double largest(const double *value, int count)
{
    double most = 0;
    for (int i = 0; i < count; i++)
        most = fmax(most, fabs(value[i]));
    return most;
}

static void limit_text(const voltages *result, char text[32])
{
    if (isinf(result->limit[0]) && isinf(result->limit[1]))
        snprintf(text, 32, "none");
    else
        snprintf(text, 32, "%g .. %g", result->limit[0], result->limit[1]);
}

/* Return a voltage for printing (V): a value that would be printed as -0.00 becomes 0. */
static double rounded_volt(double voltage)
{
    return fabs(voltage) < 0.005 ? 0 : voltage;
}

/*
 * Whether the voltages of an actuator are printed as a list in the order of the amplifiers'
 * numbers: stack actuators, element sets of a mesh file, or electrodes of any outline that do not
 * form a grid.
 */
static int is_list(const design *design, const scene_actuator *actuator)
{
    if (actuator->grid[0] == 1 || actuator->grid[1] > 1)
        return 0;
    if (actuator->drives == 0)
        return 1;
    const scene_patches *patches = &design->patches[actuator->drive[0].patches];
    return patches->patch != NULL || patches->outlines != NULL;
}

/*
 * Print the voltages of a list of amplifiers (V), several on a line, which begins with the number
 * of the first amplifier in the line.
 */
static void print_list(const scene_actuator *actuator, const double *voltage)
{
    enum { ROW = 8 };
    for (int i = 0; i < actuator->grid[0]; i++) {
        if (i % ROW == 0)
            printf("    %-12s %6d ", i == 0 ? actuator->name : "", i + 1);
        printf(" %9.2f", rounded_volt(voltage[i]));
        if (i % ROW == ROW - 1 || i + 1 == actuator->grid[0])
            putchar('\n');
    }
}

/*
 * Print the voltages of an actuator in the arrangement of its grid of electrodes: surface
 * coordinate theta1 downwards, theta2 to the right.
 */
static void print_grid(const scene_actuator *actuator, const double *voltage)
{
    const int *grid = actuator->grid, is_grid = grid[0] * grid[1] > 1;
    if (is_grid) {
        printf("    %-12s theta2 ", actuator->name);
        for (int j = 0; j < grid[1]; j++)
            printf(" %9d", j + 1);
        putchar('\n');
    }
    for (int i = 0; i < grid[0]; i++) {
        if (is_grid)
            printf("    %12s %-6d ", i == 0 ? "theta1" : "", i + 1);
        else
            printf("    %-20s", actuator->name);
        for (int j = 0; j < grid[1]; j++)
            printf(" %9.2f", rounded_volt(voltage[i * grid[1] + j]));
        putchar('\n');
    }
}

/* Print the voltages of all actuators (V). */
static void print_voltages(const design *design, const voltages *result)
{
    char limits[32] = "";
    if (isfinite(result->limit[0]) || isfinite(result->limit[1]))
        limit_text(result, limits);
    printf("\n  %s%s%s, %ss:\n", result->name, *limits ? " " : "", limits,
           design_inputs_of(design).name);
    for (int k = 0; k < design->actuators; k++) {
        const scene_actuator *actuator = &design->actuator[k];
        const double *voltage = result->voltage + actuator->first;
        (is_list(design, actuator) ? print_list : print_grid)(actuator, voltage);
    }
}

/*
 * Return the cost of a firmware without the nonlinear solver on a nonlinear structure: relative
 * shape error with the voltages that are optimal for the linear model, minus that with those
 * optimal for the nonlinear model.
 */
static double cost_of_linear(const shape_run *run)
{
    return run->results[2].error - run->results[1].error;
}

static const char *image_needed(const shape_run *run)
{
    return cost_of_linear(run) <= run->analysis->design.tolerance ? "control" : "nonlinear";
}

static void print_choice(const shape_run *run)
{
    const voltages *best = &run->results[1];
    const double tolerance = run->analysis->design.tolerance;
    printf("\nnonlinear structure: optimum after %d relinearisation%s, %d linear solves\n",
           best->relinearised, best->relinearised == 1 ? "" : "s", best->linear_solves);
    printf("the linear model's voltages cost %.3f%% more error there, tolerance %g%%: the firmware "
           "%s\n",
           100 * cost_of_linear(run), 100 * tolerance,
           strcmp(image_needed(run), "control") == 0 ? "is served by the control or linear image"
                                                     : "needs the nonlinear image");
}

/* Whether the output of the scene with index k is a displacement of a single node. */
static int is_single(const analysis *analysis, int k)
{
    return analysis_output_is_row(analysis, k) && analysis_outputs(analysis, k) == 1;
}

static double reached(const analysis *analysis, int k, const voltages *result)
{
    return pzs_model_observe_row(&analysis->design.structure, result->displacement,
                                 (uint32_t)analysis->design.named_first[k]);
}

/*
 * Print a table of the displacements of single nodes that the scene file lists as outputs: one row
 * without voltages, and one row for each set of voltages that `pzs shape` has computed.
 */
static void print_reached(const shape_run *run)
{
    const analysis *analysis = run->analysis;
    const design *design = &analysis->design;
    int columns = 0;
    for (int k = 0; k < design->outputs; k++) {
        if (!is_single(analysis, k))
            continue;
        if (columns++ == 0)
            printf("\n  displacement, %-13s", design->units.length);
        printf(" %13.13s", design->output[k].name);
    }
    for (int i = -1; columns > 0 && i < run->count; i++) {
        const voltages *result = i < 0 ? &run->before : &run->results[i];
        printf("\n  %-27s", result->name);
        for (int k = 0; k < design->outputs; k++)
            if (is_single(analysis, k))
                printf(" %13.5e", reached(analysis, k, result));
    }
    if (columns > 0)
        putchar('\n');
}

/*
 * Print the displacements of the scene's outputs that have several nodes, under the optimal
 * voltages `best`. Then print the names of the outputs that only `pzs solve` computes.
 */
static void print_reached_nodes(const analysis *analysis, const voltages *best, double *value)
{
    const design *design = &analysis->design;
    int left = 0;
    pzs_observe(&analysis->design.structure, best->displacement, value);
    for (int k = 0; k < design->outputs; k++)
        if (analysis_output_is_row(analysis, k) && analysis_outputs(analysis, k) > 1) {
            printf("\n  displacement, %s, under \"%s\":\n", design->units.length, best->name);
            print_output_table(analysis, k, value);
        }
    for (int k = 0; k < design->outputs; k++)
        if (!analysis_output_is_row(analysis, k))
            printf("%s %s",
                   left++ ? "," : "\n  outputs other than displacements are printed by pzs solve:",
                   design->output[k].name);
    if (left)
        putchar('\n');
}

/* Return whether the loads of the scene change the shape at the target nodes without voltages. */
static bool has_loads(const design *design)
{
    bool is_changed = false;
    for (int i = 0; i < design->targets; i++)
        is_changed |= design->wanted[i] != design->target[i];
    return is_changed;
}

/* Print a row of the table of results: shape error, largest voltage and optimality. */
static void print_result(const voltages *result, int amplifiers)
{
    char limits[32];
    limit_text(result, limits);
    printf("  %-26s %-16s ", result->name, limits);
    if (isnan(result->error))
        printf("%12s", "no equil.");
    else
        printf("%11.3f%%", 100 * result->error);
    printf(" %7d %12.2f ", result->active_limits, largest(result->voltage, amplifiers));
    if (isfinite(result->optimality))
        printf("%10.1e\n", result->optimality);
    else
        puts("         -");
}

/* Print the table of all results. */
static void print_results(const shape_run *run)
{
    const design *design = &run->analysis->design;
    const design_inputs inputs = design_inputs_of(design);
    char names[32], limit[32], largest_name[32];
    snprintf(names, sizeof names, "%ss", inputs.name);
    snprintf(limit, sizeof limit, *inputs.unit ? "limits (%.20s)" : "limits", inputs.unit);
    snprintf(largest_name, sizeof largest_name, *inputs.unit ? "largest (%.20s)" : "largest",
             inputs.unit);
    printf("  %-26s %-16s %12s %7s %12s %10s\n", names, limit, "shape error", "active",
           largest_name, "KKT");
    for (int i = 0; i < run->count; i++)
        print_result(&run->results[i], design->amplifiers);
    puts("\n  regularised, then clipped: with the one parameter that leaves the smallest error, "
         "chosen knowing the answer");
}

/* Print the displacements of the scene's outputs under the results. */
static void print_displacements(const shape_run *run)
{
    const analysis *analysis = run->analysis;
    double *value = calloc((size_t)analysis->design.structure.output.count + 1, sizeof *value);
    print_reached(run);
    if (value)
        print_reached_nodes(analysis, &run->results[1], value);
    free(value);
}

/* Print the shape error of the optimum. */
static void print_error(const design *design, const voltages *best)
{
    char limits[32];
    limit_text(best, limits);
    printf("\nshape error %.3f%% of the %s with every voltage inside its limit (%s)\n",
           100 * best->error, has_loads(design) ? "wanted change of shape" : "target", limits);
    if (has_loads(design))
        puts("  wanted change of shape: target less the shape without voltages, which the loads of "
             "the scene cause");
}

void print_shape(const shape_run *run)
{
    const analysis *analysis = run->analysis;
    const design *design = &analysis->design;
    char text[VOLTAGES_TEXT];
    print_head(analysis, "at rest");
    printf("  influence of %d amplifiers on %d target nodes, largest solver residual %.1e\n\n",
           design->amplifiers, design->targets, analysis->model.info.residual);
    print_results(run);
    voltages_words(design, &run->results[1], text);
    fputs(text, stdout);
    print_displacements(run);
    print_voltages(design, &run->results[1]);
    for (int i = run->compared; i < run->count; i++)
        print_voltages(design, &run->results[i]);
    if (analysis->is_nonlinear)
        print_choice(run);
    print_modes(design, &run->modes);
    print_mesh_error(&analysis->mesh_error);
    print_error(design, &run->results[1]);
}

/*
 * Write the displacements that the scene file lists as outputs, under the voltages of one result,
 * as JSON.
 */
static void json_reached(json *json, const analysis *analysis, const voltages *result)
{
    double *value = calloc((size_t)analysis->design.structure.output.count + 1, sizeof *value);
    if (!value)
        return;
    pzs_observe(&analysis->design.structure, result->displacement, value);
    print_outputs_json(json, analysis, value, 1);
    print_output_places_json(json, analysis, value, 1);
    free(value);
}

static void json_voltages(json *json, const analysis *analysis, const voltages *result)
{
    const design *design = &analysis->design;
    json_numbers(json, "limits", result->limit, 2);
    json_number(json, "held", result->held);
    json_number(json, "narrower", result->narrowed);
    json_number(json, "shape_error", result->error);
    json_number(json, "shape_error_all_rows", result->error_all);
    json_number(json, "misfit_rms", result->rms);
    json_number(json, "misfit_peak_to_valley", result->valley);
    json_number(json, "fixed_rows_off", result->fixed_off);
    json_number(json, "active", result->active_limits);
    if (design->limits.rows > 0)
        json_number(json, "active_rows", result->active_rows);
    json_number(json, "iterations", result->iterations);
    json_number(json, "kkt", result->optimality);
    if (result->regularisation > 0)
        json_number(json, "regularisation", result->regularisation);
    json_number(json, "relinearised", result->relinearised);
    json_number(json, "linear_solves", result->linear_solves);
    json_open(json, "voltages", '{');
    for (int k = 0; k < result->amplifiers; k++)
        json_number(json, design->amplifier_name[k], result->voltage[k]);
    json_close(json, '}');
    json_reached(json, analysis, result);
}

/*
 * Write the results of `pzs shape` as JSON: at the top level the optimal voltages within the first
 * of the voltage limits that the user asks for, then each set of voltages that was computed.
 */
void print_shape_json(const shape_run *run)
{
    const analysis *analysis = run->analysis;
    const design *design = &analysis->design;
    json json = {.file = stdout};
    json_open(&json, NULL, '{');
    print_head_json(&json, analysis);
    json_number(&json, "amplifiers", design->amplifiers);
    json_number(&json, "targets", design->targets);
    json_number(&json, "fixed_rows", design->fixed_rows);
    json_number(&json, "target_gap", design_target_gap(design));
    json_number(&json, "free_functions", design->free_functions);
    json_string(&json, "kinematics", analysis->is_nonlinear ? "nonlinear" : "linear");
    if (analysis->is_nonlinear) {
        json_number(&json, "cost_of_linear", cost_of_linear(run));
        json_string(&json, "image", image_needed(run));
    }
    json_number(&json, "shape_error_before", run->before.error);
    json_number(&json, "clipped_error", run->results[analysis->is_nonlinear ? 3 : 2].error);
    json_number(&json, "regularised_error", run->results[analysis->is_nonlinear ? 4 : 3].error);
    json_voltages(&json, analysis, &run->results[1]);
    json_open(&json, "results", '[');
    for (int i = 0; i < run->count; i++) {
        json_open(&json, NULL, '{');
        json_string(&json, "name", run->results[i].name);
        json_voltages(&json, analysis, &run->results[i]);
        json_close(&json, '}');
    }
    json_close(&json, ']');
    if (run->modes.count > 0)
        print_modes_json(&json, design, &run->modes);
    print_mesh_error_json(&json, &analysis->mesh_error);
    json_close(&json, '}');
}
