/*
 * Scenes with a measured influence matrix in the place of a structure: the same answers as from the
 * structure that the matrix was computed from, in every layout of the file; and files that are
 * wrong.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#define _XOPEN_SOURCE 700
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../host_tools/data/number_table.h"
#include "../../host_tools/model/mass.h"
#include "../../host_tools/model/modes.h"
#include "../../host_tools/model/vibration.h"
#include "../../host_tools/simulate/simulate_loop.h"
#include "../../host_tools/simulate/simulation.h"
#include "../../host_tools/tables/sparse_tables.h"
#include "../rigs/scene_assert.h"
#include "../rigs/test_folder.h"
#include "../rigs/uniform.h"

/* ---- the matrix of a structure, as if it were measured ----------------- */

/* How the matrix is written to its file. */
typedef struct layout {
    const char *delimiter;
    bool is_transposed, has_coordinates, has_names;
    double scale;
} layout;

static double entry(const analysis *a, int output, int actuator)
{
    return a->influence[(size_t)output * a->design.structure.input.count + (size_t)actuator];
}

static void write_names(FILE *file, const analysis *a, const layout *l)
{
    char name[SCENE_LABEL];
    if (l->has_coordinates)
        fprintf(file, "x%sy%s", l->delimiter, l->delimiter);
    for (int k = 0; k < a->design.amplifiers; k++) {
        scene_amplifier_name(a->design.scene, k, name);
        fprintf(file, "%s%s", k ? l->delimiter : "", name);
    }
    fputc('\n', file);
}

static void write_matrix(const analysis *a, const layout *l)
{
    const design *d = &a->design;
    FILE *file = write_file("matrix.csv");
    if (l->has_names)
        write_names(file, a, l);
    const int rows = l->is_transposed ? d->amplifiers : d->targets;
    const int columns = l->is_transposed ? d->targets : d->amplifiers;
    for (int i = 0; i < rows; i++) {
        if (l->has_coordinates)
            fprintf(file, "%.17g%s%.17g%s", d->mesh.point[d->target_node[i]].position[0],
                    l->delimiter, d->mesh.point[d->target_node[i]].position[1], l->delimiter);
        for (int k = 0; k < columns; k++)
            fprintf(file, "%s%.17g", k ? l->delimiter : "",
                    entry(a, l->is_transposed ? k : i, l->is_transposed ? i : k) / l->scale);
        fputc('\n', file);
    }
    assert_int_equal(fclose(file), 0);
}

static void write_points(const design *d)
{
    FILE *file = write_file("points.csv");
    for (int i = 0; i < d->targets; i++)
        fprintf(file, "%.17g %.17g\n", d->mesh.point[d->target_node[i]].position[0],
                d->mesh.point[d->target_node[i]].position[1]);
    assert_int_equal(fclose(file), 0);
}

static void open_structure(scene_run *r, const char *changes)
{
    open_run(r, "plate-50-patches", changes);
    if (analysis_influence(&r->analysis, r->error) < 0)
        fail_msg("%s", r->error);
}

static void open_measured(scene_run *r, const char *changes)
{
    open_run(r, path_of("scene.yaml"), changes);
    if (analysis_influence(&r->analysis, r->error) < 0)
        fail_msg("%s", r->error);
}

static void optimum(scene_run *r, double most, voltages *result)
{
    if (voltages_optimum(&r->analysis, within(most), result, r->error) < 0)
        fail_msg("%s", r->error);
}

/*
 * Voltages of both scenes for the same limits agree. The objective has the Hessian B'W^2 B, so
 * rounding of the weights and of the residuals is amplified by its condition, about 1e5 here.
 */
static void assert_same(scene_run *s, scene_run *m, double most)
{
    voltages a, b;
    optimum(s, most, &a);
    optimum(m, most, &b);
    assert_near("error", b.error, a.error, 1e-9);
    assert_int_equal(a.active_limits, b.active_limits);
    for (int k = 0; k < a.amplifiers; k++)
        assert_true(fabs(a.voltage[k] - b.voltage[k]) < 1e-9 * 600);
    for (int i = 0; i < s->analysis.design.targets; i++)
        assert_true(fabs(a.shape[i] - b.shape[i]) < 1e-9 * 2e-3);
    voltages_free(&a);
    voltages_free(&b);
}

#define MEASURED                                                                                   \
    "name: measured\nunits: {length: m, force: N, voltage: V, temperature: K}\n"                   \
    "influence: {file: matrix.csv%s}\nlimits: {voltage: [-600, 600]}\n"                            \
    "target: {value: '0.1*x*(y-0.1)', weight: %s, free: [%s]}\n"

/*
 * Law: the matrix of a structure, written to a file in any layout, gives the voltages, the shape
 * and the error of the structure: with equal weights, with area weights from the coordinates alone,
 * and with a free function.
 */
static void test_same_answer(void **state)
{
    (void)state;
    static const layout layouts[] = {
        {",", false, true, true, 1},
        {";", false, false, false, 1e-6},
        {" ", true, false, true, 1},
    };
    static const char *const keys[] = {
        "",
        ", scale: 1e-6, coordinates: {file: points.csv, columns: [x, y]}",
        ", rows: actuators, coordinates: {file: points.csv, columns: [x, y]}",
    };
    static const char *const weight[] = {"equal", "area", "area"}, *const frees[] = {"", "", "tip"};
    for (int k = 0; k < 3; k++) {
        scene_run s, m;
        char change[128];
        snprintf(change, sizeof change,
                 "limits={voltage: [-600, 600]};target.weight=%s;target.free=[%s]", weight[k],
                 frees[k]);
        open_structure(&s, change);
        layout l = layouts[k];
        l.has_names = l.has_names && !l.is_transposed;
        write_matrix(&s.analysis, &l);
        write_points(&s.analysis.design);
        write_text("scene.yaml", MEASURED, keys[k], weight[k], frees[k]);
        open_measured(&m, "");
        assert_int_equal(m.analysis.design.targets, s.analysis.design.targets);
        assert_same(&s, &m, 200);
        assert_same(&s, &m, 100);
        assert_same(&s, &m, HUGE_VAL);
        if (l.has_names) {
            char name[SCENE_LABEL];
            scene_amplifier_name(&m.scene, 7, name);
            assert_string_equal(name, "v_2_3");
        }
        scene_run_close(&s);
        scene_run_close(&m);
    }
}

