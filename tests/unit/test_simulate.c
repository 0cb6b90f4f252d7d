/*
 * Laws of the closed loop: volts inside every limit whatever fails, no drift, the plant's optimum
 * where the model's shape is right.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
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
#include "../../lib/core/guard.h"
#include "../rigs/scene_assert.h"
#include "../../host_tools/simulate/simulate_loop.h"

#ifndef FAULT_TICKS
#define FAULT_TICKS 20000
#endif

#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)

#define LINEAR                                                                                     \
    "kinematics=linear;simulate.influence=undeformed;simulate.plant.kinematics=linear;"            \
    "simulate.sensors."                                                                            \
    "noise=0;simulate.amplifiers.step=0;"

typedef struct bench {
    scene_run run;
    simulation s;
    char error[SCENE_ERROR];
} bench;

/* The laws of this file are those of a quasi-static plant without hysteresis; test_plant.c has the
 * others. */
static void open_bench(bench *b, const char *changes)
{
    char all[2000];
    memset(b, 0, sizeof *b);
    snprintf(all, sizeof all, "simulate.plant.inertia=false;simulate.plant.hysteresis=0;%s",
             changes);
    open_run(&b->run, "plate-closed-loop", all);
    if (analysis_influence(&b->run.analysis, b->error) < 0 ||
        simulate_open(&b->s, &b->run.analysis, b->error) < 0)
        fail_msg("%s", b->error);
}

static void close_bench(bench *b)
{
    simulate_close(&b->s);
    scene_run_close(&b->run);
}

/* An onlooker's own count, apart from the simulation's. */
typedef struct tally {
    const design *d;
    double volt[64], command[64];
    long outside, jumps, off_step, not_finite;
    double step;
    uint32_t crc;
} tally;

static void look(void *context, const simulate_sample *sample)
{
    tally *t = context;
    for (int k = 0; k < t->d->amplifiers; k++) {
        const double voltage = sample->voltage[k], command = sample->command[k],
                     steps = t->step > 0 ? voltage / t->step : 0;
        t->not_finite += !isfinite(voltage) + !isfinite(command) + !isfinite(sample->error);
        t->outside += !(voltage >= t->d->lower[k] && voltage <= t->d->upper[k]);
        t->outside += !(command >= t->d->lower[k] && command <= t->d->upper[k]);
        t->jumps += !(fabs(voltage - t->volt[k]) <= t->d->step_limit[k]) +
                    !(fabs(command - t->command[k]) <= t->d->step_limit[k]);
        t->off_step += fabs(steps - round(steps)) > 8 * DBL_EPSILON * fabs(steps);
        t->volt[k] = voltage;
        t->command[k] = command;
    }
    t->crc =
        pzs_guard_crc(t->crc, sample->voltage, (size_t)t->d->amplifiers * sizeof *sample->voltage);
}

static void run(bench *b, simulate_law law, tally *t)
{
    memset(t, 0, sizeof *t);
    t->d = &b->run.analysis.design;
    t->step = b->run.scene.simulate.step;
    t->crc = GUARD_CRC_START;
    assert_in_range(t->d->amplifiers, 1, 64);
    if (simulate_run(&b->s, law, look, t, b->error) < 0)
        fail_msg("%s", b->error);
}

static void find_optima(bench *b)
{
    if (simulate_optima(&b->s, b->error) < 0)
        fail_msg("%s", b->error);
}

static const simulate_course *course(const bench *b, int phase)
{
    return &b->s.phase[phase].course[LAW_CONTROLLER];
}

/* ---- the loop --------------------------------------------------------- */

/* Same scene, same bits; another seed, other noise. */
static void test_deterministic(void **state)
{
    static const char *const seed[3] = {"simulate.seed=7", "simulate.seed=7", "simulate.seed=8"};
    uint32_t crc[3];
    (void)state;
    for (int i = 0; i < 3; i++) {
        char changes[300];
        bench b;
        tally t;
        snprintf(
            changes, sizeof changes,
            "kinematics=linear;simulate.influence=undeformed;simulate.plant.kinematics=linear;%s",
            seed[i]);
        open_bench(&b, changes);
        run(&b, LAW_CONTROLLER, &t);
        crc[i] = t.crc;
        run(&b, LAW_CONTROLLER, &t);
        assert_int_equal(t.crc, crc[i]);
        close_bench(&b);
    }
    assert_int_equal(crc[0], crc[1]);
    assert_int_not_equal(crc[0], crc[2]);
}

