/* SPDX-License-Identifier: BSD-2-Clause */
/* Results of analyses and optima on standard output (print.h). */
#include "print.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/model/model.h"
#include "print_mesh_error.h"
#include "print_outlines.h"
#include "print_gains.h"
#include "print_matrix.h"
#include "print_outputs.h"
#include "print_path.h"
#include "print_reactions.h"
#include "print_springs.h"
#include "print_stress.h"
#include "print_vibration.h"
#include "../model/compact_cost.h"
#include "../model/voltages_words.h"
#include "../model/wiring_test.h"
#include "../tables/detection.h"
#include "../tables/loop_blocks.h"
#include "../text/words.h"
#include "../tables/tables.h"

/* ---- head ------------------------------------------------------------- */

static const char *precision_needed(const analysis *analysis)
{
    if (tables_allow_float(analysis))
        return "float or double";
    /*
     * Above the condition number 1e14, the stiffness matrix of the undeformed state is too close to
     * singular to be factored.
     */
    if (analysis->model.info.condition > 1e14)
        return "double; loose at rest, held by a contact or by its prescribed displacements alone";
    return analysis->is_nonlinear
               ? "the nonlinear path needs double"
               : "double recommended; in float refined, and refused (PZS_E_CONDITION) "
                 "where that does not converge";
}

/*
 * Return a text that says with which metric strains are integrated through the thickness: the exact
 * metric of the curved shell, or that of a flat plate.
 */
static const char *metric_word(const design *design)
{
    return design->mesh.formulation.metric ? "exact metric" : "flat metric";
}

/* Print how well the sensors of the scene's `estimate` section determine the shape. */
static void print_sensors(const analysis *analysis, const char *influence)
{
    char text[SCENE_ERROR];
    estimator estimator;
    if (!analysis->design.estimate.given || estimator_open(&estimator, analysis, text) < 0)
        return;
    estimator_text(&estimator, analysis, text);
    printf("  %s, %s\n", influence, text);
    estimator_close(&estimator);
}

void print_estimate_json(json *json, const estimator *estimator)
{
    json_open(json, "estimate", '{');
    json_number(json, "sensors", estimator->sensors);
    json_number(json, "rank", estimator->rank);
    json_number(json, "condition", estimator->condition);
    json_number(json, "remaining", estimator->remaining / estimator->disturbed);
    json_number(json, "worst_remaining", estimator->worst_remaining / estimator->worst_disturbed);
    json_close(json, '}');
}

static void json_sensors(json *json, const analysis *analysis)
{
    char text[SCENE_ERROR];
    estimator estimator;
    if (!analysis->design.estimate.given || estimator_open(&estimator, analysis, text) < 0)
        return;
    print_estimate_json(json, &estimator);
    estimator_close(&estimator);
}

/* Print how many nodes of a mesh file belong to no element, and the numbers of the first ones. */
static void print_loose(const quad_loose *loose)
{
    if (loose->count == 0)
        return;
    printf("  nodes of the file without elements, left out: %zu:", loose->count);
    for (size_t i = 0; i < loose->count && i < QUAD_LOOSE; i++)
        printf(" %lld", (long long)loose->label[i]);
    puts(loose->count > QUAD_LOOSE ? " ..." : "");
}

static void json_loose(json *json, const quad_loose *loose)
{
    json_open(json, "nodes_without_element", '{');
    json_number(json, "count", (double)loose->count);
    json_open(json, "first", '[');
    for (size_t i = 0; i < loose->count && i < QUAD_LOOSE; i++)
        json_number(json, NULL, (double)loose->label[i]);
    json_close(json, ']');
    json_close(json, '}');
}