/* Law: rows that are ignored, by number or by a mask, may hold anything and change nothing. */
static void test_ignored(void **state)
{
    (void)state;
    voltages a, b, c;
    scene_run m;
    write_text("scene.yaml",
               "name: m\ninfluence: {file: matrix.csv%s}\nlimits: {voltage: [-1, 1]}\n"
               "target: {value: [1, 2, 7, 3]}\n",
               ", ignore: [3]");
    write_text("matrix.csv", "1 0\n0 1\nnan 1e30\n1 1\n");
    open_measured(&m, "limits.voltage=[-9, 9]");
    assert_int_equal(m.scene.influence.outputs, 3);
    optimum(&m, 9, &a);
    scene_run_close(&m);
    write_text("mask.csv", "1\n1\n0\n1\n");
    open_measured(&m, "influence.ignore=[];influence.mask={file: mask.csv}");
    optimum(&m, 9, &b);
    scene_run_close(&m);
    write_text("matrix.csv", "1 0\n0 1\n1 1\n");
    open_measured(&m, "influence.ignore=[];target.value=[1, 2, 3]");
    optimum(&m, 9, &c);
    scene_run_close(&m);
    assert_near("first", a.voltage[0], 1, 4 * DBL_EPSILON);
    assert_near("second", a.voltage[1], 2, 4 * DBL_EPSILON);
    assert_memory_equal(a.voltage, b.voltage, 2 * sizeof *a.voltage);
    assert_memory_equal(a.voltage, c.voltage, 2 * sizeof *a.voltage);
    voltages_free(&a);
    voltages_free(&b);
    voltages_free(&c);
}

/* Law: a held amplifier keeps its voltage, and the others do what they can around it. */
static void test_held(void **state)
{
    (void)state;
    voltages best;
    scene_run m;
    write_text("scene.yaml", "name: m\ninfluence: {file: matrix.csv}\n"
                             "limits: {voltage: [-9, 9], each: [{actuator: v1, hold: 0.5}]}\n"
                             "target: {value: [1, 2]}\n");
    write_text("matrix.csv", "1 1\n0 1\n");
    open_measured(&m, "");
    optimum(&m, 9, &best);
    assert_true(best.voltage[0] == 0.5);
    assert_near("free", best.voltage[1], 1.25, 4 * DBL_EPSILON); /* mean of 0.5 and 2 */
    voltages_free(&best);
    scene_run_close(&m);
}

/*
 * Law: an amplifier parks at the voltage that the scene gives for its name, otherwise at the
 * allowed voltage nearest to 0; one voltage for all does not concern an amplifier that is held.
 */
static void test_park(void **state)
{
    (void)state;
    static const char *const park[] = {"{v1: -2, v3: 9}", "5", "{}"};
    static const double expected[][3] = {{-2, 3, 9}, {5, 3, 5}, {0, 3, 1}};
    write_text("matrix.csv", "1 0.2 0\n0.1 1 0\n0 0.1 1\n");
    for (int which = 0; which < 3; which++) {
        scene_run m;
        write_text("scene.yaml",
                   "name: m\ninfluence: {file: matrix.csv}\nlimits: {voltage: [-9, 9], each: "
                   "[{actuator: v2, hold: 3}, {actuator: v3, voltage: [1, 9]}]}\n"
                   "target: {value: [1, 2, 3]}\nsafety: {park: %s}\n",
                   park[which]);
        open_measured(&m, "");
        for (int k = 0; k < 3; k++)
            assert_true(m.analysis.design.park[k] == expected[which][k]);
        scene_run_close(&m);
    }
}

/* ---- tied actuators ------------------------------------------------------ */

enum { TIED_OUTPUTS = 9, TIED_ACTUATORS = 5, TIED_GROUPS = 3 };

/* Group that each actuator of the file belongs to, in the scenes of the test of tied actuators. */
static const int tied_group[TIED_ACTUATORS] = {0, 1, 0, 2, 1};

/* Write a matrix of numbers without pattern, or with the columns of each group summed. */
static void write_tied_matrix(const char *name, bool is_summed)
{
    FILE *file = write_file(name);
    uint32_t state = 1;
    fputs(is_summed ? "left,right,a4\n" : "a1,a2,a3,a4,a5\n", file);
    for (int i = 0; i < TIED_OUTPUTS; i++) {
        double sum[TIED_GROUPS] = {0, 0, 0};
        for (int k = 0; k < TIED_ACTUATORS; k++) {
            state = state * 1664525U + 1013904223U;
            const double value = (double)state / 3e9 - 0.7;
            sum[tied_group[k]] += value;
            if (!is_summed)
                fprintf(file, "%.17g%s", value, k + 1 < TIED_ACTUATORS ? "," : "\n");
        }
        if (is_summed)
            fprintf(file, "%.17g,%.17g,%.17g\n", sum[0], sum[1], sum[2]);
    }
    assert_int_equal(fclose(file), 0);
}

#define TIED_SCENE                                                                                 \
    "name: m\ncontrol: {rate: 1000}\ninfluence: {file: %s, scale: 0.3, %s modes: [{frequency: 9, " \
    "shape: [1, 2, 3, 4, 5, 6, 7, 8, 9], response: %s}]}\n"                                        \
    "limits: {voltage: [-2, 2], step_limit: 0.9, each: %s}\n"                                      \
    "target: {value: [1, -2, 3, 1, -1, 2, 2, 0, -1]}\n"

/*
 * Law: actuators that one amplifier drives are one actuator whose column is the sum of theirs: the
 * voltages are those of a matrix with summed columns, to the last bit. Its limits and its step
 * limit are the narrowest of its actuators, its response in a mode is the sum of theirs.
 */