/*
 * On a linear plant whose influence is the model's but for a factor, integral action ends at the
 * plant's own bounded optimum under every load and target, for each delay of the sensors, weaker or
 * stronger than believed. Where it is not at a limit the misfit shrinks by |1 - d| a tick, so the
 * ends agree to the optimiser's rounding. With hysteresis the bounds of that optimum are the stroke
 * of the electrodes.
 */
static void test_reaches_optimum(void **state)
{
    static const char *const plant[] = {"simulate.plant.d=0.8",
                                        "simulate.plant.d=1.2;simulate.sensors.delay=1",
                                        "simulate.plant.d=1.2;simulate.sensors.delay=3",
                                        "simulate.plant.stiffness=0.5",
                                        "simulate.plant.hysteresis=0.1",
                                        "simulate.plant.hysteresis=0.2;simulate.plant.d=0.8"};
    (void)state;
    for (size_t i = 0; i < sizeof plant / sizeof *plant; i++) {
        char changes[600];
        bench b;
        tally t;
        snprintf(changes, sizeof changes,
                 LINEAR
                 "%s;simulate.ticks=600;simulate.events=[{at: 0, load: 0, factor: 0}, {at: 200, "
                 "load: 0, factor: 2}, {at: 400, value: -0.05*x^2}]",
                 plant[i]);
        open_bench(&b, changes);
        run(&b, LAW_CONTROLLER, &t);
        find_optima(&b);
        assert_int_equal(b.s.phases, 3);
        for (int k = 0; k < 3; k++)
            if (!(fabs(course(&b, k)->steady / b.s.phase[k].optimum - 1) < 1e-9))
                fail_msg("%s, phase %d: steady %.12g, optimum %.12g", plant[i], k,
                         course(&b, k)->steady, b.s.phase[k].optimum);
        close_bench(&b);
    }
}

/*
 * Hysteresis of the width h leaves an electrode at a voltage limit A the stroke (1 - h) A. So a
 * loop around a plant with hysteresis ends where a loop with limits of (1 - h) A ends around the
 * plant without hysteresis, and that is the optimum which is printed.
 */
static void test_stroke(void **state)
{
    double steady[2], optimum[2];
    (void)state;
    for (int i = 0; i < 2; i++) {
        bench b;
        tally t;
        open_bench(&b, i ? LINEAR "simulate.ticks=200;simulate.events=[];limits.voltage=[-270, 270]"
                         : LINEAR "simulate.ticks=200;simulate.events=[];"
                                  "simulate.plant.hysteresis=0.1");
        run(&b, LAW_CONTROLLER, &t);
        find_optima(&b);
        steady[i] = course(&b, 0)->steady;
        optimum[i] = b.s.phase[0].optimum;
        close_bench(&b);
    }
    assert_near("optimum within the stroke", optimum[0] / optimum[1], 1, 1e-12);
    assert_near("end of the loop with hysteresis", steady[0] / optimum[0], 1, 1e-9);
    assert_near("end of the loop with smaller limits", steady[1] / optimum[0], 1, 1e-9);
}

/*
 * Every event of the shipped schedule: limits, slew and steps of the converter hold on every tick,
 * for all laws.
 */
static void test_inside_limits(void **state)
{
    bench b;
    tally t;
    (void)state;
    open_bench(
        &b, "kinematics=linear;simulate.influence=undeformed;simulate.plant={kinematics: linear, "
            "d: 0.8, stiffness: 1.1, hysteresis: 0.1, inertia: false};"
            "simulate.amplifiers={step: 0.05, dead_band: 0.1};simulate.sensors={noise: "
            "1e-6, delay: 2}");
    for (int law = 0; law < LAWS; law++) {
        run(&b, (simulate_law)law, &t);
        assert_int_equal(t.outside + t.not_finite + t.off_step, 0);
        assert_int_equal(b.s.count[law].beyond_limits + b.s.count[law].not_finite, 0);
        assert_true(t.jumps <= 4); /* the two dead electrodes, told: command and amplifier jump to 0
                                      V */
        assert_int_equal(b.s.count[law].missed_ticks, 20);
    }
    assert_int_equal(b.s.count[LAW_CONTROLLER].status[PZS_W_HELD], 10);
    assert_true(b.s.count[LAW_CONTROLLER].status[PZS_W_SENSOR] >= 30);
    close_bench(&b);
}

