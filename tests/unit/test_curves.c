/*
 * Scenes with curves of actuators: voltages that have the best effects, exactly at both limits;
 * curves of single actuators, falling curves and curves of other units; a control loop on a plant
 * whose curves differ; curves that are refused.
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
#include "../../host_tools/model/curves.h"
#include "../../host_tools/simulate/simulation.h"
#include "../rigs/scene_assert.h"
#include "../rigs/test_folder.h"

enum { OUTPUTS = 12, ACTUATORS = 4 };

static double matrix[OUTPUTS][ACTUATORS];

/* A matrix of numbers without pattern, from -0.7 to 0.7. */
static void write_matrix(void)
{
    FILE *file = write_file("matrix.csv");
    uint32_t state = 1;
    fputs("a1,a2,a3,a4\n", file);
    for (int i = 0; i < OUTPUTS; i++)
        for (int k = 0; k < ACTUATORS; k++) {
            state = state * 1664525U + 1013904223U;
            matrix[i][k] = (double)state / 3e9 - 0.7;
            fprintf(file, "%.17g%s", matrix[i][k], k + 1 < ACTUATORS ? "," : "\n");
        }
    assert_int_equal(fclose(file), 0);
}

/* A scene with given keys of the section influence, voltage limits and size of the target. */
static void write_scene(const char *keys, const char *limits, double target)
{
    write_text("scene.yaml",
               "name: m\nunits: {length: m, force: N, voltage: V, temperature: K}\n"
               "control: {rate: 1000}\ninfluence: {file: matrix.csv%s}\n"
               "limits: %s\ntarget: {value: [%.17g, %.17g, %.17g, 0, 0, 0, 0, 0, 0, 0, 0, 0]}\n"
               "safety: none\nsimulate: {ticks: 60}\n",
               keys, limits, 2 * target, -target, 1.5 * target);
}

static int set_up(void **state)
{
    if (make_test_folder(state) < 0)
        return -1;
    write_matrix();
    return 0;
}

static void open_scene(scene_run *run, const char *changes)
{
    open_run(run, path_of("scene.yaml"), changes);
    if (analysis_influence(&run->analysis, run->error) < 0)
        fail_msg("%s", run->error);
}

static void optimum(scene_run *run, common_limits limits, voltages *result)
{
    if (voltages_optimum(&run->analysis, limits, result, run->error) < 0)
        fail_msg("%s", run->error);
}

/* ---- voltages ----------------------------------------------------------- */

/*
 * Compare a scene with curves with one of linear actuators whose voltages are its effects in the
 * unit of the scene: the same error and shape, and the voltages that have these effects. Voltages
 * at a limit are the limit to the last bit. Rounding is amplified by the condition of the Hessian,
 * below 1e3 here, and by the smallest slope of the curve.
 *   sign  -1 where the curved scene has the opposite target, and so the opposite shape
 */
static void assert_same(scene_run *curved, scene_run *linear, double (*voltage_of)(double, int),
                        const double limit[2], double sign)
{
    voltages a, b;
    int at_limits = 0;
    optimum(curved, scene_limits_alone(), &a);
    optimum(linear, scene_limits_alone(), &b);
    assert_near("error", a.error, b.error, 1e-12);
    assert_int_equal(a.active_limits, b.active_limits);
    for (int k = 0; k < ACTUATORS; k++) {
        const double expected = voltage_of(b.voltage[k], k);
        assert_true(fabs(a.voltage[k] - expected) <= 1e-9 * limit[1]);
        assert_true(a.voltage[k] >= limit[0] && a.voltage[k] <= limit[1]);
        assert_int_equal(a.at_limit[k], b.at_limit[k]);
        at_limits += a.voltage[k] == limit[0] || a.voltage[k] == limit[1];
        assert_true(a.bounds[k] == limit[0] && a.bounds[ACTUATORS + k] == limit[1]);
    }
    assert_int_equal(at_limits, a.active_limits);
    for (int i = 0; i < OUTPUTS; i++)
        assert_true(fabs(sign * a.shape[i] - b.shape[i]) <= 1e-12 * (fabs(b.shape[i]) + 1));
    voltages_free(&a);
    voltages_free(&b);
}