/* Print the size of the mesh, the element type and the condition number of the stiffness matrix. */
static void print_structure(const analysis *analysis)
{
    const design *design = &analysis->design;
    const mesh *mesh = &analysis->design.mesh;
    if (mesh->quads)
        printf("  %d elements from %s", mesh->elements, design->quads->file);
    else
        printf("  %d x %d elements", design->mesh.line[0].elements, design->mesh.line[1].elements);
    printf(" of %d element type%s, %d nodes, %d free dof, half bandwidth %d\n", mesh->types,
           mesh->types == 1 ? "" : "s", mesh->nodes, mesh->free_dof, mesh_half_bandwidth(mesh));
    if (design->quads)
        print_loose(&design->quads->warnings.loose);
    if (mesh->quads)
        printf("  envelope of the factor: %.0f numbers, %.0f a row after renumbering\n",
               mesh_envelope(mesh), mesh_envelope(mesh) / mesh->free_dof);
    if (mesh->fitted)
        printf("  surface: %d x %d pieces through %zu points, which differ from it by %.3g %s rms "
               "and %.3g %s at most\n",
               mesh->fitted->cells[0], mesh->fitted->cells[1], mesh->fitted->points,
               mesh->fitted->rms, design->units.length, mesh->fitted->largest,
               design->units.length);
    printf("  element: %s kinematics, %s through the thickness, %d dof per node\n",
           design->mesh.formulation.cartesian ? "Cartesian" : "local", metric_word(design),
           design->mesh.formulation.dof_per_node);
    print_outlines(design);
    if (analysis->model.info.condition > 0)
        printf("  condition %.1e after scaling: %s\n", analysis->model.info.condition,
               precision_needed(analysis));
}

void print_head(const analysis *analysis, const char *influence)
{
    const design *design = &analysis->design;
    printf("%s: %s\n", design->name, design->about ? design->about : "");
    if (words_unitless(&design->units))
        puts("  units: the scene names none; any consistent ones, angles in rad");
    (analysis->source->has_structure ? print_structure : print_matrix)(analysis);
    print_sensors(analysis, influence);
}

static void json_structure(json *json, const analysis *analysis)
{
    const mesh *mesh = &analysis->design.mesh;
    json_number(json, "elements", mesh->elements);
    if (mesh->fitted) {
        json_number(json, "surface_rms", mesh->fitted->rms);
        json_number(json, "surface_largest", mesh->fitted->largest);
    }
    json_number(json, "element_types", mesh->types);
    json_number(json, "nodes", mesh->nodes);
    if (analysis->design.quads)
        json_loose(json, &analysis->design.quads->warnings.loose);
    json_number(json, "dof", mesh->free_dof);
    json_number(json, "half_bandwidth", mesh_half_bandwidth(mesh));
    json_string(json, "kinematics_of_element",
                analysis->design.mesh.formulation.cartesian ? "cartesian" : "local");
    json_string(json, "metric", analysis->design.mesh.formulation.metric ? "exact" : "flat");
    print_outlines_json(json, &analysis->design);
    json_number(json, "condition", analysis->model.info.condition);
}

static void json_head(json *json, const analysis *analysis)
{
    json_string(json, "scene", analysis->design.name);
    json_number(json, "real_bits", PZS_REAL_BITS);
    json_string(json, "unit_length", analysis->design.units.length);
    (analysis->source->has_structure ? json_structure : print_matrix_json)(json, analysis);
    plausible_json(json, &analysis->warnings);
    json_sensors(json, analysis);
}

/* ---- check ------------------------------------------------------------ */

/*
 * Compute the device memory for the constants (`pzs tables`) of one type of firmware: controller
 * alone, linear solver or nonlinear solver. The constants are written to a file that is discarded.
 * Returns 0, or -1 where the scene does not permit this type of firmware.
 */
static int image_size(const analysis *analysis, tables_image image, tables_size *size,
                      tables_memory *need)
{
    const int controlled = analysis->design.problem.inputs > 0;
    FILE *nowhere = (image == TABLES_CONTROL && !controlled) ||
                            (image != TABLES_CONTROL && !analysis->source->has_structure) ||
                            (image != TABLES_CONTROL && analysis->design.free_functions > 0) ||
                            (image == TABLES_NONLINEAR && !analysis->equilibrium.full_input)
                        ? NULL
                        : fopen("/dev/null", "w");
    if (!nowhere)
        return -1;
    const int failed = tables_write(nowhere, analysis, image, "t", size);
    *need = tables_need(analysis, image, size);
    fclose(nowhere);
    return failed;
}

/*
 * Print which electrodes the fault detector of a loop that damps vibration can find faulty, and
 * warn of the others.
 */
static void print_detection(const analysis *analysis)
{
    detection detection;
    char text[SCENE_ERROR];
    if (detection_make(&detection, analysis) && detection.is_used) {
        detection_text(&detection, &analysis->design, text);
        printf("  %s\n", text);
        detection_remarks(&detection, &analysis->design, text);
        if (*text)
            printf("  warning: fault detector: %s\n", text);
    }
    detection_close(&detection);
}