/* What is often done instead is never better, and with limits that matter it is worse. */
static void test_clamp_is_worse(void **state)
{
    bench b;
    tally t;
    (void)state;
    open_bench(&b, LINEAR "simulate.ticks=200;simulate.events=[]");
    run(&b, LAW_CONTROLLER, &t);
    run(&b, LAW_CLAMP, &t);
    assert_true(b.s.phase[0].course[LAW_CLAMP].steady > 2 * course(&b, 0)->steady);
    run(&b, LAW_REGULARISED, &t);
    assert_true(b.s.phase[0].course[LAW_REGULARISED].steady > 1.02 * course(&b, 0)->steady);
    assert_true(b.s.phase[0].course[LAW_REGULARISED].steady <
                0.5 * b.s.phase[0].course[LAW_CLAMP].steady);
    close_bench(&b);
    open_bench(&b, LINEAR "limits.voltage=[-2000, 2000];simulate.ticks=300;simulate.events=[]");
    run(&b, LAW_CONTROLLER, &t);
    run(&b, LAW_CLAMP, &t);
    assert_true(fabs(b.s.phase[0].course[LAW_CLAMP].steady / course(&b, 0)->steady - 1) < 1e-6);
    run(&b, LAW_REGULARISED, &t);
    assert_true(fabs(b.s.phase[0].course[LAW_REGULARISED].steady / course(&b, 0)->steady - 1) <
                1e-5);
    close_bench(&b);
}

/* ---- faults ----------------------------------------------------------- */

/* All sensors gone: volts held to the last bit; afterwards the loop goes on as if nothing had been.
 */
static void test_blind(void **state)
{
    bench b;
    loop loop;
    double before[64];
    (void)state;
    open_bench(&b, LINEAR
               "simulate.ticks=300;simulate.events=[{at: 100, missing_sensors: 1, ticks: 20}, {at: "
               "110, load: 0, factor: 2}, "
               "{at: 200, missed_ticks: 7}]");
    assert_int_equal(loop_open(&loop, &b.s, LAW_CONTROLLER, b.error), 0);
    const size_t bytes = (size_t)loop.design->amplifiers * sizeof *before;
    for (int tick = 0; tick < 300; tick++) {
        memcpy(before, loop.output, bytes);
        assert_int_equal(loop_tick(&loop, tick, b.error), 0);
        const int blind = tick >= 100 && tick < 120, lost = tick >= 200 && tick < 207;
        assert_int_equal(loop.is_missed, lost);
        if (!lost)
            assert_int_equal(loop.status, blind ? PZS_W_HELD : PZS_OK);
        if (blind || lost)
            assert_memory_equal(before, loop.output, bytes);
    }
    loop_close(&loop);
    tally t;
    run(&b, LAW_CONTROLLER, &t);
    find_optima(&b);
    assert_true(fabs(course(&b, b.s.phases - 1)->steady / b.s.phase[b.s.phases - 1].optimum - 1) <
                1e-9);
    close_bench(&b);
}

/*
 * Random faults of every kind: no limit violated, nothing but numbers; once they end, the same end
 * as without any, to rounding: nothing has drifted. first in  an event at the start
 */
static void random_faults(const char *first)
{
    char changes[600];
    bench b;
    tally t;
    open_bench(&b, LINEAR "simulate.ticks=300;simulate.events=[]");
    run(&b, LAW_CONTROLLER, &t);
    const double steady = course(&b, 0)->steady;
    close_bench(&b);
    snprintf(changes, sizeof changes,
             LINEAR
             "simulate.ticks=" TEXT(FAULT_TICKS) ";simulate.events=[%s];simulate.faults={chance: "
                                                 "0.05, until: " TEXT(FAULT_TICKS) "-300}",
             first);
    open_bench(&b, changes);
    run(&b, LAW_CONTROLLER, &t);
    const simulate_count *count = &b.s.count[LAW_CONTROLLER];
    assert_int_equal(t.outside + t.not_finite, 0);
    assert_int_equal(count->beyond_limits + count->not_finite, 0);
    assert_int_equal(count->status[PZS_W_ITERATIONS], 0);
    assert_true(count->missed_ticks > FAULT_TICKS / 100 &&
                count->status[PZS_W_HELD] > FAULT_TICKS / 100 &&
                count->status[PZS_W_SENSOR] > FAULT_TICKS / 20);
    assert_int_equal(b.s.phases, 2);
    if (!(fabs(course(&b, 1)->steady / steady - 1) < 1e-9))
        fail_msg("ends at %.12g instead of %.12g", course(&b, 1)->steady, steady);
    close_bench(&b);
}

