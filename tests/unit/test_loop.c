/*
 * Laws of what stands beside the controller in a closed loop: few sensors, known loads, steps of
 * amplifiers, late readings.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../rigs/scene_assert.h"
#include "../../host_tools/simulate/simulate_loop.h"

/* A linear plant that is the model's own. */
#define EXACT                                                                                      \
    "kinematics=linear;simulate.influence=undeformed;simulate.plant={kinematics: "                 \
    "linear, hysteresis: 0, inertia: false};simulate.sensors={delay: 0};simulate.amplifiers.step=0;"

/* Limits that do not matter. */
#define FREE                                                                                       \
    "limits={voltage: [-1e5, 1e5], step_limit: 1e9, regularisation: 0};estimate.voltages=30;"

/* The plate bent by its upper patches; its lower ones are sensors, two read by volts and the others
 * by charge. */
#define ELECTRIC                                                                                   \
    "materials.G1195.permittivity=1.5e-8;actuators.0.drives=[{patches: up}];patches.1.grid=[1, "   \
    "2];"                                                                                          \
    "sensors=[{name: s, drives: [{patches: low}]}];outputs=[{name: volts, voltage: s}, {name: "    \
    "charges, charge: v}];"                                                                        \
    "estimate={readings: [{output: volts, noise: 1e-3}, {output: charges, noise: 1e-12}]};"

typedef struct bench {
    scene_run run;
    simulation s;
    loop l;
    char error[SCENE_ERROR];
} bench;

static void open_bench(bench *b, const char *changes)
{
    memset(b, 0, sizeof *b);
    char all[2000];
    snprintf(all, sizeof all, "simulate.plant.inertia=false;simulate.plant.hysteresis=0;%s",
             changes);
    open_run(&b->run, "plate-few-sensors", all);
    if (analysis_influence(&b->run.analysis, b->error) < 0 ||
        simulate_open(&b->s, &b->run.analysis, b->error) < 0 ||
        loop_open(&b->l, &b->s, LAW_CONTROLLER, b->error) < 0)
        fail_msg("%s", b->error);
}

static void close_bench(bench *b)
{
    loop_close(&b->l);
    simulate_close(&b->s);
    scene_run_close(&b->run);
}

static void tick(bench *b, int at)
{
    if (loop_tick(&b->l, at, b->error) < 0)
        fail_msg("%s", b->error);
    assert_int_equal(b->l.beyond_limits + b->l.not_finite, 0);
}

/* The best error of the plant under the conditions that the phases end with. */
static void optima(bench *b)
{
    if (simulate_run(&b->s, LAW_CONTROLLER, NULL, NULL, b->error) < 0 ||
        simulate_optima(&b->s, b->error) < 0)
        fail_msg("%s", b->error);
}

/* ---- few sensors ------------------------------------------------------ */

/* What the loop does not see of a load, in whatever volts, is what the gains leave of its shape;
 * the rest is noise. */
static void test_sees_what_gains_see(void **state)
{
    bench b;
    (void)state;
    open_bench(&b, EXACT "simulate.events=[{at: 0, load: 0, factor: 40}]");
    const design *design = &b.run.analysis.design;
    const estimator *estimator = &b.s.estimator;
    const size_t inputs = design->structure.input.count;
    double sum = 0, noise = 0;
    for (int i = 0; i < design->targets; i++) {
        double left = 40 * estimator->shape_per_load[i];
        for (int k = 0; k < estimator->sensors; k++) {
            left -= 40 * estimator->gain[i * estimator->sensors + k] *
                    b.run.analysis.influence[(size_t)design->named_first[k] * inputs +
                                             (size_t)design->amplifiers];
            noise += pow(design->weight[i] * estimator->gain[i * estimator->sensors + k] *
                             b.run.scene.estimate.reading[k].noise,
                         2);
        }
        sum += pow(design->weight[i] * left, 2);
    }
    assert_int_equal(estimator->sensors, 8);
    for (int at = 0; at < 60; at++) {
        tick(&b, at);
        if (!(fabs(b.l.measurement_error - sqrt(sum) / b.s.reference) <=
              6 * sqrt(noise) / b.s.reference))
            fail_msg("tick %d: misses %g, the gains %g", at, b.l.measurement_error,
                     sqrt(sum) / b.s.reference);
    }
    assert_true(sqrt(sum) > 30 * sqrt(noise));
    close_bench(&b);
}