/*
 * Print heights and duration of the voltage pulses of the self-test of amplifiers, cables and
 * sensors, and warn of the amplifiers that the self-test cannot judge.
 */
static void print_selftest_plan(const analysis *analysis)
{
    estimator estimator;
    wiring_test wiring;
    char text[SCENE_ERROR];
    if (!(analysis->design.safety.amplitude > 0) || estimator_open(&estimator, analysis, text) < 0)
        return;
    const bool is_few = loop_estimates(&analysis->design);
    if (wiring_test_open(&wiring, analysis, is_few ? &estimator : NULL) && wiring.is_used) {
        wiring_test_text(&wiring, analysis, text);
        printf("  %s\n", text);
        wiring_test_remarks(&wiring, analysis, text);
        if (*text)
            printf("  warning: self-test: %s\n", text);
    }
    wiring_test_close(&wiring);
    estimator_close(&estimator);
}

void print_test_plans(const analysis *analysis)
{
    print_selftest_plan(analysis);
    print_detection(analysis);
}

/*
 * Print how the controller's tables hold a measured influence matrix with many zeros: as sparse
 * rows or as a full matrix, with the reason and the numbers.
 */
static void print_sparse(const sparse_facts *facts)
{
    const double all = (double)facts->all, entries = (double)facts->entries;
    if (facts->entries == 0 || entries > 0.5 * all)
        return;
    printf("  influence matrix: %.3g%% of its %zu entries are not zero; tables hold it as %s,\n  ",
           100 * entries / all, facts->all, facts->is_used ? "sparse rows" : "a full matrix");
    if (facts->is_used)
        printf("%.1f instead of %.1f KB of flash in float, %.3g instead of %.3g multiply-adds with "
               "it in a tick\n\n",
               ((double)facts->reals * 4 + (double)facts->bytes) / 1024,
               (double)facts->full_reals * 4 / 1024, 2 * entries, 2 * all);
    else if (facts->are_entries_read)
        puts("because a block of the loop reads single entries: fault detection, self-test or late "
             "readings\n");
    else
        printf("because sparse rows pay up to %.3g%%\n\n", 100.0 / SPARSE_PAYS);
}

/*
 * Print one row of the table of a firmware's memory (KB): tables, workspace and stack, in float and
 * in double. Returns whether the tables hold the influence matrix as sparse rows, and why.
 *   image in  part of the library in the firmware: control, linear or nonlinear model
 *   name  in  first entry of the row: name of the firmware
 */
static sparse_facts print_image(const analysis *analysis, tables_image image, const char *name)
{
    tables_size size;
    tables_memory need;
    if (image_size(analysis, image, &size, &need) != 0)
        return (sparse_facts){0};
    printf("  %-10s %11.1f %10.1f %11.1f %10.1f %11.1f %10.1f\n", name,
           (double)(size.bytes + size.reals * 4) / 1024,
           (double)(size.bytes + size.reals * 8) / 1024, (double)need.work[0] / 1024,
           (double)need.work[1] / 1024, (double)need.stack[0] / 1024, (double)need.stack[1] / 1024);
    return size.influence;
}

/*
 * Return a copy of an analysis for tables in the compact form (option --compact), which leaves out
 * what a device can compute from the nodes.
 */
static analysis compact_analysis(const analysis *from)
{
    analysis compact = *from;
    compact.is_compact = true;
    return compact;
}

/*
 * Print how much more computing time a device needs with compact tables (option --compact). Compact
 * tables leave out matrices and base vectors of the elements, which the device computes from the
 * nodes. Nothing is printed for a mesh without compact element types.
 */
static void print_compact_cost(const analysis *analysis)
{
    compact_cost cost;
    if (!analysis->source->has_structure || !compact_cost_measure(&analysis->design.mesh, &cost))
        return;
    printf(
        "  compact (pzs tables --compact): on this computer each element takes %.2f us instead of "
        "%.2f\n  for its force from strains, and %.1f us more for its matrix in an assembly\n",
        1e6 * cost.compact, 1e6 * cost.full, 1e6 * cost.matrix);
}

/*
 * Print the memory of three firmwares, with the control part, linear model or nonlinear model of
 * the library; also with compact tables (without the matrices of elements that a device computes
 * from the nodes) if they are much smaller.
 */