static void test_random_faults(void **state)
{
    (void)state;
    random_faults("");
}

/* The same with a controller that looks for dead and stuck electrodes by itself. */
static void test_random_faults_found(void **state)
{
    (void)state;
    random_faults("{at: 0, dead: [v_1_1], announced: detected}");
}

/* Told or not, the other electrodes take over from dead ones; a dead electrode does nothing. */
static void test_dead(void **state)
{
    static const char *const told[] = {"", ", announced: 5"};
    (void)state;
    for (int i = 0; i < 2; i++) {
        char changes[500];
        bench b;
        tally t;
        snprintf(changes, sizeof changes,
                 LINEAR "simulate.ticks=400;simulate.events=[{at: 100, dead: [v_1_1, v_3_2]%s}, "
                        "{at: 250, alive: [v]}]",
                 told[i]);
        open_bench(&b, changes);
        run(&b, LAW_CONTROLLER, &t);
        find_optima(&b);
        for (int k = 0; k < 3; k++)
            assert_true(fabs(course(&b, k)->steady / b.s.phase[k].optimum - 1) < 1e-9);
        assert_true(b.s.phase[1].optimum > 1.2 * b.s.phase[0].optimum);
        close_bench(&b);
    }
}

/* A full cycle of the volts leaves a loop as wide as `hysteresis` says, and no more than that of
 * the volts is lost. */
static void test_hysteresis(void **state)
{
    bench b;
    loop loop;
    double at_zero[2] = {0, 0};
    (void)state;
    open_bench(&b, LINEAR "simulate.ticks=100;simulate.plant.hysteresis=0.15;"
                          "simulate.events=[{at: 0, missed_ticks: 100}]");
    assert_int_equal(loop_open(&loop, &b.s, LAW_CONTROLLER, b.error), 0);
    for (int tick = 0; tick < 60; tick++) {
        const int phase = tick % 40;
        const int fall = phase < 30 ? 20 - phase : phase - 40;
        loop.output[3] = 300 * (phase < 10 ? phase : fall) / 10.0;
        assert_int_equal(loop_tick(&loop, tick, b.error), 0);
        assert_true(fabs(loop.effect[3] - loop.output[3]) <= 0.15 * 300 * (1 + 4 * DBL_EPSILON));
        if (tick == 20 || tick == 40)
            at_zero[tick / 20 - 1] = loop.effect[3];
    }
    assert_true(fabs(at_zero[0] - at_zero[1] - 0.15 * 600) < 1e-12 * 600);
    loop_close(&loop);
    close_bench(&b);
}

/* ---- a nonlinear plant ------------------------------------------------ */

/* Steady error over the optimum in two phases, a load step in between. */
static void hold_shape(const char *influence, double over[2])
{
    char changes[200];
    bench b;
    tally t;
    snprintf(
        changes, sizeof changes,
        "simulate.influence=%s;simulate.ticks=90;simulate.events=[{at: 50, load: 0, factor: 2}]",
        influence);
    open_bench(&b, changes);
    run(&b, LAW_CONTROLLER, &t);
    find_optima(&b);
    assert_int_equal(t.outside + t.jumps + t.not_finite, 0);
    for (int k = 0; k < 2; k++)
        over[k] = course(&b, k)->steady / b.s.phase[k].optimum;
    assert_in_range(course(&b, 1)->settled, 1, course(&b, 1)->step_limit_ticks + 10);
    print_message("influence at %s: %.3f and %.3f %% above the optimum of the plant, load step "
                  "gone after %d ticks (slew alone %d)\n",
                  influence, 100 * (over[0] - 1), 100 * (over[1] - 1), course(&b, 1)->settled,
                  course(&b, 1)->step_limit_ticks);
    close_bench(&b);
}

/*
 * 10 % wrong stiffness, 20 % wrong d31, noise and DAC steps, a nonlinear plate: with tables made at
 * the nonlinear optimum the steady error is within 2 % of the best this plant allows, and a load
 * step is gone to 5 % ten ticks after the slew alone would allow. Tables made at rest are not as
 * good: the directions of the tangent are others.
 */