/* Every node read with next to no noise: no more than that is missed, and the loop ends at the
 * optimum of the plant, which is not the model. */
static void test_all_nodes_estimated(void **state)
{
    bench b;
    (void)state;
    open_bench(&b, EXACT "simulate.plant.d=0.8;simulate.sensors.delay=2;simulate.events=[];"
                         "simulate.ticks=300;outputs=[{name: all, u3: middle, at: nodes}];"
                         "estimate.readings=[{output: all, noise: 1e-9}]");
    optima(&b);
    const simulate_phase *phase = &b.s.phase[b.s.phases - 1];
    print_message("every node read: missed %.1e, %.1e above the optimum\n",
                  phase->course[LAW_CONTROLLER].measurement_error,
                  phase->course[LAW_CONTROLLER].steady / phase->optimum - 1);
    assert_true(phase->course[LAW_CONTROLLER].measurement_error <
                6e-9 * sqrt(b.l.sensors) / b.s.reference);
    assert_true(fabs(phase->course[LAW_CONTROLLER].steady / phase->optimum - 1) < 1e-6);
    close_bench(&b);
}

/* Readings that the tables predict under the present command. reading [27] out */
static void predict_readings(const bench *b, double *reading)
{
    const size_t amplifiers = (size_t)b->l.design->amplifiers;
    assert_int_equal(b->l.sensors, 27);
    for (size_t k = 0; k < 27; k++) {
        reading[k] = 0;
        for (size_t j = 0; j < amplifiers; j++)
            reading[k] += b->s.estimator.direct[k * amplifiers + j] * b->l.command[j];
    }
}

/*
 * Volts and charges of electrodes: on the model's own plant they are what the tables say, so
 * nothing is missed but noise; a nonlinear plant's come to the same as the shape goes to rest, and
 * are off by the part that its shape is.
 */
static void test_electrodes_sense(void **state)
{
    double off[2];
    bench b;
    (void)state;
    open_bench(&b, EXACT ELECTRIC "simulate.events=[{at: 0, load: 0, factor: 0}]");
    assert_int_equal(b.l.sensors, 27);
    for (int at = 0; at < 40; at++) {
        double expected[27];
        predict_readings(&b, expected);
        tick(&b, at);
        for (int k = 0; k < b.l.sensors; k++)
            assert_true(fabs(b.l.sensed[k] - expected[k]) <
                        6.01 * b.l.noise[k] + 1e-9 * fabs(expected[k]));
    }
    close_bench(&b);
    for (int i = 0; i < 2; i++) {
        open_bench(&b, i ? EXACT ELECTRIC
                           "simulate.plant={kinematics: nonlinear, hysteresis: 0, inertia: false};"
                           "simulate.events=[{at: 0, load: 0, factor: 0}, {at: 0, target: 0.001}]"
                         : EXACT ELECTRIC
                           "simulate.plant={kinematics: nonlinear, hysteresis: 0, inertia: false};"
                           "simulate.events=[{at: 0, load: 0, factor: 0}, {at: 0, target: 0.01}]");
        off[i] = 0;
        double most = 0;
        double expected[27], reading[27];
        for (int at = 0; at < 12; at++) {
            predict_readings(&b, expected);
            tick(&b, at);
        }
        assert_int_equal(plant_readings(&b.s.plant, reading, b.error), 0);
        for (int k = 0; k < b.l.sensors; k++) {
            const double part = k < 2 ? 1 : 1e-6; /* charges are that much smaller numbers */
            off[i] = fmax(off[i], fabs(reading[k] - expected[k]) / part);
            most = fmax(most, fabs(expected[k]) / part);
        }
        off[i] /= most;
        close_bench(&b);
    }
    print_message(
        "readings of the nonlinear plant off by %.2e at 1 %%, %.2e at 0.1 %% of the target\n",
        off[0], off[1]);
    assert_true(off[0] < 0.05 && off[1] < 0.2 * off[0]);
}

/* The shipped scene: what its `about` says, on the nonlinear plate that the controller does not
 * quite know. */