static void test_tied(void **state)
{
    (void)state;
    scene_run tied, summed;
    voltages a, b;
    write_tied_matrix("matrix.csv", false);
    write_tied_matrix("plain.csv", true);
    write_text("scene.yaml", TIED_SCENE, "matrix.csv", "tied: {right: [a5, a2], left: [a1, a3]},",
               "[0.1, 0.2, 0.3, 0.4, 0.5]",
               "[{actuator: a1, voltage: [-5, 0.3]}, {actuator: a3, voltage: [-0.4, 5], "
               "step_limit: 0.5}, {actuator: a5, voltage: [-9, 9]}, {actuator: a4, hold: 0.1}]");
    open_measured(&tied, "");
    write_text("scene.yaml", TIED_SCENE, "plain.csv", "", "[0, 0, 0]",
               "[{actuator: left, voltage: [-0.4, 0.3], step_limit: 0.5}, "
               "{actuator: a4, hold: 0.1}]");
    open_measured(&summed, "");
    optimum(&tied, 100, &a);
    optimum(&summed, 100, &b);
    assert_int_equal(a.amplifiers, TIED_GROUPS);
    assert_int_equal(b.amplifiers, TIED_GROUPS);
    assert_memory_equal(a.voltage, b.voltage, TIED_GROUPS * sizeof *a.voltage);
    const design *d = &tied.analysis.design, *other = &summed.analysis.design;
    assert_memory_equal(d->lower, other->lower, TIED_GROUPS * sizeof *d->lower);
    assert_memory_equal(d->upper, other->upper, TIED_GROUPS * sizeof *d->upper);
    assert_memory_equal(d->step_limit, other->step_limit, TIED_GROUPS * sizeof *d->step_limit);
    assert_true(d->lower[0] == -0.4 && d->upper[0] == 0.3 && d->upper[1] == 2);
    assert_true(d->upper[2] == 0.1 && d->step_limit[0] == 0.5);
    for (int k = 0; k < TIED_GROUPS; k++)
        assert_string_equal(d->amplifier_name[k], other->amplifier_name[k]);
    const double *response = tied.scene.influence.mode[0].response;
    const double expected[TIED_GROUPS] = {0.1 + 0.3, 0.2 + 0.5, 0.4};
    assert_memory_equal(response, expected, sizeof expected);
    voltages_free(&a);
    voltages_free(&b);
    scene_run_close(&tied);
    scene_run_close(&summed);
}

/* Law: groups that make no sense are refused with their name and the cure. */
static void test_tied_refused(void **state)
{
    static const refusal bad[] = {
        {"influence.tied={left: [a1, b9]}", "there is no actuator 'b9'; the first one is 'a1'"},
        {"influence.tied={left: [a1, a2, a1]}", "'a1' is named twice in 'left'; name it once"},
        {"influence.tied={left: [a1, a2], right: [a2]}",
         "'a2' is in the groups 'left' and 'right'; an actuator has one amplifier"},
        {"influence.tied={left: []}", "the group 'left' is empty; name the actuators"},
        {"influence.tied={a5: [a1, a2]}",
         "'a5' is also the name of an actuator outside the group; rename the group"},
        {"influence.tied={left: a1}", "left"},
        {"simulate={ticks: 5, plant: {gain: {a3: 2}}}",
         "'a3' is tied to others; write the group, 'left'"},
        {"limits.each=[{actuator: a1, hold: 1}, {actuator: a3, hold: 0}]",
         "left has no voltage left between 1 and 0: its own limits and those of the actuators "
         "tied to it do not overlap"},
    };
    (void)state;
    write_tied_matrix("matrix.csv", false);
    write_text("scene.yaml", TIED_SCENE, "matrix.csv", "tied: {left: [a1, a3]},", "[1, 2, 3, 4, 5]",
               "[]");
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        scene_run m;
        assert_true(scene_run_open(&m, path_of("scene.yaml"), bad[i].set) < 0 ||
                    analysis_influence(&m.analysis, m.error) < 0);
        if (!strstr(m.error, bad[i].expected))
            fail_msg("%s: '%s' is missing in '%s'", bad[i].set, bad[i].expected, m.error);
        scene_run_close(&m);
    }
}

/* Law: the bytes of the matrix are part of the scene's hash, so that stale tables do not pass. */
static void test_hash(void **state)
{
    (void)state;
    scene_run m;
    write_text("scene.yaml", "name: m\ninfluence: {file: matrix.csv}\ntarget: {value: [1, 2]}\n");
    write_text("matrix.csv", "1 1\n0 1\n");
    open_measured(&m, "");
    const uint32_t first = m.scene.hash;
    scene_run_close(&m);
    write_text("matrix.csv", "1 1\n0 2\n");
    open_measured(&m, "");
    assert_true(m.scene.hash != first);
    scene_run_close(&m);
}

/* ---- a measured bimorph mirror ------------------------------------------- */

enum { SCANS = 17, ACTUATORS = SCANS - 1 };

/* Voltages of the mirror during the last scan, and the published corrections to them (V). */
static const double initial[ACTUATORS] = {-516, -242, -134, 56,  -56, 163, -19,  -30,
                                          -190, -93,  -21,  223, 42,  -94, -344, -360};
static const double published[ACTUATORS] = {375.40, 317.36, -8.87,  98.24,  124.10, -192.16,
                                            -0.16,  -62.36, 213.40, -95.89, 42.60,  -63.67,
                                            121.08, -47.77, 127.27, 73.58};

/*
 * Write the matrix from the differences of successive scans, -100 V each, and the target: what the
 * voltages must cause so that the beam of the last scan moves to its mean.
 */
static void write_bimorph(const number_table *scans)
{
    FILE *matrix = write_file("matrix.csv"), *wanted = write_file("wanted.csv");
    double mean = 0;
    assert_true(matrix && wanted);
    for (size_t i = 0; i < scans->rows; i++)
        mean += scans->value[i * SCANS + SCANS - 1] / (double)scans->rows;
    for (size_t i = 0; i < scans->rows; i++) {
        const double *scan = scans->value + i * SCANS;
        double target = mean - scan[SCANS - 1];
        for (int k = 0; k < ACTUATORS; k++) {
            const double entry = (scan[k + 1] - scan[k]) / -100;
            target += entry * initial[k];
            fprintf(matrix, "%.17g%c", entry, k + 1 < ACTUATORS ? ',' : '\n');
        }
        fprintf(wanted, "%.17g\n", target);
    }
    assert_int_equal(fclose(matrix) | fclose(wanted), 0);
}

/*
 * Law: on a bimorph mirror measured at Diamond Light Source, with 16 actuators and 117 points, the
 * optimum without limits is the published one (two decimals), and within 200 V it leaves the RMS
 * that scipy's exact bounded least squares leave, 3.4988011297 um.
 * Besides, with neighbours within 150 V of each other it leaves the RMS of least distance
 * programming by scipy's non-negative least squares, 3.8093564089 um.
 */
