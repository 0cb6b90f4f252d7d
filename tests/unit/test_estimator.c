/*
 * The host's gains: as good as any linear estimate can be, honest about what the sensors do not
 * see.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../host_tools/model/electrodes.h"
#include "../../host_tools/model/estimator.h"
#include "../rigs/scene_assert.h"

/* The plate bent by its upper patches, its lower ones sensors; a pressure, a force at a corner, ten
 * readings of displacement. */
#define STRAINS                                                                                    \
    "materials.G1195.permittivity=1.5e-8;actuators.0.drives=[{patches: "                           \
    "up}];limits.voltage=[-300, 300];"                                                             \
    "sensors=[{name: s, drives: [{patches: low}]}];loads=[{face: outer, pressure: 20}, {point: "   \
    "{theta1: 0.2, theta2: 0}, z: 0.1}];"                                                          \
    "outputs=[{name: strain, voltage: s}, {name: tip, u3: middle, edge: theta1+}, {name: corner, " \
    "u3: middle, at: {theta1: 0.2, theta2: 0.2}}, "                                                \
    "{name: middle, u3: middle, at: {theta1: 0.2, theta2: 0.1}}, {name: all, u3: middle, at: "     \
    "nodes}];"

typedef struct rig {
    scene_run run;
    estimator e;
    char error[SCENE_ERROR];
} rig;

/* Returns what estimator_open returned. */
static int rig_open(rig *r, const char *changes)
{
    char all[2000];
    memset(r, 0, sizeof *r);
    snprintf(all, sizeof all, STRAINS "%s", changes);
    open_run(&r->run, "plate-50-patches", all);
    if (analysis_influence(&r->run.analysis, r->error) < 0)
        fail_msg("%s", r->error);
    return estimator_open(&r->e, &r->run.analysis, r->error);
}

static void rig_close(rig *r)
{
    estimator_close(&r->e);
    scene_run_close(&r->run);
}

/* Columns of the disturbances, apart from the estimator's own: shape [targets], readings [sensors].
 */
static double column(const rig *r, int disturbance, double *shape, double *reading)
{
    const analysis *analysis = &r->run.analysis;
    const design *design = &analysis->design;
    const size_t inputs = design->structure.input.count;
    const int input = disturbance < design->loads ? design->amplifiers + disturbance
                                                  : disturbance - design->loads;
    double *amount = calloc(inputs, sizeof *amount),
           *u = calloc((size_t)design->mesh.free_dof, sizeof *u),
           *y = calloc(design->structure.output.count, sizeof *y);
    assert_true(amount && u && y);
    amount[input] = 1;
    assert_int_equal(pzs_open_voltages(&analysis->electric, amount), PZS_OK);
    assert_int_equal(pzs_solve((pzs_model *)&r->run.analysis.model, amount, u), PZS_OK);
    pzs_observe(&design->structure, u, y);
    memcpy(shape, y, (size_t)design->targets * sizeof *shape);
    int row = 0;
    for (int i = 0; i < design->scene->estimate.readings; i++) {
        const int k = design->scene->estimate.reading[i].output;
        for (int j = 0; j < analysis_outputs(analysis, k); j++)
            reading[row++] = design->scene->output[k].type == OUTPUT_VOLTAGE
                                 ? amount[electrodes_input(design, &design->scene->output[k], j)]
                                 : y[design->named_first[k] + j];
    }
    assert_int_equal(row, r->e.sensors);
    free(amount);
    free(u);
    free(y);
    return disturbance < design->loads ? design->scene->estimate.loads : 30;
}

/* Mean square of W (y - gain times readings) over all disturbances and the noise, by the
 * definition. */