static void test_nonlinear_plant(void **state)
{
    double target[2], rest[2];
    (void)state;
    hold_shape("target", target);
    hold_shape("undeformed", rest);
    for (int k = 0; k < 2; k++)
        assert_true(target[k] < 1.02 && target[k] < rest[k]);
}

/*
 * The same plate: two electrodes die at once. The controller finds both by itself and the shape
 * settles within 20 ticks, its error within 10 % of the optimum without them; no other electrode is
 * blamed, neither for load steps nor heat.
 */
static void test_finds_dead(void **state)
{
    bench b;
    tally t;
    (void)state;
    open_bench(&b, "simulate.ticks=150;simulate.events=[{at: 40, load: 0, factor: 2}, {at: 60, "
                   "temperature: 30}, {at: 80, "
                   "dead: [v_1_1, v_3_2], announced: detected}]");
    run(&b, LAW_CONTROLLER, &t);
    find_optima(&b);
    const simulate_count *count = &b.s.count[LAW_CONTROLLER];
    print_message("found %ld, the slower after %d ticks; settled after %d; %.2f %% above the "
                  "optimum without them\n",
                  count->detected, count->detection_ticks, course(&b, 3)->settled,
                  100 * (course(&b, 3)->steady / b.s.phase[3].optimum - 1));
    assert_int_equal(t.outside + t.not_finite, 0);
    assert_int_equal(count->detected, 2);
    assert_int_equal(count->falsely_detected, 0);
    assert_in_range(count->detection_ticks, 1, 20);
    assert_in_range(course(&b, 3)->settled, 1, 20);
    assert_true(course(&b, 3)->steady < 1.1 * b.s.phase[3].optimum);
    assert_true(b.s.phase[3].optimum > 1.5 * b.s.phase[2].optimum);
    close_bench(&b);
}

/* ---- bad input -------------------------------------------------------- */