static double root_of(double effect, int k)
{
    (void)k;
    return sqrt(effect);
}

/*
 * Law: with quadratic actuators the squares of the voltages are the voltages of linear actuators
 * between the squares of the limits, for small targets and for targets that no voltage reaches.
 */
static void test_square(void **state)
{
    static const double targets[] = {1e-3, 1, 100, 3e4, 1e6};
    const double limit[2] = {20, 200};
    (void)state;
    for (size_t i = 0; i < sizeof targets / sizeof *targets; i++) {
        scene_run curved, linear;
        write_scene(", curve: quadratic", "{voltage: [20, 200]}", targets[i]);
        open_scene(&curved, "");
        write_scene("", "{voltage: [400, 40000]}", targets[i]);
        open_scene(&linear, "");
        assert_same(&curved, &linear, root_of, limit, 1);
        scene_run_close(&curved);
        scene_run_close(&linear);
    }
}

/* Points of a stack that saturates, of each actuator, at common voltages. */
enum { POINTS = 5 };
static const double point_voltage[POINTS] = {-30, 0, 40, 90, 150};
static const double point_effect[ACTUATORS][POINTS] = {{-0.2, 0, 0.5, 0.9, 1},
                                                       {-0.1, 0, 0.2, 0.6, 1},
                                                       {-0.5, 0, 0.6, 1.1, 1.2},
                                                       {-0.3, 0, 0.4, 0.9, 1}};

/* The voltage of an effect, by the definition of straight segments. */
static double between_points(double effect, int k)
{
    const double *e = point_effect[k];
    int i = 0;
    while (i + 2 < POINTS && effect > e[i + 1])
        i++;
    return point_voltage[i] +
           (point_voltage[i + 1] - point_voltage[i]) * (effect - e[i]) / (e[i + 1] - e[i]);
}

/* Write the points of all actuators to a file, in another order of the columns. */
static void write_points(double factor)
{
    static const int order[ACTUATORS] = {2, 0, 3, 1};
    FILE *file = write_file("curve.csv");
    fputs("v [kV],a3,a1,a4,a2\n", file);
    for (int i = 0; i < POINTS; i++) {
        fprintf(file, "%.17g", point_voltage[i] / 1000);
        for (int k = 0; k < ACTUATORS; k++)
            fprintf(file, ",%.17g", factor * point_effect[order[k]][i]);
        fputc('\n', file);
    }
    assert_int_equal(fclose(file), 0);
}

/*
 * Law: curves of single actuators have the voltages of linear actuators whose limits are the
 * effects at the ends; a curve in another unit, or with the opposite sign, and a matrix in the
 * inverse unit are the same mirror.
 */
static void test_points(void **state)
{
    static const double targets[] = {0.1, 1, 30}, factors[] = {1, 1e-4, -20};
    const double limit[2] = {-30, 150};
    (void)state;
    for (size_t i = 0; i < sizeof targets / sizeof *targets; i++)
        for (size_t j = 0; j < sizeof factors / sizeof *factors; j++) {
            scene_run curved, linear;
            char change[256], keys[96];
            write_points(factors[j]);
            snprintf(keys, sizeof keys, ", scale: %.17g, curve: {file: curve.csv}",
                     1 / fabs(factors[j]));
            const double sign = factors[j] < 0 ? -1 : 1;
            write_scene(keys, "{voltage: [-30, 150]}", sign * targets[i]);
            open_scene(&curved, "");
            write_scene("", "{}", targets[i]);
            snprintf(change, sizeof change,
                     "limits.each=[{actuator: a1, voltage: [-0.2, 1]}, {actuator: a2, voltage: "
                     "[-0.1, 1]}, {actuator: a3, voltage: [-0.5, 1.2]}, {actuator: a4, voltage: "
                     "[-0.3, 1]}]");
            open_scene(&linear, change);
            assert_same(&curved, &linear, between_points, limit, sign);
            scene_run_close(&curved);
            scene_run_close(&linear);
        }
}