static double mean_square(const rig *r, const double *gain, double *without)
{
    const design *design = &r->run.analysis.design;
    const size_t m = (size_t)design->targets, k = (size_t)r->e.sensors;
    double *shape = calloc(m, sizeof *shape), *reading = calloc(k, sizeof *reading), sum = 0;
    assert_true(shape && reading);
    *without = 0;
    for (int j = 0; j < r->e.disturbances; j++) {
        const double sigma = column(r, j, shape, reading);
        for (size_t i = 0; i < m; i++) {
            double left = shape[i];
            for (size_t s = 0; s < k; s++)
                left -= gain[i * k + s] * reading[s];
            sum += pow(sigma * design->weight[i] * left, 2);
            *without += pow(sigma * design->weight[i] * shape[i], 2);
        }
    }
    for (int i = 0, row = 0; i < design->scene->estimate.readings; i++)
        for (int j = 0;
             j < analysis_outputs(&r->run.analysis, design->scene->estimate.reading[i].output);
             j++, row++)
            for (size_t t = 0; t < m; t++)
                sum += pow(design->weight[t] * gain[t * k + (size_t)row] *
                               design->scene->estimate.reading[i].noise,
                           2);
    free(shape);
    free(reading);
    return sum;
}

/* What is said to be missed is what the gains miss, loads, electrodes and noise together; other
 * gains miss more. */
static void test_best(void **state)
{
    double without;
    rig r;
    (void)state;
    assert_int_equal(
        rig_open(&r,
                 "estimate={readings: [{output: strain, noise: 0.5}, {output: tip, noise: 1e-5}]}"),
        0);
    const double best = mean_square(&r, r.e.gain, &without);
    assert_true(fabs(sqrt(without) / r.e.disturbed - 1) < 1e-9);
    assert_true(fabs(sqrt(best) / r.e.remaining - 1) < 1e-6);
    assert_true(r.e.worst_remaining <= r.e.remaining && r.e.remaining < 0.5 * r.e.disturbed &&
                r.e.rank > 10);
    for (int k = 0; k < r.e.sensors; k += 5)
        for (int sign = -1; sign <= 1; sign += 2) {
            const size_t at = (size_t)(60 * r.e.sensors + k);
            const double kept = r.e.gain[at];
            r.e.gain[at] += sign * 0.01 * (fabs(kept) + 1e-9);
            assert_true(mean_square(&r, r.e.gain, &without) > best);
            r.e.gain[at] = kept;
        }
    rig_close(&r);
}

/* Every target node measured almost without noise: nothing is missed, and the estimate is the
 * measurement. */
static void test_all_measured(void **state)
{
    rig r;
    (void)state;
    assert_int_equal(rig_open(&r, "estimate={readings: [{output: all, noise: 1e-12}]}"), 0);
    const design *design = &r.run.analysis.design;
    double shape[200], reading[200];
    assert_int_equal(r.e.sensors, design->targets);
    assert_true(r.e.remaining < 1e-6 * r.e.disturbed);
    for (int j = 0; j < r.e.disturbances; j++) {
        column(&r, j, shape, reading);
        double most = 0, off = 0;
        for (int i = 0; i < design->targets; i++) {
            double sum = 0;
            for (int k = 0; k < r.e.sensors; k++)
                sum += r.e.gain[i * r.e.sensors + k] * reading[k];
            most = fmax(most, fabs(shape[i]));
            off = fmax(off, fabs(sum - shape[i]));
        }
        assert_true(off < 1e-5 * most);
    }
    rig_close(&r);
}

/* A sensor on the axis of symmetry sees no twist: refused by name and place, and the worst
 * direction is a twist. */
static void test_cannot_see(void **state)
{
    rig r;
    (void)state;
    assert_int_equal(
        rig_open(&r,
                 "estimate={readings: [{output: middle, noise: 1e-6}], loads: 0, tolerance: 0.3}"),
        -1);
    if (!strstr(r.error, "--set estimate: these readings do not determine the shape: 1 sensors "
                         "distinguish 1 of 27 disturbances") ||
        !strstr(r.error, "worst direction unobserved by 100%, largest at theta1 = "))
        fail_msg("%s", r.error);
    rig_close(&r);
    assert_int_equal(
        rig_open(
            &r, "estimate={readings: [{output: middle, noise: 1e-6}], loads: 0, tolerance: 0.999}"),
        0);
    assert_true(r.e.rank == 1 && fabs(r.e.condition - 1) < 1e-12);
    for (int i = 0; i < 121; i++) /* nodes lie along theta2, eleven across: antisymmetric */
        assert_true(fabs(r.e.worst[i] + r.e.worst[i / 11 * 11 + 10 - i % 11]) < 1e-6);
    rig_close(&r);
    assert_int_equal(
        rig_open(&r, "estimate={readings: [{output: corner, noise: 1e-6}], loads: 0, voltages: 0}"),
        -1);
    assert_non_null(strstr(r.error, "nothing disturbs the shape"));
    rig_close(&r);
}

