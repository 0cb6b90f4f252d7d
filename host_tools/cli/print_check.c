/* SPDX-License-Identifier: BSD-2-Clause */
/* Results of `pzs check` (print_check.h). */
#include "print_check.h"
#include <stdio.h>
#include "../model/compact_cost.h"
#include "../model/wiring_test.h"
#include "../tables/detection.h"
#include "../tables/loop_blocks.h"
#include "../tables/tables.h"
#include "matrix_safety.h"
#include "print_head.h"
#include "print_gains.h"
#include "print_vibration.h"

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
    print_matrix_errors(&analysis->certificate.matrix);
    print_test_plans(analysis);
    if (work->holds && !certificate_matrix_refuses(&analysis->certificate.matrix))
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
    print_head_json(&json, from);
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
    print_matrix_errors_json(&json, &from->certificate.matrix);
    if (detection_make(&detection, from))
        detection_json(&detection, &from->design, &json);
    detection_close(&detection);
    json_close(&json, '}');
}