static void test_bimorph(void **state)
{
    (void)state;
    scene_run m;
    voltages open, bounded;
    number_table scans;
    char error[NUMBER_ERROR];
    if (number_table_read(&scans, "tests/rigs/bimorph/scans.csv", error) < 0)
        fail_msg("%s", error);
    assert_int_equal(scans.rows, 117);
    assert_int_equal(scans.columns, SCANS);
    write_bimorph(&scans);
    number_table_free(&scans);
    write_text("scene.yaml", "name: bimorph\ninfluence: {file: matrix.csv}\n"
                             "limits: {voltage: [-200, 200]}\n"
                             "target: {value: {file: wanted.csv}, free: [piston]}\n");
    open_measured(&m, "");
    optimum(&m, HUGE_VAL, &open);
    optimum(&m, 200, &bounded);
    for (int k = 0; k < ACTUATORS; k++) {
        assert_true(fabs(open.voltage[k] - initial[k] - published[k]) <= 0.00501);
        assert_true(fabs(bounded.voltage[k]) <= 200);
    }
    scene_run rows;
    voltages near;
    write_text("scene.yaml", "name: bimorph\ninfluence: {file: matrix.csv}\n"
                             "limits: {voltage: [-200, 200], difference: {limit: 150}}\n"
                             "target: {value: {file: wanted.csv}, free: [piston]}\n");
    open_measured(&rows, "");
    optimum(&rows, 200, &near);
    for (int k = 0; k + 1 < ACTUATORS; k++)
        assert_true(fabs(near.voltage[k] - near.voltage[k + 1]) <= 150);
    assert_int_equal(near.active_rows, 6);
    assert_near("RMS within 200 V, neighbours within 150 V", near.rms, 3.8093564089, 1e-9);
    voltages_free(&near);
    scene_run_close(&rows);
    assert_near("RMS without limits", open.rms, 3.4412107848, 1e-9);
    assert_near("RMS within 200 V", bounded.rms, 3.4988011297, 1e-9);
    voltages_free(&open);
    voltages_free(&bounded);
    scene_run_close(&m);
}

/* ---- targets from files ------------------------------------------------ */

/*
 * Law: on a structure, a target through scattered points of a linear function is that function at
 * every node, to rounding.
 */
static void test_scattered_target(void **state)
{
    (void)state;
    scene_run f, p;
    char change[256];
    FILE *file = write_file("wanted.csv");
    uint32_t random = 4;
    fputs("x,y,u3\n", file);
    for (int i = 0; i < 300; i++) {
        double place[2];
        for (int a = 0; a < 2; a++)
            place[a] = 0.2 * uniform(&random, 0, 1);
        fprintf(file, "%.17g,%.17g,%.17g\n", place[0], place[1], 2 * place[0] - place[1] + 0.1);
    }
    assert_int_equal(fclose(file), 0);
    open_run(&f, "plate-50-patches", "target.value=(2*x - y + 0.1)*1e-3");
    snprintf(change, sizeof change, "target.value={file: %s, columns: [x, y, u3], scale: 1e-3}",
             path_of("wanted.csv"));
    open_run(&p, "plate-50-patches", change);
    for (int i = 0; i < f.analysis.design.targets; i++)
        assert_true(fabs(f.analysis.design.target[i] - p.analysis.design.target[i]) < 1e-14);
    /* 300 random points: the mean distance to a neighbour is 0.5/sqrt(300/0.04); no node is far. */
    const double gap = design_target_gap(&p.analysis.design);
    assert_true(gap > 1 && gap < 5);
    assert_true(design_target_gap(&f.analysis.design) == 0);
    scene_run_close(&f);
    scene_run_close(&p);
}

/* ---- simulation -------------------------------------------------------- */

/*
 * Law: in a closed loop on a plant whose matrix is the scene's times a gain, the controller reaches
 * the optimum of that plant; without limits that bind, the target.
 */
static void test_simulation(void **state)
{
    (void)state;
    scene_run m;
    simulation run;
    write_text("scene.yaml", "name: m\ninfluence: {file: matrix.csv}\nlimits: {voltage: [-9, 9]}\n"
                             "target: {value: [1, 2, 3]}\n"
                             "simulate: {ticks: 200, plant: {gain: 0.7, scatter: 0.05}}\n");
    write_text("matrix.csv", "1 0.2 0\n0.1 1 0\n0 0.1 1\n");
    open_measured(&m, "");
    if (simulate_open(&run, &m.analysis, m.error) < 0 ||
        simulate_run(&run, LAW_CONTROLLER, NULL, NULL, m.error) < 0 ||
        simulate_optima(&run, m.error) < 0)
        fail_msg("%s", m.error);
    assert_int_equal(run.count[LAW_CONTROLLER].beyond_limits, 0);
    assert_true(run.phase[0].optimum < 1e-12);
    assert_true(run.phase[0].course[LAW_CONTROLLER].steady < 1e-12);
    const double first = run.plant.scene.influence.matrix[0];
    assert_true(fabs(first - 0.7) < 0.7 * 6 * 0.05 && first != 0.7);
    simulate_close(&run);
    scene_run_close(&m);
}

/*
 * Law: a limit between amplifiers counts as violated where the difference of two voltages exceeds
 * it by more than rounding, unless one of the amplifiers is held; the controller violates none.
 */
static void test_violated_rows(void **state)
{
    static const double inside[3] = {0, 1, 0}, beyond[3] = {0, 1 + 1e-12, 0},
                        rounded[3] = {0, 1 + FLT_EPSILON, 0};
    scene_run m;
    simulation run;
    loop loop;
    (void)state;
    write_text("matrix.csv", "1 0.2 0\n0.1 1 0\n0 0.1 1\n");
    write_text("scene.yaml", "name: m\ninfluence: {file: matrix.csv}\n"
                             "limits: {voltage: [-9, 9], difference: {limit: 1}}\n"
                             "target: {value: [1, 2, 3]}\nsimulate: {ticks: 50}\n");
    open_measured(&m, "");
    if (simulate_open(&run, &m.analysis, m.error) < 0 ||
        simulate_run(&run, LAW_CONTROLLER, NULL, NULL, m.error) < 0 ||
        loop_open(&loop, &run, LAW_CONTROLLER, m.error) < 0)
        fail_msg("%s", m.error);
    const int rows = m.analysis.design.limits.rows;
    assert_in_range(rows, 2, 3);
    assert_int_equal(run.count[LAW_CONTROLLER].beyond_rows, 0);
    assert_int_equal(loop_beyond_rows(&loop, inside, 64), 0);
    assert_int_equal(loop_beyond_rows(&loop, rounded, 32), 0);
    assert_int_equal(loop_beyond_rows(&loop, beyond, 64), 2);
    loop.electrode[0].is_held = true;
    assert_int_equal(loop_beyond_rows(&loop, beyond, 64), 1);
    loop_close(&loop);
    simulate_close(&run);
    scene_run_close(&m);
}