static void print_images(const analysis *from)
{
    const bool is_compact = tables_are_compact(from);
    const analysis compact = compact_analysis(from);
    sparse_facts influence[TABLES_IMAGES];
    printf("\n  %-10s %22s %22s %22s\n  %-10s %11s %10s %11s %10s %11s %10s\n", "image",
           "tables, flash (KB)", "workspace, RAM (KB)", "stack, at most (KB)", "", "float",
           "double", "float", "double", "float", "double");
    for (tables_image image = 0; image < TABLES_IMAGES; image++) {
        influence[image] = print_image(from, image, tables_image_name[image]);
        if (is_compact && image != TABLES_CONTROL)
            (void)print_image(&compact, image, "  compact");
    }
    puts("  RAM: with the whole control loop and all its blocks (PREFIX_LOOP_BYTES)");
    print_compact_cost(from);
    puts("");
    print_sparse(&influence[TABLES_CONTROL]);
}

void print_check(const analysis *analysis, const work_report *work)
{
    print_head(analysis, "at rest");
    print_images(analysis);
    print_work(work, &analysis->design);
    print_gains(&analysis->design);
    print_gate(work);
    print_certificate(&analysis->certificate);
    print_test_plans(analysis);
    if (work->holds)
        puts("\n  the scene is valid");
}

static void json_pair(json *json, const char *key, double in_float, double in_double)
{
    json_open(json, key, '{');
    json_number(json, "float", in_float);
    json_number(json, "double", in_double);
    json_close(json, '}');
}

/*
 * Write the memory of a firmware (tables, workspace and stack, in bytes) as a member of a JSON
 * object, under the given key. The firmware contains one part of the library: control, linear or
 * nonlinear model (`image`).
 */
static void json_image(json *json, const analysis *analysis, tables_image image, const char *key)
{
    tables_size size;
    tables_memory need;
    if (image_size(analysis, image, &size, &need) < 0)
        return;
    json_open(json, key, '{');
    json_pair(json, "flash", (double)(size.bytes + size.reals * 4),
              (double)(size.bytes + size.reals * 8));
    json_pair(json, "ram", (double)need.work[0], (double)need.work[1]);
    json_pair(json, "stack", (double)need.stack[0], (double)need.stack[1]);
    if (size.influence.entries > 0) {
        json_number(json, "influence_entries", (double)size.influence.entries);
        json_bool(json, "influence_is_sparse", size.influence.is_used);
    }
    json_close(json, '}');
}

void print_check_json(const analysis *from, const work_report *work)
{
    static const char *const compact_key[TABLES_IMAGES] = {"control_compact", "linear_compact",
                                                           "nonlinear_compact"};
    const bool is_compact = tables_are_compact(from);
    const analysis compact = compact_analysis(from);
    detection detection;
    json json = {.file = stdout};
    json_open(&json, NULL, '{');
    json_head(&json, from);
    json_open(&json, "images", '{');
    for (tables_image image = 0; image < TABLES_IMAGES; image++) {
        json_image(&json, from, image, tables_image_name[image]);
        if (is_compact && image != TABLES_CONTROL)
            json_image(&json, &compact, image, compact_key[image]);
    }
    json_close(&json, '}');
    print_work_json(work, &json);
    print_gains_json(&json, &from->design);
    print_gate_json(work, &json);
    print_certificate_json(&json, &from->certificate);
    if (detection_make(&detection, from))
        detection_json(&detection, &from->design, &json);
    detection_close(&detection);
    json_close(&json, '}');
}

/* ---- solve ------------------------------------------------------------ */

/*
 * Print the results of the contact with a rigid body: number of load steps that were shortened
 * because of the body, depth of the body between the nodes of an element, and a warning about the
 * last load step.
 */
static void print_contact(const analysis *analysis)
{
    const pzs_solver *run = &analysis->equilibrium.solver;
    const char *unit = analysis->design.units.length;
    const char *space = *unit ? " " : "";
    char where[SCENE_ERROR];
    if (!analysis->design.contact.given)
        return;
    if (run->info.shortened_steps > 0)
        printf("  contact: the body moves far for its size; %u load step%s shortened for it\n",
               run->info.shortened_steps, run->info.shortened_steps == 1 ? "" : "s");
    printf("  contact: the body is at most %.3g%s%s deep between nodes (the sag of elements)\n",
           analysis->equilibrium.contact.info.sag, space, unit);
    if (analysis->status != PZS_W_BEHIND)
        return;
    equilibrium_penetration_text(&analysis->equilibrium, analysis->status, where);
    printf("  WARNING: %s: %s\n", pzs_status_text(analysis->status), where);
}