/* The library's tables carry the same numbers, and the loads' columns are those of the structure.
 */
static void test_tables(void **state)
{
    double shape[200], reading[200];
    rig r;
    (void)state;
    assert_int_equal(
        rig_open(
            &r,
            "estimate={readings: [{output: strain, noise: 0.5}, {output: corner, noise: 1e-6}]}"),
        0);
    assert_int_equal(r.e.tables.sensors, 26);
    assert_int_equal(r.e.shape_table.inputs, 2);
    assert_int_equal(pzs_feed_forward_check(&r.e.shape_table), PZS_OK);
    for (int k = 0; k < 2; k++) {
        column(&r, k, shape, reading);
        for (int i = 0; i < 121; i++)
            assert_true(fabs(r.e.shape_per_load[i * 2 + k] - shape[i]) < 1e-9 * fabs(shape[120]));
    }
    for (int j = 2; j < 27; j++) {
        column(&r, j, shape, reading);
        for (int s = 0; s < 26; s++)
            assert_true(fabs(r.e.direct[s * 25 + j - 2] - reading[s]) <
                        1e-8 * fabs(reading[j - 2] + reading[25]) + 1e-12);
    }
    pzs_control control;
    pzs_estimate estimate;
    const pzs_problem *problem = &r.run.analysis.design.problem;
    void *work = malloc(PZS_CONTROL_BYTES(problem->inputs, problem->outputs)),
         *own = malloc(PZS_ESTIMATE_BYTES(26));
    assert_int_equal(pzs_control_init(&control, problem, NULL, work,
                                      PZS_CONTROL_BYTES(problem->inputs, problem->outputs)),
                     PZS_OK);
    assert_int_equal(
        pzs_estimate_init(&estimate, &control, &r.e.tables, own, PZS_ESTIMATE_BYTES(26)), PZS_OK);
    free(work);
    free(own);
    rig_close(&r);
}

static const refusal bad_sets[] = {
    {"estimate=5", "'estimate' must be a mapping"},
    {"estimate={}", "'readings' is missing in estimate"},
    {"estimate={readings: []}", "'readings' is empty"},
    {"estimate={readings: [{output: tip, noise: 1e-6}]}",
     "there is no output 'tip'; add it to outputs"},
    {"estimate={readings: [{output: corner}]}", "'noise' is missing"},
    {"estimate={readings: [{output: corner, noise: 0}]}",
     "'noise: 0' must be above 0; no sensor is exact"},
    {"estimate={readings: [{output: corner, noise: .nan}]}", "is no number"},
    {"estimate={readings: [{output: corner, noise: 1, name: x}]}", "unknown key 'name'"},
    {"estimate={readings: [{output: corner, noise: 1}], loads: -1}",
     "'loads: -1' must not be below 0"},
    {"estimate={readings: [{output: corner, noise: 1}], voltages: -1}",
     "'voltages: -1' must not be below 0"},
    {"estimate={readings: [{output: corner, noise: 1}], tolerance: 1}",
     "'tolerance: 1' must lie between 0 and 1"},
};

/* A wrong value is refused with its place and a cure. */
static void test_bad_input(void **state)
{
    (void)state;
    assert_refused("plate-50-patches", bad_sets, sizeof bad_sets / sizeof *bad_sets);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_best),       cmocka_unit_test(test_all_measured),
        cmocka_unit_test(test_cannot_see), cmocka_unit_test(test_tables),
        cmocka_unit_test(test_bad_input),
    };
    return cmocka_run_group_tests_name("estimator", tests, NULL, NULL);
}