/* Law: a schedule from a file is the same as its events in the scene, to the last bit. */
static void test_schedule(void **state)
{
    (void)state;
    static const char *const events[2] = {
        "simulate.events=[{at: 10, target: 0.5}, {at: 20, target: -1}]",
        "simulate.events={file: wanted.csv}"};
    double steady[2][3];
    write_text("matrix.csv", "1 0.2 0\n0.1 1 0\n0 0.1 1\n");
    write_text("wanted.csv", "at,target\n10,0.5\n20,-1\n");
    write_text("scene.yaml", "name: m\ninfluence: {file: matrix.csv}\n"
                             "limits: {voltage: [-9, 9]}\ntarget: {value: [1, 2, 3]}\n"
                             "simulate: {ticks: 30, plant: {gain: 0.7}, sensors: {noise: 0.01}}\n");
    for (int k = 0; k < 2; k++) {
        scene_run m;
        simulation run;
        open_measured(&m, events[k]);
        if (simulate_open(&run, &m.analysis, m.error) < 0 ||
            simulate_run(&run, LAW_CONTROLLER, NULL, NULL, m.error) < 0)
            fail_msg("%s", m.error);
        assert_int_equal(run.phases, 3);
        for (int p = 0; p < 3; p++)
            steady[k][p] = run.phase[p].course[LAW_CONTROLLER].steady;
        simulate_close(&run);
        scene_run_close(&m);
    }
    assert_memory_equal(steady[0], steady[1], sizeof steady[0]);
}

/* Law: voltages from a file are applied as those of the scene, one for each amplifier. */
static void test_applied(void **state)
{
    (void)state;
    scene_run list, file;
    char change[256];
    FILE *values = write_file("wanted.csv");
    for (int k = 0; k < 25; k++)
        fprintf(values, "%d\n", 10 * k - 100);
    assert_int_equal(fclose(values), 0);
    solve_run(&list, "plate-50-patches",
              "actuators.0.applied=[-100,-90,-80,-70,-60,-50,-40,-30,-20,-10,0,10,20,30,40,50,60,"
              "70,80,90,100,110,120,130,140]");
    snprintf(change, sizeof change, "actuators.0.applied={file: %s}", path_of("wanted.csv"));
    solve_run(&file, "plate-50-patches", change);
    assert_true(scene_run_value(&list, 0) != 0);
    assert_true(scene_run_value(&list, 0) == scene_run_value(&file, 0));
    scene_run_close(&list);
    scene_run_close(&file);
}

/* ---- wrong scenes and files --------------------------------------------- */

#define GOOD "1 0\n0 1\n1 1\n"
#define SCENE(influence, rest) "name: m\ninfluence: {file: matrix.csv" influence "}\n" rest
#define TARGET "target: {value: [1, 2, 3]}\n"
#define SI "units: {length: m, force: N, voltage: V, temperature: K}\n"
/* Influence matrix of 3 outputs in a file without units. */
#define SCENE2 "name: m\ninfluence: {file: plain.csv}\n"

/* A matrix of 3 outputs and 2 actuators, written with a row for each actuator, and its hint. */
#define WIDE "1 0 1\n0 1 1\n"
#define WRITE_ACTUATORS "~if the rows of its file are actuators, write rows: actuators"
/* A matrix of 2 actuators and 3 outputs that a scene reads with `rows: actuators`. */
#define TALL "a b\n1 0\n0 1\n1 1\n"

/* Whether a text holds the parts of a pattern, separated by ~, in their order. */
static bool holds(const char *text, const char *pattern)
{
    char part[200];
    while (text && *pattern) {
        const size_t length = strcspn(pattern, "~");
        snprintf(part, sizeof part, "%.*s", (int)length, pattern);
        text = strstr(text, part);
        pattern += length + (pattern[length] == '~');
    }
    return text != NULL;
}