static void print_path(const analysis *analysis)
{
    const pzs_solver *run = &analysis->equilibrium.solver;
    const char *state = run->info.negative_pivots ? "UNSTABLE" : "stable";
    printf("  %u load step%s, %u linear solves, %s (%u negative pivots)\n", run->info.load_steps,
           run->info.load_steps == 1 ? "" : "s", run->info.linear_solves, state,
           run->info.negative_pivots);
    printf("  settled to %.0e of the displacement (equilibrium.tolerance), solver residual %.1e of "
           "the load\n",
           run->settings.tolerance, run->info.residual);
    print_contact(analysis);
}

/*
 * Print a note on the discretisation error, which the error measures of the solver do not include.
 */
static void print_discretisation(void)
{
    puts("  discretisation error: not part of these figures; --error estimates it\n");
}

void print_solve(analysis *analysis, const double *displacement, const double *value,
                 const stress_field *stress)
{
    print_head(analysis, "at rest");
    if (analysis->design.kinematics == KINEMATICS_AUTO && isfinite(analysis->linear_error))
        printf("  kinematics auto: linear differs by %.3g of the displacement, tolerance %g: %s\n",
               analysis->linear_error, analysis->design.tolerance,
               analysis->is_nonlinear ? "nonlinear is needed" : "linear is enough");
    if (analysis->load_path.points > 0)
        print_load_path(analysis, &analysis->load_path);
    if (analysis->is_nonlinear)
        print_path(analysis);
    else
        printf("  linear solve: solver residual %.1e, solver error estimate %.1e in the energy "
               "norm, %d refinements\n",
               analysis->model.info.residual, analysis->model.info.error_estimate,
               analysis->model.info.refinements);
    print_discretisation();
    for (int k = 0; k < analysis->design.outputs; k++)
        print_output(analysis, k, value);
    print_reactions(analysis);
    print_springs(analysis, displacement);
    print_electrodes(analysis);
    print_bare_faces(analysis);
    print_stress(stress);
    print_mesh_error(&analysis->mesh_error);
}

static void json_path(json *json, const analysis *analysis)
{
    const pzs_solver *run = &analysis->equilibrium.solver;
    json_string(json, "status", pzs_status_text(analysis->status));
    json_number(json, "load_factor", run->info.load_factor);
    json_number(json, "load_steps", run->info.load_steps);
    json_number(json, "steps_shortened", run->info.shortened_steps);
    json_number(json, "linear_solves", run->info.linear_solves);
    json_number(json, "iterations", (double)run->info.linear_solves - run->info.load_steps);
    json_number(json, "residual", run->info.residual);
    json_number(json, "solver_residual", run->info.residual);
    json_number(json, "negative_pivots", run->info.negative_pivots);
}

/*
 * Write status, residual and number of refinement iterations of the linear solve of a structure
 * with linear kinematics as JSON.
 */
static void json_linear(json *json, const analysis *analysis)
{
    json_string(json, "status", pzs_status_text(analysis->status));
    json_number(json, "load_steps", 1);
    json_number(json, "linear_solves", 1);
    json_number(json, "iterations", analysis->model.info.refinements);
    json_number(json, "residual", analysis->model.info.residual);
    json_number(json, "solver_residual", analysis->model.info.residual);
    json_number(json, "negative_pivots", analysis->model.info.negative_pivots);
    json_number(json, "solver_error_estimate", analysis->model.info.error_estimate);
}

/*
 * Write the computation times (s) as JSON. On a nonlinear structure `solve` is the time of all load
 * steps; the stiffness matrix of the reference state is assembled and factored before these load
 * steps.
 */
static void json_seconds(json *json, const analysis *analysis)
{
    json_open(json, "seconds", '{');
    json_number(json, "assemble", analysis->seconds.assemble);
    json_number(json, "factor", analysis->seconds.factor);
    json_number(json, "solve", analysis->seconds.solve);
    json_number(json, "total",
                analysis->seconds.assemble + analysis->seconds.factor + analysis->seconds.solve);
    json_close(json, '}');
}