/* Law: the shape under given voltages is the matrix of the file times their effects in its unit. */
static void test_given(void **state)
{
    static const double volts[] = {-30, 0, 17, 40, 89, 150};
    (void)state;
    write_points(3);
    write_scene(", curve: {file: curve.csv}", "{voltage: [-30, 150]}", 1);
    scene_run run;
    open_scene(&run, "");
    for (size_t j = 0; j < sizeof volts / sizeof *volts; j++) {
        voltages result;
        double voltage[ACTUATORS];
        for (int k = 0; k < ACTUATORS; k++)
            voltage[k] = k % 2 ? volts[j] : volts[(j + 1) % 6];
        assert_int_equal(voltages_given(&run.analysis, "given", voltage, &result, run.error), 0);
        for (int i = 0; i < OUTPUTS; i++) {
            double shape = 0;
            for (int k = 0; k < ACTUATORS; k++) {
                const double *e = point_effect[k];
                int n = 0;
                while (n + 2 < POINTS && voltage[k] > point_voltage[n + 1])
                    n++;
                shape += 3 * matrix[i][k] *
                         (e[n] + (e[n + 1] - e[n]) * (voltage[k] - point_voltage[n]) /
                                     (point_voltage[n + 1] - point_voltage[n]));
            }
            assert_true(fabs(result.shape[i] - shape) <= 1e-14 * 3 * ACTUATORS);
        }
        voltages_free(&result);
    }
    scene_run_close(&run);
}

/*
 * Law: common limits from outside, as of --limit, narrow the voltages inside the curve and are
 * reached exactly; beyond its ends the ends hold, as without limits.
 */
static void test_other_limits(void **state)
{
    (void)state;
    write_scene(", curve: quadratic", "{voltage: [0, 200]}", 1e6);
    scene_run run;
    open_scene(&run, "");
    const common_limits limits[] = {within(50), within(1000), no_limits(), scene_limits_alone()};
    const double highest[] = {50, 200, 200, 200};
    for (int j = 0; j < 4; j++) {
        voltages result;
        double most = 0;
        optimum(&run, limits[j], &result);
        for (int k = 0; k < ACTUATORS; k++) {
            most = fmax(most, result.voltage[k]);
            assert_true(result.voltage[k] >= 0);
        }
        assert_true(most == highest[j] && result.limit[0] == 0 && result.limit[1] == highest[j]);
        voltages_free(&result);
    }
    voltages result;
    const common_limits beyond = {.source = LIMITS_GIVEN, .lower = 300, .upper = 400};
    assert_true(voltages_optimum(&run.analysis, beyond, &result, run.error) < 0);
    assert_non_null(strstr(run.error, "the ends of its actuator curve"));
    voltages_free(&result);
    scene_run_close(&run);
}

/* ---- control loop ------------------------------------------------------- */

/* Simulate the controller, and copy its shape at the end. Returns its course. */
static simulate_course simulated(scene_run *run, double shape[OUTPUTS])
{
    simulation simulation;
    if (simulate_open(&simulation, &run->analysis, run->error) < 0 ||
        simulate_run(&simulation, LAW_CONTROLLER, NULL, NULL, run->error) < 0 ||
        simulate_run(&simulation, LAW_CLAMP, NULL, NULL, run->error) < 0 ||
        simulate_run(&simulation, LAW_REGULARISED, NULL, NULL, run->error) < 0 ||
        simulate_optima(&simulation, run->error) < 0)
        fail_msg("%s", run->error);
    simulate_course course = simulation.phase[0].course[LAW_CONTROLLER];
    assert_int_equal(simulation.count[LAW_CONTROLLER].beyond_limits, 0);
    assert_int_equal(simulation.count[LAW_CLAMP].beyond_limits, 0);
    assert_int_equal(simulation.count[LAW_CONTROLLER].not_finite, 0);
    /* The optimum is that of a plant whose effects have the same ends. */
    assert_near("optimum", course.steady, simulation.phase[0].optimum, 1e-6);
    memcpy(shape, course.shape, OUTPUTS * sizeof *shape);
    simulate_close(&simulation);
    return course;
}

/*
 * Law: the loop reaches the best shape, also where the curves of the mirror differ from those of
 * the controller by 10 % of their range and where readings are late, with the step limits of the
 * voltages kept; on a mirror without errors it is the shape that linear actuators with the same
 * effects reach.
 */