/* Law: what is wrong in a scene or its files is one line with place, value and cure. */
static void test_faults(void **state)
{
    (void)state;
    static const struct {
        const char *matrix, *scene, *expected;
    } bad[] = {
        {GOOD, SCENE("", "target: {value: [1, 2]}\n"), "2 values for 3 outputs"},
        {GOOD, SCENE("", "target: {value: x}\n"), "the outputs have none; add influence.coord"},
        {GOOD, SCENE("", "target: {value: theta1}\n"), "a measured matrix has x, y, z"},
        {GOOD, SCENE("", "target: {value: [1, 2, 3], weight: area}\n"), "needs the places"},
        {GOOD, SCENE("", "target: {value: [1, .nan, 3]}\n"), ":3:21: 'value: .nan' is no number"},
        {GOOD, SCENE("", "target: {u3: middle, value: 1}\n"), "unknown key 'u3'"},
        {GOOD, SCENE("", TARGET "surface: {type: plate}\n"), "'surface' describes a structure"},
        {GOOD, SCENE("", TARGET "supports: []\n"), "'supports' describes a structure"},
        {GOOD, SCENE(", rows: columns", TARGET), "'rows: columns' is not known"},
        {GOOD, SCENE(", scale: 0", TARGET), "must be above 0"},
        {GOOD, SCENE(", actuators: [a, b, c]", TARGET), "it is transposed; write rows: actuators"},
        {GOOD, SCENE(", actuators: [a, b, c, d]", TARGET), "4 names of actuators for 2 actuators"},
        {GOOD, SCENE(", actuators: [a, a]", TARGET), "two actuators named 'a'"},
        {GOOD, SCENE(", outputs: [a, b]", TARGET), "it is transposed; write rows: actuators"},
        {GOOD, SCENE(", coordinates: [[0, 0], [1, 0]]", TARGET), "it is transposed"},
        {GOOD, SCENE(", coordinates: [[0, 0], [1, 0], [1, 1], [2, 1]]", TARGET),
         "4 points of coordinates for 3 outputs"},
        {GOOD, SCENE(", coordinates: [[0, 0, 0, 0], [1, 0], [1, 1]]", TARGET), "not 4"},
        {GOOD, SCENE(", ignore: [4]", TARGET), "there is no output '4'"},
        {GOOD, SCENE(", ignore: [1, 2, 3]", TARGET), "all 3 outputs are ignored"},
        {GOOD, SCENE(", mask: [1, 0.5, 0]", TARGET), "entry 2 of the mask is 0.5"},
        {GOOD, SCENE(", mask: [1, 0]", TARGET), "it is transposed"},
        {GOOD, SCENE("", TARGET "limits: {each: [{actuator: v3, hold: 0}]}\n"),
         "there is no actuator 'v3'; the first one is 'v1'"},
        {GOOD, SCENE("", TARGET "simulate: {ticks: 9, plant: {stiffness: 2}}\n"),
         "unknown key 'stiffness'"},
        {GOOD, SCENE("", TARGET "simulate: {ticks: 9, plant: {gain: {v9: 2}}}\n"),
         "there is no actuator 'v9'"},
        {GOOD, SCENE("", TARGET "compare: [{name: a, values: [1]}]\n"),
         "1 values for 2 amplifiers"},
        {"1 0\n0 nan\n1 1\n", SCENE("", TARGET),
         "matrix.csv: line 2, column 2, actuator 'v2', is nan"},
        {"1 0\n0 1e999\n1 1\n", SCENE("", TARGET), "line 2, column 2, actuator 'v2', is inf"},
        {"1 0\n0\n1 1\n", SCENE("", TARGET), "matrix.csv:2: 1 values where"},
        {"1 0\n0;1\n1 1\n", SCENE("", TARGET), "matrix.csv:2: "},
        {"0 0\n0 0\n0 0\n", SCENE("", TARGET), "every entry is 0"},
        {"", SCENE("", TARGET), "matrix.csv: the file is empty"},
        {"a,a\n1,0\n0,1\n1,1\n", SCENE("", TARGET), "two actuators named 'a'"},
        {"x,y\n1,0\n0,1\n1,1\n", SCENE("", TARGET), "has coordinates only"},
        {"x,v\n1,0\nnan,1\n1,1\n", SCENE("", TARGET),
         "coordinate x of an output is nan, at line 3"},
        {"x,v\n1,0\n2,1\n1,1\n", SCENE(", coordinates: [[1], [2], [3]]", TARGET),
         "has columns x, y or z already"},
        {GOOD, "name: m\ninfluence: {file: other.csv}\n" TARGET, "2:19: other.csv: cannot read it"},
        {GOOD, "name: m\ninfluence: {}\n" TARGET, "'file' is missing"},
        {GOOD, "name: m\ninfluence: {file: [a]}\n" TARGET, "must be a single value"},
        {GOOD, SCENE("", TARGET "simulate: {ticks: 9, events: {file: matrix.csv}}\n"),
         "needs a first line with the names at and target"},
        {"at,target\n1,1\n9,1\n1,2\n",
         SCENE("", TARGET "simulate: {ticks: 9, events: {file: matrix.csv}}\n"),
         "line 3, column 1 is 9; a tick is a whole number from 0 to 8"},
        {"at,target\n2,1\n1,0\n1,2\n",
         SCENE("", TARGET "simulate: {ticks: 9, events: {file: matrix.csv}}\n"),
         "tick 1 comes after a later one"},
        {GOOD, SCENE("", "target: {value: {file: matrix.csv}}\n"), "write columns: [x, y, value]"},
        {GOOD, SCENE("", "target: {value: {file: matrix.csv, column: 3}}\n"), "no column '3'"},
        {GOOD, SCENE("", "target: {value: {file: matrix.csv, columns: [x, y, z, a]}}\n"),
         "has no column"},
        {GOOD, SCENE("", "target: {value: {file: matrix.csv, columns: [a, b]}}\n"),
         "'a' is no coordinate"},
        {"1 nan\n0 1\n1 1\n",
         SCENE(", ignore: [1]", "target: {value: {file: matrix.csv, column: 2}}\n"),
         "matrix.csv: line 1, column 2 is nan"},
        {GOOD, SCENE("", TARGET "limits: {each: [{actuator: a5, hold: 0}]}\n"),
         "there is no actuator 'a5'~write the list influence.actuators"},
        {"x_mm,v\n1,0\n0,1\n1,1\n", SCENE("", "target: {value: x}\n"),
         "the column 'x_mm' of the matrix counts as an actuator; name the columns"},
        {"x [px],v\n1,0\n0,1\n1,1\n", SI SCENE("", TARGET),
         "the column 'x [px]' of the file has no unit of length; write x [mm]"},
        {"x (K),v\n1,0\n0,1\n1,1\n", SI SCENE("", TARGET), "'x (K)'~none of a length"},
        {"a (um),b\n1,0\n0,1\n1,1\n", SI SCENE("", TARGET),
         "'a (um)'~none of a displacement per voltage; correct the unit"},
        {"a (um/V)\n1\n0\n1\n", SI SCENE(", scale: 1e-6", TARGET),
         "scale: 1e-06 converts its numbers again; remove one of the two"},
        {"a (um)\n1\n0\n1\n", SI SCENE2 "target: {value: {file: matrix.csv, scale: 1e-6}}\n",
         "scale: 1e-06 converts its numbers again; remove one of the two"},
        {"a (V)\n1\n0\n1\n", SI SCENE2 "target: {value: {file: matrix.csv}}\n",
         "'a (V)'~none of a length"},
        {WIDE, SCENE("", TARGET), "3 values for 2 outputs" WRITE_ACTUATORS},
        {WIDE, SCENE("", "target: {value: x}\n"), "the outputs have none" WRITE_ACTUATORS},
        {WIDE, SCENE(", coordinates: [[0], [1], [2], [3]]", TARGET),
         "4 points of coordinates for 2 outputs" WRITE_ACTUATORS},
        {WIDE, SCENE("", "target: {value: [1, 2]}\nlimits: {each: [{actuator: v4, hold: 0}]}\n"),
         "there is no actuator 'v4'; the first one is 'v1'" WRITE_ACTUATORS},
        {TALL,
         SCENE(", rows: actuators",
               "target: {value: [1, 2]}\nlimits: {each: [{actuator: a, hold: 0}]}\n"),
         "if the rows of its file are outputs, write rows: outputs"},
    };
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        char error[SCENE_ERROR] = "no fault";
        scene scene;
        write_text("matrix.csv", "%s", bad[k].matrix);
        write_text("plain.csv", "%s", GOOD);
        write_text("scene.yaml", "%s", bad[k].scene);
        const int failed = scene_read(&scene, path_of("scene.yaml"), NULL, 0, error);
        if (!failed)
            scene_free(&scene);
        if (!failed || !holds(error, bad[k].expected) || strchr(error, '\n'))
            fail_msg("%s: expected '%s', got '%s'", bad[k].scene, bad[k].expected, error);
    }
}