static const refusal bad_sets[] = {
    {"simulate=5", "'simulate' must be a mapping"},
    {"simulate={seed: 10}", "'ticks' is missing in simulate"},
    {"simulate.tick=5", "unknown key 'tick' in simulate; did you mean 'ticks'?"},
    {"simulate.ticks=0", "'ticks: 0' must be from 1 to 10000000 ticks"},
    {"simulate.ticks=1.5", "'ticks: 1.5' must be a whole number"},
    {"control.rate=0", "'rate: 0' must be above 0"},
    {"simulate.seed=-1", "'seed: -1' must be from 0 to 1e9"},
    {"simulate.influence=here",
     "'influence: here' is not known; known: undeformed, loaded, target"},
    {"kinematics=linear",
     "'influence: target' needs the nonlinear structure; write kinematics: nonlinear"},
    {"simulate.plant=soft", "'plant' must be a mapping"},
    {"simulate.plant.kinematics=auto", "'kinematics: auto' is not known; known: linear, nonlinear"},
    {"simulate.plant.stiffness=0", "'stiffness: 0' must be above 0"},
    {"simulate.plant.stiffness={brass: 1}", "there is no material 'brass'"},
    {"simulate.plant.stiffness={G1195: -1}", "'G1195: -1' must be above 0"},
    {"simulate.plant.d=.nan", "is no number or formula"},
    {"simulate.plant.hysteresis=0.4", "'hysteresis: 0.4' must lie between 0 and 0.3"},
    {"simulate.sensors.noise=-1", "'noise: -1' must not be below 0"},
    {"simulate.sensors.delay=17", "'delay: 17' must be from 0 to 16 ticks"},
    {"simulate.sensors.lag=1", "unknown key 'lag' in sensors"},
    {"simulate.amplifiers.step=-1", "'step: -1' must not be below 0"},
    {"simulate.amplifiers.dead_band=-1", "'dead_band: -1' must not be below 0"},
    {"simulate.faults={until: 5}", "'chance' is missing in faults"},
    {"simulate.faults={chance: 2}", "'chance: 2' must lie between 0 and 1"},
    {"simulate.faults={chance: 0.1, until: 0}", "'until: 0' must be from 1"},
    {"simulate.events={at: 5}", "unknown key 'at' in events; known: file"},
    {"simulate.events=[{target: 1}]", "'at' is missing in"},
    {"simulate.events=[{at: 5}]", "an event needs one of target, value, load"},
    {"simulate.events=[{at: -1, target: 1}]", "'at: -1' must be a tick from 0"},
    {"simulate.events=[{at: 1900, target: 1}]",
     "'at: 1900' is after the end; the simulation has 1900 ticks"},
    {"simulate.events=[{at: 5, target: 1}, {at: 4, target: 1}]", "tick 4 comes after tick 5"},
    {"simulate.events=[{at: 5, target: 1, missed_ticks: 2}]", "an event is one thing"},
    {"simulate.events=[{at: 5, target: x}]", "'target: x' varies over the surface"},
    {"simulate.events=[{at: 5, value: w}]", "unknown name"},
    {"simulate.events=[{at: 5, load: 1, factor: 1}]",
     "there is no load 1; the scene has 1, the first is 0"},
    {"simulate.events=[{at: 5, load: 0}]", "a load needs a factor"},
    {"simulate.events=[{at: 5, target: 1, factor: 1}]", "'factor' belongs to a load; remove it"},
    {"simulate.events=[{at: 5, temperature: y}]", "'temperature: y' varies over the surface"},
    {"simulate.events=[{at: 5, dead: v_1_1}]", "'dead' must be a list"},
    {"simulate.events=[{at: 5, dead: [v_9_9]}]",
     "there is no actuator 'v_9_9'; the first one is 'v_1_1'"},
    {"simulate.events=[{at: 5, dead: [v, v]}]", "'v' makes more electrodes than there are"},
    {"simulate.events=[{at: 5, stuck: [[v]]}]", "must be a single value, not a list"},
    {"simulate.events=[{at: 5, alive: [v], announced: 3}]",
     "'announced' belongs to dead and stuck electrodes"},
    {"simulate.events=[{at: 5, dead: [v], announced: -3}]",
     "'announced: -3' must be ticks from 0, or detected"},
    {"simulate.events=[{at: 5, stuck: [v], announced: soon}]", "'announced: soon' is no number"},
    {"simulate.events=[{at: 5, missing_sensors: 1, ticks: 2, announced: detected}]",
     "'announced' belongs to dead and stuck electrodes"},
    {"simulate.events=[{at: 5, missing_sensors: 0.5}]",
     "this event lasts for some ticks; add ticks: 20"},
    {"simulate.events=[{at: 5, missing_sensors: 1.5, ticks: 5}]",
     "'missing_sensors: 1.5' must lie between 0 and 1"},
    {"simulate.events=[{at: 5, stuck_sensors: 0.5, ticks: 0}]", "'ticks: 0' must be from 1"},
    {"simulate.events=[{at: 5, missed_ticks: 0}]", "'missed_ticks: 0' must be from 1"},
    {"simulate.events=[{at: 5, missed_ticks: 2, ticks: 2}]",
     "'ticks' belongs to missing_sensors, stuck_sensors"},
};

/* A wrong value is refused with its place and a cure. */
static void test_bad_input(void **state)
{
    (void)state;
    assert_refused("plate-closed-loop", bad_sets, sizeof bad_sets / sizeof *bad_sets);
}

/* What only the whole structure shows. */
static void test_bad_structure(void **state)
{
    bench b;
    (void)state;
    memset(&b, 0, sizeof b);
    assert_int_equal(scene_run_open(&b.run, "plate-closed-loop",
                                    LINEAR "limits={step_limit: 20};simulate.plant.hysteresis=0.1"),
                     0);
    assert_int_equal(analysis_influence(&b.run.analysis, b.error), 0);
    assert_int_equal(simulate_open(&b.s, &b.run.analysis, b.error), -1);
    assert_non_null(
        strstr(b.error, "hysteresis is a part of the range of the voltages; add limits"));
    scene_run_close(&b.run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_deterministic),
                                       cmocka_unit_test(test_reaches_optimum),
                                       cmocka_unit_test(test_stroke),
                                       cmocka_unit_test(test_inside_limits),
                                       cmocka_unit_test(test_clamp_is_worse),
                                       cmocka_unit_test(test_blind),
                                       cmocka_unit_test(test_random_faults),
                                       cmocka_unit_test(test_random_faults_found),
                                       cmocka_unit_test(test_dead),
                                       cmocka_unit_test(test_hysteresis),
                                       cmocka_unit_test(test_nonlinear_plant),
                                       cmocka_unit_test(test_finds_dead),
                                       cmocka_unit_test(test_bad_input),
                                       cmocka_unit_test(test_bad_structure)};
    return cmocka_run_group_tests_name("simulate", tests, NULL, NULL);
}