static void test_loop(void **state)
{
    static const char *const changes[] = {
        "",
        "simulate.plant={curve_error: 0.1}",
        "simulate.plant={curve_error: -0.1}",
        "simulate.sensors={delay: 2}",
        "simulate.plant={curve_error: 0.1, gain: 0.9};limits.step_limit=7",
        "simulate.plant={curve_error: -0.1};limits.step_limit=7;simulate.sensors={delay: 1}",
    };
    double shape[OUTPUTS], expected[OUTPUTS];
    (void)state;
    write_scene("", "{voltage: [0, 40000]}", 5e3);
    scene_run linear, curved;
    open_scene(&linear, "");
    (void)simulated(&linear, expected);
    scene_run_close(&linear);
    write_scene(", curve: quadratic", "{voltage: [0, 200]}", 5e3);
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        open_scene(&curved, changes[i]);
        const simulate_course course = simulated(&curved, shape);
        assert_true(course.settled >= 0 && course.settled < 45);
        for (int k = 0; k < OUTPUTS; k++)
            assert_true(i == 4 || fabs(shape[k] - expected[k]) <= 1e-5 * 5e3);
        scene_run_close(&curved);
    }
    /* A curve whose effect at 0 V is not 0, beside the regularised law. */
    write_scene(", curve: [[0, 1e4], [200, 5e4]]", "{voltage: [0, 200]}", 5e3);
    open_scene(&curved, "");
    (void)simulated(&curved, shape);
    scene_run_close(&curved);
}

/* ---- refused ------------------------------------------------------------ */

/* Law: a curve that is no curve, or that the limits or the loop contradict, has one message. */
static void test_refused(void **state)
{
    static const refusal bad[] = {
        {"influence.curve=cubic", "known: quadratic"},
        {"influence.curve=[[0, 0]]", "a curve of 1 points; write 2 to 128 points"},
        {"influence.curve=[[0, 0], [200]]", "a point of 1 numbers; write [voltage, effect]"},
        {"influence.curve=[[0, 0], [.nan, 1]]", "a number is wanted here"},
        {"influence.curve=[[0, 0], [100, 1], [100, 2], [200, 3]]",
         "the voltage of point 3, 100, follows 100; sort the points"},
        {"influence.curve=[[200, 0], [0, 1]]", "the voltage of point 2, 0, follows 200"},
        {"influence.curve=[[0, 0], [100, 2], [150, 2], [200, 3]]",
         "the effect goes from 2 at 100 to 2 at 150; it must rise everywhere, or fall everywhere"},
        {"influence.curve=[[0, 0], [100, 0.5], [100.000001, 0.6], [200, 1]]",
         "are the same in single precision; leave one of them out"},
        {"influence.curve=[[0, 0], [100, 0.5], [110, 0.50000000001], [200, 1]]",
         "are the same in single precision; leave one of them out"},
        {"influence.curve=[[0, 0], [199, 1]]",
         "the curve of 'a1' goes from 0 to 199 V, and its voltage limits from 0 to 200 V"},
        {"influence.curve=[[1, 0], [200, 1]]", "the curve of 'a1' goes from 1 to 200 V"},
        {"limits.voltage=[-1, 200]", "quadratic, but 'a1' goes down to -1 V"},
        {"limits.each=[{actuator: a3, voltage: [-9, 5]}]", "quadratic, but 'a3' goes down to -9 V"},
        {"limits.voltage=[0, 0]", "no voltage limit is above 0"},
        {"limits={}", "an actuator curve needs limits of the voltages, and 'a1' has none"},
        {"influence.curve={file: missing.csv}", "missing.csv: cannot read it"},
        {"influence.curve={file: curve.csv}", "has 2 columns of effects for 4 actuators"},
        {"limits.difference={limit: 3}", "influence.curve does not go together with limits"},
        {"safety={selftest: {amplitude: 3}}",
         "influence.curve does not go together with safety.selftest"},
        {"hysteresis={range: [0, 200], slopes: [1, 1, 1, 1], slack: [5], above: [0.1]}",
         "influence.curve does not go together with hysteresis"},
        {"simulate.events=[{at: 3, dead: [a1], announced: detected}]",
         "influence.curve does not go together with detected faults"},
        {"simulate.plant={curve_error: 0.3}", "must lie between -0.2 and 0.2"},
    };
    (void)state;
    write_text("curve.csv", "v,a,b\n0,0,0\n200,1,1\n");
    write_scene(", curve: quadratic", "{voltage: [0, 200]}", 1);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char error[SCENE_ERROR] = "no fault";
        scene scene;
        if (scene_read(&scene, path_of("scene.yaml"), &bad[i].set, 1, error) == 0)
            scene_free(&scene);
        if (!strstr(error, bad[i].expected) || strchr(error, '\n'))
            fail_msg("%s: expected '%s', got '%s'", bad[i].set, bad[i].expected, error);
    }
}