static void test_shipped(void **state)
{
    bench b;
    (void)state;
    open_bench(
        &b, "simulate.ticks=110;simulate.events=[{at: 0, load: 0, factor: 0, feed_forward: true}, "
            "{at: 40, load: 0, factor: 0.5, feed_forward: true}, "
            "{at: 75, load: 0, factor: 1}]");
    assert_true(b.s.estimator.remaining <=
                b.run.scene.estimate.tolerance * b.s.estimator.disturbed);
    optima(&b);
    for (int k = 0; k < 3; k++) {
        const simulate_course *course = &b.s.phase[k].course[LAW_CONTROLLER];
        print_message("%.3f %% steady, optimum %.3f %%, worst %.3f %%, estimate off by %.3f %%\n",
                      100 * course->steady, 100 * b.s.phase[k].optimum, 100 * course->worst,
                      100 * course->measurement_error);
        assert_true(course->steady < 1.06 * b.s.phase[k].optimum &&
                    course->measurement_error < b.run.scene.estimate.tolerance);
    }
    assert_true(b.s.phase[1].course[0].worst < 1.1 * b.s.phase[1].course[0].steady);
    assert_true(b.s.phase[2].course[0].worst > 2 * b.s.phase[2].course[0].steady);
    close_bench(&b);
}

/* ---- known loads ------------------------------------------------------ */

/*
 * A known load is met before it shows: where no limit is in the way, the tick it comes in has the
 * error of the best volts, whatever the delay and however few the sensors. One that is not known
 * shows in full, `delay` ticks long.
 */
static void test_known_load(void **state)
{
    static const char few[] =
        "simulate.sensors={shape: estimated, delay: "
        "4};estimate.tolerance=0.9;estimate.readings=[{output: tip, noise: 1e-9}, "
        "{output: half_left, noise: 1e-9}]";
    static const char *const sight[] = {
        "simulate.sensors={shape: measured, delay: 0}",
        "simulate.sensors={shape: measured, noise: 1e-13, delay: 4}", few};
    (void)state;
    for (int i = 0; i < 3; i++) {
        char changes[700];
        bench b;
        snprintf(changes, sizeof changes,
                 EXACT FREE
                 "%s;simulate.ticks=90;simulate.events=[{at: 0, load: 0, factor: 0, feed_forward: "
                 "true}, {at: 30, load: 0, factor: 2, feed_forward: true}, "
                 "{at: 60, load: 0, factor: 3}]",
                 sight[i]);
        open_bench(&b, changes);
        const int late = b.run.scene.simulate.delay;
        optima(&b);
        for (int at = 0; at < 90; at++) {
            const double best = b.s.phase[at / 30].optimum;
            tick(&b, at);
            if (at > 0 && at < 60 && !(fabs(b.l.error / best - 1) < 1e-7))
                fail_msg("%s, tick %d: error %g, best %g", sight[i], at, b.l.error, best);
            if (at >= 60 && at <= 60 + late)
                assert_true(b.l.error > 2 * best);
        }
        close_bench(&b);
    }
}

/* ---- amplifiers ------------------------------------------------------- */

/* Whole steps asked for and given; on a plant stronger than believed volts stand still to the last
 * bit at rest. */
static void test_whole_steps(void **state)
{
    double before[64];
    bench b;
    (void)state;
    open_bench(&b, EXACT "simulate.plant.d=1.3;simulate.amplifiers={step: 5, dead_band: "
                         "2};simulate.sensors={shape: measured};simulate.events=[]");
    const size_t n = (size_t)b.l.design->amplifiers;
    for (int at = 0; at < 200; at++) {
        memcpy(before, b.l.output, n * sizeof *before);
        tick(&b, at);
        assert_memory_equal(b.l.output, b.l.command, n * sizeof *before);
        for (size_t k = 0; k < n; k++)
            assert_true(fabs(fmod(b.l.output[k], 5)) < 1e-12);
        if (at >= 150)
            assert_memory_equal(b.l.output, before, n * sizeof *before);
    }
    close_bench(&b);
}

/* ---- late readings ---------------------------------------------------- */

/*
 * On the model's own plant late readings, with a trace of noise so that none stands still, and the
 * model's motion since make the shape of now, to rounding: also in the ticks after an electrode was
 * found dead and held. A controller that is told cannot know since when the electrode was dead, and
 * is right after the delay. Told at once, it is wrong in the tick of the death and in the tick that
 * uses the readings of that tick.
 */