/* Law: numbers of a file in a stated unit are those of the scene's unit, to rounding. */
static void test_units_of_columns(void **state)
{
    (void)state;
    static const char *const matrix[2] = {"x,y,a b,c\n0.001,0,2e-6,0\n0.002,0.001,0,3e-6\n",
                                          "x [mm];y (um);a b (um/V);c [nm/V]\n"
                                          "1;0;2;0\n2;1000;0;3000\n"};
    static const char *const target[2] = {"4e-6\n5e-6\n", "w [um]\n4\n5\n"};
    char error[SCENE_ERROR];
    scene plain, stated;
    for (int k = 0; k < 2; k++) {
        scene *const to = k == 0 ? &plain : &stated;
        write_text("matrix.csv", "%s", matrix[k]);
        write_text("target.csv", "%s", target[k]);
        write_text("scene.yaml", "%s", SI SCENE("", "target: {value: {file: target.csv}}\n"));
        assert_int_equal(scene_read(to, path_of("scene.yaml"), NULL, 0, error), 0);
    }
    assert_string_equal(stated.actuator[0].name, "a b");
    assert_string_equal(stated.actuator[1].name, "c");
    for (int i = 0; i < 2; i++) {
        const expr_point at = {0};
        for (int axis = 0; axis < 3; axis++)
            assert_true(fabs(plain.influence.place[i][axis] - stated.influence.place[i][axis]) <=
                        2 * DBL_EPSILON * fabs(plain.influence.place[i][axis]));
        for (int k = 0; k < 2; k++)
            assert_true(
                fabs(plain.influence.matrix[2 * i + k] - stated.influence.matrix[2 * i + k]) <=
                2 * DBL_EPSILON * fabs(plain.influence.matrix[2 * i + k]));
        const double value = expr_row_value(plain.target.value, &at, i);
        assert_true(value > 3e-6 && fabs(expr_row_value(stated.target.value, &at, i) - value) <=
                                        2 * DBL_EPSILON * value);
    }
    scene_free(&plain);
    scene_free(&stated);
}

/* Law: one warning names every actuator that moves nothing, except those that are held. */
static void test_dead_actuators(void **state)
{
    (void)state;
    scene_run m;
    plausible warnings;
    memset(&warnings, 0, sizeof warnings);
    write_text("matrix.csv", "a,b,c,d\n1e-7,0,1e-13,0\n2e-7,0,1e-13,0\n");
    write_text("scene.yaml", "name: m\nunits: {length: m, force: N, voltage: V, temperature: K}\n"
                             "influence: {file: matrix.csv, ignore: []}\n"
                             "limits: {voltage: [-1, 1], each: [{actuator: d, hold: 0}]}\n");
    open_run(&m, path_of("scene.yaml"), "");
    plausible_scene(&warnings, &m.scene);
    bool is_named = false;
    for (int i = 0; i < warnings.count; i++)
        is_named |= strstr(warnings.warning[i].text,
                           "effect of actuators 'b', 'c' over that of the strongest, the least: 0, "
                           "below 0.0001") != NULL;
    assert_true(is_named);
    scene_run_close(&m);
}

/* Law: unusual matrices are warned of, each by its rule and with its number. */
static void test_warnings(void **state)
{
    (void)state;
    static const struct {
        const char *matrix, *rule;
        double value;
    } unusual[] = {
        {"0.02 0\n0 0.03\n0.01 0.01\n", "influence", 0.03},
        {"2e-14 0\n0 3e-14\n1e-14 1e-14\n", "influence", 3e-14},
        {"1e-7 0 1e-8\n0 1e-7 3e-8\n", "influence_shape", 1.5},
        {"1e-7 0\n0 0\n1e-7 0\n", "dead_actuator", 0},
        {"1e-7 2e-7\n3e-7 6e-7\n1e-7 2e-7\n", "repeated_actuator", 0},
        {"1e-6 0 0\n0 1e-6 0\n0 0 1.01e-5\n", "influence", 1.01e-5},
        {"1e-8 0 0\n0 1e-8 0\n0 0 1.01e-6\n", "strong_actuator", 101},
        {"1e-8 0 0\n0 1e-8 0\n0 0 0.99e-6\n", NULL, 0},
        {"1e-7 0 0\n0 1e-7 0\n0 0 0.98e-9\n", "weak_actuator", 0.0098},
        {"1e-7 0 0\n0 1e-7 0\n0 0 1.02e-9\n", NULL, 0},
        {"1e-7 0\n0 1e-7\n1e-7 1e-7\n", NULL, 0},
    };
    for (size_t k = 0; k < sizeof unusual / sizeof *unusual; k++) {
        scene_run m;
        plausible warnings;
        memset(&warnings, 0, sizeof warnings);
        write_text("matrix.csv", "%s", unusual[k].matrix);
        write_text("scene.yaml",
                   "name: m\nunits: {length: m, force: N, voltage: V, temperature: K}\n"
                   "influence: {file: matrix.csv}\n");
        open_run(&m, path_of("scene.yaml"), "");
        plausible_scene(&warnings, &m.scene);
        assert_int_equal(warnings.count, unusual[k].rule != NULL);
        if (unusual[k].rule) {
            assert_string_equal(warnings.warning[0].rule, unusual[k].rule);
            /* The sine of an angle of 0 is computed as the root of 1 - cos^2. */
            const double expected = unusual[k].value, found = warnings.warning[0].value;
            if (expected == 0)
                assert_true(found * found <= 8 * DBL_EPSILON);
            else
                assert_true(fabs(found - expected) <= 4 * DBL_EPSILON * expected);
        }
        scene_run_close(&m);
    }
}

/*
 * Law: the number of amplifiers whose columns depend on others counts those that are not held: a
 * dead electrode that is held makes no voltage ambiguous, two equal columns make one.
 */
static void test_dependent(void **state)
{
    (void)state;
    static const struct {
        const char *matrix, *hold;
        int dependent;
    } cases[] = {
        {"1 0 2\n0 1 3\n1 1 4\n", "", 0},
        {"1 0 0\n0 1 0\n1 1 0\n", "{actuator: v3, hold: 0}", 0},
        {"1 0 0\n0 1 0\n1 1 0\n", "", 1},
        {"1 0 1\n0 1 0\n1 1 1\n", "", 1},
        {"1 0 1\n0 1 0\n1 1 1\n", "{actuator: v3, hold: 5}", 0},
        {"1 0 1\n0 1 0\n1 1 1\n", "{actuator: v2, hold: 5}", 1},
        {"1 1 1\n0 0 0\n1 1 1\n", "", 2},
        {"1 0 1\n0 1 0\n1 1 1\n", "{actuator: v1, hold: 1}, {actuator: v2, hold: 0}", 0},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        scene_run m;
        voltages found;
        char limits[200];
        write_text("matrix.csv", "%s", cases[k].matrix);
        write_text("scene.yaml", SCENE("", TARGET));
        snprintf(limits, sizeof limits, "limits={voltage: [-9, 9], each: [%s]}", cases[k].hold);
        open_measured(&m, *cases[k].hold ? limits : "limits={voltage: [-9, 9]}");
        assert_int_equal(voltages_clipped(&m.analysis, scene_limits_alone(), &found, m.error), 0);
        if (found.dependent != cases[k].dependent)
            fail_msg("%s%s: %d dependent", cases[k].matrix, cases[k].hold, found.dependent);
        voltages_free(&found);
        scene_run_close(&m);
    }
}