/* Law: files of curves with wrong entries are refused with their place, a file of NaN too. */
static void test_refused_files(void **state)
{
    static const struct {
        const char *text, *expected;
    } bad[] = {
        {"v,e\n0,0\n100,nan\n200,1\n", "line 3, column 2 is nan"},
        {"v,a1,a2,a3,b4\n0,0,0,0,0\n200,1,1,1,1\n", "no column with the name of actuator 'a4'"},
        {"v\n0\n200\n", "has one column; write two"},
        {"v [m],e\n0,0\n200,1\n", "the column 'v [m]' of the file has a unit"},
        {"v,a1,a2,a3,a4\n0,0,0,0,0\n100,1,1,1,1\n200,2,2,1,2\n",
         "curve of a3: the effect goes from 1 at 100 to 1 at 200"},
    };
    (void)state;
    write_scene(", curve: {file: curve.csv}", "{voltage: [0, 200]}", 1);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char error[SCENE_ERROR] = "no fault";
        scene scene;
        write_text("curve.csv", "%s", bad[i].text);
        if (scene_read(&scene, path_of("scene.yaml"), NULL, 0, error) == 0)
            scene_free(&scene);
        if (!strstr(error, bad[i].expected) || strchr(error, '\n'))
            fail_msg("expected '%s', got '%s'", bad[i].expected, error);
    }
}

/*
 * Law: regularisation, which draws effects to 0, is accepted where 0 V has the effect 0, also
 * between two points and up to rounding, and refused elsewhere.
 */
static void test_reference(void **state)
{
    static const char *const good[] = {"quadratic", "[[-60, -0.3], [140, 0.7], [200, 2]]",
                                       "[[0, 0], [200, 1]]"};
    (void)state;
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        char keys[128];
        snprintf(keys, sizeof keys, ", curve: %s", good[i]);
        write_scene(keys, "{voltage: [0, 200], regularisation: {relative: 1e-3}}", 1);
        scene_run run;
        double shape[OUTPUTS];
        open_scene(&run, "simulate.plant={scatter: 0}");
        simulation simulation;
        if (simulate_open(&simulation, &run.analysis, run.error) < 0 ||
            simulate_run(&simulation, LAW_CONTROLLER, NULL, NULL, run.error) < 0)
            fail_msg("%s", run.error);
        memcpy(shape, simulation.phase[0].course[LAW_CONTROLLER].shape, sizeof shape);
        assert_true(isfinite(shape[0]));
        simulate_close(&simulation);
        scene_run_close(&run);
    }
    write_scene(", curve: [[0, 1], [200, 2]]",
                "{voltage: [0, 200], regularisation: {relative: 1e-3}}", 1);
    char error[SCENE_ERROR];
    scene scene;
    assert_true(scene_read(&scene, path_of("scene.yaml"), NULL, 0, error) < 0);
    assert_non_null(strstr(error, "0 V has the effect 1; subtract this effect"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_square),        cmocka_unit_test(test_points),
        cmocka_unit_test(test_given),         cmocka_unit_test(test_other_limits),
        cmocka_unit_test(test_loop),          cmocka_unit_test(test_refused),
        cmocka_unit_test(test_refused_files), cmocka_unit_test(test_reference)};
    return cmocka_run_group_tests(tests, set_up, remove_test_folder);
}