void print_solve_json(analysis *analysis, const double *displacement, const double *value,
                      const stress_field *stress)
{
    const design *design = &analysis->design;
    json json = {.file = stdout};
    json_open(&json, NULL, '{');
    json_head(&json, analysis);
    json_string(&json, "kinematics", analysis->is_nonlinear ? "nonlinear" : "linear");
    if (design->kinematics == KINEMATICS_AUTO)
        json_number(&json, "cost_of_linear", analysis->linear_error);
    (analysis->is_nonlinear ? json_path : json_linear)(&json, analysis);
    json_seconds(&json, analysis);
    print_outputs_json(&json, analysis, value, 0);
    print_output_places_json(&json, analysis, value, 0);
    json_open(&json, "ratios", '{');
    for (int k = 0; k < design->outputs; k++)
        if (isfinite(design->output[k].reference))
            json_number(&json, design->output[k].name,
                        analysis_output(analysis, k, 0, value) / design->output[k].reference);
    json_close(&json, '}');
    print_reactions_json(&json, analysis);
    print_springs_json(&json, analysis, displacement);
    if (design->electrodes.count > 0)
        print_electrodes_json(&json, analysis);
    print_bare_faces_json(&json, analysis);
    if (analysis->load_path.points > 0)
        print_load_path_json(&json, analysis, &analysis->load_path);
    print_stress_json(&json, stress);
    print_mesh_error_json(&json, &analysis->mesh_error);
    json_close(&json, '}');
}

/* ---- shape ------------------------------------------------------------ */

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

void print_shape(const shape_run *run)
{
    const analysis *analysis = run->analysis;
    const design *design = &analysis->design;
    print_head(analysis, "at rest");
    printf("  influence of %d amplifiers on %d target nodes, largest solver residual %.1e\n\n",
           design->amplifiers, design->targets, analysis->model.info.residual);
    const design_inputs inputs = design_inputs_of(design);
    char names[32], limit[32], largest_name[32];
    snprintf(names, sizeof names, "%ss", inputs.name);
    snprintf(limit, sizeof limit, *inputs.unit ? "limits (%.20s)" : "limits", inputs.unit);
    snprintf(largest_name, sizeof largest_name, *inputs.unit ? "largest (%.20s)" : "largest",
             inputs.unit);
    printf("  %-26s %-16s %12s %7s %12s %10s\n", names, limit, "shape error", "active",
           largest_name, "KKT");
    for (int i = 0; i < run->count; i++) {
        const voltages *result = &run->results[i];
        char limits[32];
        limit_text(result, limits);
        if (isnan(result->error))
            printf("  %-26s %-16s %12s %7d %12.2f ", result->name, limits, "no equil.",
                   result->active_limits, largest(result->voltage, design->amplifiers));
        else
            printf("  %-26s %-16s %11.3f%% %7d %12.2f ", result->name, limits, 100 * result->error,
                   result->active_limits, largest(result->voltage, design->amplifiers));
        if (isfinite(result->optimality))
            printf("%10.1e\n", result->optimality);
        else
            puts("         -");
    }
    puts("\n  regularised, then clipped: with the one parameter that leaves the smallest error, "
         "chosen knowing the answer");
    char text[VOLTAGES_TEXT];
    voltages_words(design, &run->results[1], text);
    fputs(text, stdout);
    print_reached(run);
    double *value = calloc((size_t)design->structure.output.count + 1, sizeof *value);
    if (value)
        print_reached_nodes(analysis, &run->results[1], value);
    free(value);
    print_voltages(design, &run->results[1]);
    for (int i = run->compared; i < run->count; i++)
        print_voltages(design, &run->results[i]);
    const voltages *best = &run->results[1];
    char limits[32];
    limit_text(best, limits);
    if (analysis->is_nonlinear)
        print_choice(run);
    print_modes(design, &run->modes);
    print_mesh_error(&analysis->mesh_error);
    printf("\nshape error %.3f%% of the %s with every voltage inside its limit (%s)\n",
           100 * best->error, has_loads(design) ? "wanted change of shape" : "target", limits);
    if (has_loads(design))
        puts("  wanted change of shape: target less the shape without voltages, which the loads of "
             "the scene cause");
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
    json_head(&json, analysis);
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