enum { COLUMNS = 8, LINES = 40 };

/* Entry of a banded matrix with small numbers beside the band. */
static double banded(int output, int actuator)
{
    const bool is_near = output / 5 == actuator;
    return (is_near ? 1e-6 : 1e-9) * (1 + 0.1 * ((output * 7 + actuator * 3) % 11));
}

static void write_banded(void)
{
    FILE *file = write_file("matrix.csv");
    for (int i = 0; i < LINES; i++)
        for (int k = 0; k < COLUMNS; k++)
            fprintf(file, "%.17g%c", banded(i, k), k + 1 < COLUMNS ? ',' : '\n');
    assert_int_equal(fclose(file), 0);
}

/* Assert that sparse rows hold the matrix of a design, and nothing else. */
static void assert_rows_are(const pzs_rows *rows, const design *design)
{
    uint32_t at = 0;
    for (int i = 0; i < LINES; i++) {
        assert_int_equal(rows->start[i], at);
        for (int k = 0; k < COLUMNS; k++) {
            const double entry = design->influence[i * COLUMNS + k];
            if (entry == 0)
                continue;
            assert_int_equal(rows->dof[at], k);
            assert_true(rows->value[at] == entry);
            at++;
        }
    }
    assert_int_equal(rows->start[LINES], at);
}

/*
 * Law: entries below drop_below times the largest entry of their column are zero in the controller
 * alone, and the error is the largest sum of what is left out times the voltage limits. The tables
 * hold the rest as sparse rows where it is an eighth of all entries, and the sparse matrix is
 * refused by no check.
 */
static void test_dropped(void **state)
{
    (void)state;
    scene_run m;
    write_banded();
    write_text("scene.yaml", "name: m\nunits: {length: m, force: N, voltage: V, temperature: K}\n"
                             "influence: {file: matrix.csv, drop_below: 0.01}\n"
                             "limits: {voltage: [-30, 50]}\n"
                             "target: {value: 1e-6}\n");
    open_measured(&m, "");
    const design *design = &m.analysis.design;
    double worst = 0;
    for (int i = 0; i < LINES; i++) {
        double error = 0;
        for (int k = 0; k < COLUMNS; k++) {
            const bool is_kept = i / 5 == k;
            error += is_kept ? 0 : 50 * banded(i, k);
            assert_true(design->influence[i * COLUMNS + k] == (is_kept ? banded(i, k) : 0));
            assert_true(entry(&m.analysis, i, k) == banded(i, k));
        }
        worst = fmax(worst, error);
    }
    assert_int_equal(design->dropped.entries, LINES * (COLUMNS - 1));
    assert_true(fabs(design->dropped.error - worst) <= 2 * COLUMNS * DBL_EPSILON * worst);
    const sparse_facts facts = sparse_tables_count(design, false);
    assert_int_equal(facts.entries, LINES);
    assert_true(facts.is_used);
    assert_false(sparse_tables_count(design, true).is_used);
    pzs_sparse_influence sparse;
    assert_int_equal(sparse_tables_make(&sparse, design), 0);
    assert_rows_are(&sparse.rows, design);
    sparse_tables_free(&sparse);
    scene_run_close(&m);
}

/* Law: without drop_below nothing is left out, and a full matrix stays full. */
static void test_nothing_dropped(void **state)
{
    (void)state;
    scene_run m;
    write_banded();
    write_text("scene.yaml", "name: m\nunits: {length: m, force: N, voltage: V, temperature: K}\n"
                             "influence: {file: matrix.csv}\n"
                             "limits: {voltage: [-30, 50]}\n"
                             "target: {value: 1e-6}\n");
    open_measured(&m, "");
    assert_int_equal(m.analysis.design.dropped.entries, 0);
    assert_true(m.analysis.design.dropped.error == 0);
    assert_int_equal(sparse_tables_count(&m.analysis.design, false).entries, LINES * COLUMNS);
    assert_false(sparse_tables_count(&m.analysis.design, false).is_used);
    scene_run_close(&m);
}

/* Law: what needs a structure says so, and that this scene has none. */
static void test_without_structure(void **state)
{
    (void)state;
    scene_run m;
    vibration vibration;
    write_text("matrix.csv", GOOD);
    write_text("scene.yaml", SCENE("", TARGET));
    open_measured(&m, "");
    assert_int_equal(analysis_needs_structure(&m.analysis, "pzs solve", m.error), -1);
    assert_non_null(strstr(m.error, "pzs solve needs a structure"));
    assert_int_equal(vibration_solve(&vibration, &m.analysis.design, 3, MASS_LUMPED, m.error), -1);
    assert_non_null(strstr(m.error, "need a structure"));
    scene_run_close(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_answer),    cmocka_unit_test(test_ignored),
        cmocka_unit_test(test_held),           cmocka_unit_test(test_hash),
        cmocka_unit_test(test_bimorph),        cmocka_unit_test(test_scattered_target),
        cmocka_unit_test(test_simulation),     cmocka_unit_test(test_violated_rows),
        cmocka_unit_test(test_schedule),       cmocka_unit_test(test_applied),
        cmocka_unit_test(test_faults),         cmocka_unit_test(test_warnings),
        cmocka_unit_test(test_dead_actuators), cmocka_unit_test(test_without_structure),
        cmocka_unit_test(test_dependent),      cmocka_unit_test(test_units_of_columns),
        cmocka_unit_test(test_dropped),        cmocka_unit_test(test_nothing_dropped),
        cmocka_unit_test(test_tied),           cmocka_unit_test(test_tied_refused),
        cmocka_unit_test(test_park),
    };
    return cmocka_run_group_tests(tests, make_test_folder, remove_test_folder);
}