static void test_late_and_dead(void **state)
{
    enum { DELAY = 5 };
    static const char *const told[] = {"announced: 0", "announced: 9", "announced: detected"};
    (void)state;
    for (int i = 0; i < 3; i++) {
        char changes[500];
        bench b;
        int unseen = 0, since = -1;
        snprintf(changes, sizeof changes,
                 EXACT "simulate.sensors={shape: measured, noise: 1e-13, delay: "
                       "5};simulate.ticks=120;simulate.events=[{at: 0, load: 0, "
                       "factor: 0}, {at: 40, dead: [v_1_1, v_3_2], %s}]",
                 told[i]);
        open_bench(&b, changes);
        for (int at = 0; at < 120; at++) {
            tick(&b, at);
            since = since < 0 && b.l.electrode[0].is_held && b.l.electrode[11].is_held ? at : since;
            unseen += b.l.measurement_error > 1e-9;
            const bool is_settled = since >= 0 && at > since + (i < 2 ? DELAY : 0);
            if ((at < 40 || is_settled) && !(b.l.measurement_error < 1e-9))
                fail_msg("%s, tick %d: misses %g", told[i], at, b.l.measurement_error);
        }
        assert_in_range(since, 40, 65);
        assert_true(i == 0 ? unseen == 2 : unseen > 2);
        close_bench(&b);
    }
}

/* ---- bad input -------------------------------------------------------- */

static const refusal bad_sets[] = {
    {"simulate.events=[{at: 5, load: 0, factor: 1, feed_forward: maybe}]",
     "'feed_forward: maybe' is not known"},
    {"simulate.events=[{at: 5, target: 1, feed_forward: true}]",
     "'feed_forward' belongs to a load; remove it"},
    {"simulate.events=[{at: 5, temperature: 20, feed_forward: true}]",
     "a temperature that is fed forward is a load of the scene; add {temperature: 1}"},
    {"simulate.sensors.shape=seen", "'shape: seen' is not known; known: estimated, measured"},
};

/* A wrong value is refused with its place and a cure. */
static void test_bad_input(void **state)
{
    static const refusal unread = {"simulate.sensors.shape=estimated",
                                   "an estimated shape needs readings; add estimate: "};
    (void)state;
    assert_refused("plate-few-sensors", bad_sets, sizeof bad_sets / sizeof *bad_sets);
    assert_refused("plate-closed-loop", &unread, 1);
}

/* Gains of electrodes are made at rest; the other influence is refused, with the reading's name. */
static void test_no_electrodes_at_target(void **state)
{
    bench b;
    (void)state;
    memset(&b, 0, sizeof b);
    assert_int_equal(
        scene_run_open(&b.run, "plate-few-sensors", ELECTRIC "simulate.influence=target"), 0);
    assert_int_equal(analysis_influence(&b.run.analysis, b.error), 0);
    assert_int_equal(simulate_open(&b.s, &b.run.analysis, b.error), -1);
    assert_non_null(strstr(
        b.error, "'volts' is read by an electrode, whose gains are made in the undeformed state; "
                 "write influence: undeformed"));
    scene_run_close(&b.run);
}

/*
 * The voltages of open electrodes would be unknowns of a nonlinear motion: such a plant is refused,
 * also where the nonlinear motion is the default, and the cure is named.
 */
static void test_no_open_electrodes_in_motion(void **state)
{
    static const char *const motion[] = {"simulate.plant={kinematics: nonlinear};",
                                         "simulate.plant={kinematics: nonlinear, steps: 4};"};
    (void)state;
    for (int i = 0; i < 2; i++) {
        bench b;
        char changes[600];
        memset(&b, 0, sizeof b);
        snprintf(changes, sizeof changes, ELECTRIC "simulate.sensors={shape: measured};%s",
                 motion[i]);
        open_run(&b.run, "plate-few-sensors", changes);
        assert_int_equal(analysis_influence(&b.run.analysis, b.error), 0);
        assert_int_equal(simulate_open(&b.s, &b.run.analysis, b.error), -1);
        assert_non_null(strstr(b.error, "not possible with open electrodes; write plant: {motion: "
                                        "modal} in simulate, without steps"));
        scene_run_close(&b.run);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_sees_what_gains_see),
                                       cmocka_unit_test(test_all_nodes_estimated),
                                       cmocka_unit_test(test_electrodes_sense),
                                       cmocka_unit_test(test_shipped),
                                       cmocka_unit_test(test_known_load),
                                       cmocka_unit_test(test_whole_steps),
                                       cmocka_unit_test(test_late_and_dead),
                                       cmocka_unit_test(test_bad_input),
                                       cmocka_unit_test(test_no_electrodes_at_target),
                                       cmocka_unit_test(test_no_open_electrodes_in_motion)};
    return cmocka_run_group_tests_name("loop", tests, NULL, NULL);
}
