/*
 * The supervisor of a loop that damps vibration: amplifiers of the wrong polarity and sensors that
 * are all stuck raise the alarm soon, and structures that merely differ from their model raise
 * none, whatever targets, loads, impulses, hysteresis, converter steps and single stuck electrodes
 * do.
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
#include "../rigs/damped_loop.h"
#include "../rigs/uniform.h"

#ifndef HEALTHY_RUNS
#define HEALTHY_RUNS 30 /* runs without a fault of the loop on each structure */
#endif
enum { RUN_TICKS = 2500 };

/* Structures with a tick rate each. */
typedef struct structure {
    const char *name;
    double interval;
    bool is_plate; /* the plate of the demonstration scene; otherwise a supported plate */
} structure;
static const structure structures[] = {
    {"plate, 15 Hz, 1 kHz", 1e-3, true},
    {"supported plate, 9 Hz, 1 kHz", 1e-3, false},
    {"supported plate, 9 Hz, 250 Hz", 4e-3, false},
};
enum { STRUCTURES = sizeof structures / sizeof *structures };

static void open_structure(modal_structure *s, const structure *from)
{
    static const supported_plate plate = {.length = 3,
                                          .first = 9,
                                          .modes = 40,
                                          .columns = 6,
                                          .rows = 2,
                                          .points_x = 9,
                                          .points_y = 5,
                                          .ratio = 0.005};
    if (from->is_plate)
        structure_of_plate(s, 40);
    else
        structure_of_supported_plate(s, &plate);
}

static pzs_supervisor_mode mode_of(const damped_loop *d)
{
    const pzs_supervisor *supervisor = pzs_loop_find(&d->loop, &pzs_supervisor_block);
    return supervisor->info.mode;
}

static bool is_stopped(const damped_loop *d)
{
    return mode_of(d) == PZS_MODE_STOPPING || mode_of(d) == PZS_MODE_LATCHED;
}

/*
 * Latest tick of the alarm for amplifiers of the wrong polarity: 3 periods of the first mode, 201
 * ticks on the plate of the demonstration scene.
 */
static int latest_alarm(const damped_loop *d)
{
    return 3 * d->supervision.polarity_ticks;
}

/*
 * Let the supervisor judge vibration `times` as slowly, as in a loop that damps so slowly that its
 * certificate needs this.
 */
static void slow_down(damped_loop *d, int times)
{
    d->supervision.alarm_ticks = (uint16_t)(times * d->supervision.alarm_ticks);
    d->supervision.fading = (pzs_real)pow((double)d->supervision.fading, 1.0 / times);
    assert_int_equal(pzs_supervision_seal(&d->supervision), PZS_OK);
}

/* Number of ticks from the start to the alarm under a constant target. */
static int ticks_to_alarm(damped_loop *d, plant_error error)
{
    int tick = 0;
    damped_loop_reset(d, error);
    while (!is_stopped(d) && tick <= latest_alarm(d)) {
        (void)damped_loop_tick(d, d->structure->goal);
        tick++;
    }
    return tick;
}

/*
 * Law: with all amplifiers of the wrong polarity, 0, 10 and 30 % hysteresis, and gains of 0.8 to
 * 1.33, the alarm comes within 3 periods of the first mode, however slowly the supervisor judges
 * vibration.
 */
static void wrong_polarity_is_found(void **state)
{
    static const double play[] = {0, 0.1, 0.3}, gain[] = {1, 0.8, 1.33};
    const damper_settings settings = damper_default_settings();
    (void)state;
    for (int k = 0; k < STRUCTURES; k++) {
        modal_structure s;
        damped_loop d;
        int latest = 0;
        open_structure(&s, &structures[k]);
        damped_loop_open(&d, &s, structures[k].interval, s.limit / 15, 1, NULL, 0, &settings);
        damped_loop_supervise(&d);
        for (int i = 0; i < 18; i++) {
            const plant_error error = {-gain[i / 3 % 3], 1, 1, 1, play[i % 3], 0, 1e-4};
            if (i == 9)
                slow_down(&d, 6);
            const int ticks = ticks_to_alarm(&d, error);
            latest = ticks > latest ? ticks : latest;
        }
        print_message("%s: alarm after %d ticks at most, period %d\n", structures[k].name, latest,
                      d.supervision.polarity_ticks);
        assert_in_range(latest, 1, latest_alarm(&d));
        damped_loop_close(&d);
        structure_close(&s);
    }
}

/* Number of ticks from the start to the alarm under a target that jumps every 0.6 periods. */
static int ticks_of_jumps(damped_loop *d, plant_error error, unsigned seed)
{
    const int period = d->supervision.polarity_ticks, every = 3 * period / 5;
    double *wanted = calloc(d->structure->outputs, sizeof *wanted);
    int tick = 0;
    assert_non_null(wanted);
    damped_loop_reset(d, error);
    for (; !is_stopped(d) && tick <= 7 * period / 2; tick++) {
        const double factor = uniform(&seed, -1, 1);
        for (size_t i = 0; i < d->structure->outputs && tick % every == 0; i++)
            wanted[i] = (tick > 0 ? factor : 1) * d->structure->goal[i];
        (void)damped_loop_tick(d, wanted);
    }
    free(wanted);
    return tick;
}

/*
 * Law: with all amplifiers of the wrong polarity, gains of 0.8 to 1.33, and a target that jumps
 * every 0.6 periods of the first mode, before any jump has been followed, the alarm comes within
 * 3.5 periods, 234 ticks on the plate of the demonstration scene.
 */
static void wrong_polarity_is_found_under_jumps(void **state)
{
    static const double gain[] = {1, 0.8, 1.33};
    const damper_settings settings = damper_default_settings();
    (void)state;
    for (int k = 0; k < STRUCTURES; k++) {
        modal_structure s;
        damped_loop d;
        int latest = 0;
        open_structure(&s, &structures[k]);
        damped_loop_open(&d, &s, structures[k].interval, s.limit / 15, 1, NULL, 0, &settings);
        damped_loop_supervise(&d);
        for (int i = 0; i < 18; i++) {
            const plant_error error = {-gain[i % 3], 1, 1, 1, 0, 0, 1e-4};
            const int ticks = ticks_of_jumps(&d, error, (unsigned)i + 1);
            latest = ticks > latest ? ticks : latest;
        }
        print_message("%s: alarm after %d ticks at most, period %d\n", structures[k].name, latest,
                      d.supervision.polarity_ticks);
        assert_in_range(latest, 1, 7 * d.supervision.polarity_ticks / 2);
        damped_loop_close(&d);
        structure_close(&s);
    }
}

/*
 * Let the supervisor tolerate sudden loads that move the structure by half of what half the voltage
 * range does, so far that the motion along a jump of the target proves nothing.
 */
static void tolerate_large_loads(damped_loop *d)
{
    d->supervision.load = d->supervision.slack;
    assert_int_equal(pzs_supervision_seal(&d->supervision), PZS_OK);
}

/*
 * Law: where the supervisor tolerates loads that are half as large as the effect of the voltages,
 * amplifiers of the wrong polarity run to their limits; the polarity test raises the alarm within
 * 28 periods of the first mode.
 */
static void wrong_polarity_at_the_limits_is_found(void **state)
{
    static const double play[] = {0, 0.1, 0.3}, gain[] = {1, 0.8, 1.33};
    const damper_settings settings = damper_default_settings();
    (void)state;
    for (int k = 0; k < STRUCTURES; k++) {
        modal_structure s;
        damped_loop d;
        int latest = 0, tests = 0;
        open_structure(&s, &structures[k]);
        damped_loop_open(&d, &s, structures[k].interval, s.limit / 15, 1, NULL, 0, &settings);
        damped_loop_supervise(&d);
        tolerate_large_loads(&d);
        for (int i = 0; i < 9; i++) {
            int tick = 0;
            damped_loop_reset(&d, (plant_error){-gain[i / 3], 1, 1, 1, play[i % 3], 0, 1e-4});
            for (; !is_stopped(&d) && tick < 28 * d.supervision.polarity_ticks; tick++)
                tests += damped_loop_tick(&d, s.goal) == PZS_W_POLARITY;
            latest = tick > latest ? tick : latest;
        }
        print_message("%s: alarm after %d ticks at most, %d ticks of tests, period %d\n",
                      structures[k].name, latest, tests, d.supervision.polarity_ticks);
        assert_in_range(latest, 1, 28 * d.supervision.polarity_ticks - 1);
        assert_true(tests > 0 || !structures[k].is_plate);
        damped_loop_close(&d);
        structure_close(&s);
    }
}

/* What a load does when a polarity test begins: it stays, vanishes, or turns round. */
typedef enum load_course { STAYS, VANISHES, TURNS, LOAD_COURSES } load_course;

/* Load factor whose effect is `times` that of half the voltage range. */
static double load_of_reach(const damped_loop *d, double times)
{
    double squares = 0;
    for (size_t i = 0; i < d->structure->outputs; i++)
        squares += pow(d->structure->load_shape[i], 2) / (double)d->structure->outputs;
    return 2 * times * (double)d->supervision.slack / sqrt(squares);
}

/*
 * Run a healthy loop whose load grows for 100 periods to many times the effect of the voltages and
 * stays, or changes in the period after the first pause of a polarity test. Returns the number of
 * tests, or -1 after an alarm.
 */
static int count_tests(damped_loop *d, plant_error error, load_course course, double load)
{
    const int period = d->supervision.polarity_ticks;
    int tests = 0, since = 0;
    bool was_testing = false;
    damped_loop_reset(d, error);
    for (int tick = 0; tick < 240 * period; tick++) {
        const double grown = fmin(1, fmax(0, tick / (100.0 * period) - 0.1));
        const double way = fmin(1, fmax(0, (since - period) / (double)period));
        const double after = 1 - (double)course;
        d->load = load * grown * (1 + (after - 1) * way);
        const bool is_testing = damped_loop_tick(d, d->structure->goal) == PZS_W_POLARITY;
        tests += is_testing && !was_testing;
        since += tests > 0;
        was_testing = is_testing;
        if (is_stopped(d))
            return -1;
    }
    return tests;
}

/*
 * Law: a load of six times the effect of half the voltage range makes the shape opposite to the
 * prediction. The polarity test finds that the structure answers rightly, also where the load
 * vanishes or turns in its first ramp, and control goes on, with at most three tests in 240
 * periods.
 */
static void large_loads_pass_the_polarity_test(void **state)
{
    static const double play[] = {0, 0.1, 0.3}, gain[] = {1, 0.8, 1.33};
    const damper_settings settings = damper_default_settings();
    (void)state;
    for (int k = 0; k < STRUCTURES; k++) {
        modal_structure s;
        damped_loop d;
        int all = 0;
        open_structure(&s, &structures[k]);
        damped_loop_open(&d, &s, structures[k].interval, s.limit / 15, 1, NULL, 0, &settings);
        damped_loop_supervise(&d);
        for (int i = 0; i < 9 * LOAD_COURSES; i++) {
            const plant_error error = {gain[i / 3 % 3], 1, 1, 1, play[i % 3], 0, 1e-4};
            const int tests = count_tests(&d, error, (load_course)(i / 9), load_of_reach(&d, 6));
            assert_in_range(tests, 0, 3);
            all += tests;
        }
        print_message("%s: %d tests in %d runs\n", structures[k].name, all, 9 * LOAD_COURSES);
        damped_loop_close(&d);
        structure_close(&s);
    }
}

/*
 * Open the plate of the demonstration scene with a supervisor that tolerates large loads, and
 * amplifiers of the given gain.
 */
static void open_tolerant_plate(modal_structure *s, damped_loop *d, double gain)
{
    const damper_settings settings = damper_default_settings();
    open_structure(s, &structures[0]);
    damped_loop_open(d, s, structures[0].interval, s->limit / 15, 1, NULL, 0, &settings);
    damped_loop_supervise(d);
    tolerate_large_loads(d);
    damped_loop_reset(d, (plant_error){gain, 1, 1, 1, 0.1, 0, 1e-4});
}

static void close_plate(modal_structure *s, damped_loop *d)
{
    damped_loop_close(d);
    structure_close(s);
}

/*
 * Law: a polarity test waits for readings that are missing and goes on with the next ones. Where
 * one tick in 20 has none, the alarm still comes within 31 periods of the first mode.
 */
static void missing_readings_delay_the_polarity_test(void **state)
{
    modal_structure s;
    damped_loop d;
    int tick = 0, begun = 0;
    pzs_supervisor_mode before = PZS_MODE_RUNNING;
    (void)state;
    open_tolerant_plate(&s, &d, -1);
    for (; !is_stopped(&d) && tick < 31 * d.supervision.polarity_ticks; tick++) {
        d.is_silent = tick % 20 == 7;
        (void)damped_loop_tick(&d, s.goal);
        begun += mode_of(&d) == PZS_MODE_TESTING && before != PZS_MODE_TESTING;
        before = mode_of(&d);
    }
    print_message("alarm after %d ticks\n", tick);
    assert_true(is_stopped(&d));
    assert_int_equal(begun, 1);
    close_plate(&s, &d);
}

/* Run ticks, at most `most`, until the supervisor is in a mode. Returns whether it is. */
static bool run_until(damped_loop *d, pzs_supervisor_mode mode, int most)
{
    for (int tick = 0; tick < most && mode_of(d) != mode; tick++)
        (void)damped_loop_tick(d, d->structure->goal);
    return mode_of(d) == mode;
}

/*
 * Let the load of a healthy plate grow to six times the effect of half the voltage range until a
 * polarity test begins.
 */
static void provoke_test(damped_loop *d)
{
    const int period = d->supervision.polarity_ticks;
    for (int tick = 0; tick < 400 * period && mode_of(d) != PZS_MODE_TESTING; tick++) {
        d->load = load_of_reach(d, 6) * fmin(1, tick / (100.0 * period));
        (void)damped_loop_tick(d, d->structure->goal);
    }
    assert_int_equal(mode_of(d), PZS_MODE_TESTING);
}

/*
 * Law: an input that pzs_hold keeps at a voltage stays there during a polarity test, while the
 * others move; control then goes on.
 */
static void held_inputs_stay_in_the_polarity_test(void **state)
{
    modal_structure s;
    damped_loop d;
    double moved = 0;
    (void)state;
    open_tolerant_plate(&s, &d, 1);
    const pzs_real held = (pzs_real)(0.3 * s.limit);
    assert_int_equal(pzs_hold(d.loop.info.control, 3, held), PZS_OK);
    provoke_test(&d);
    const double before = (double)d.loop.info.voltage[4];
    while (mode_of(&d) == PZS_MODE_TESTING) {
        (void)damped_loop_tick(&d, s.goal);
        moved = fmax(moved, fabs((double)d.loop.info.voltage[4] - before));
        assert_true(d.loop.info.voltage[3] >= held && d.loop.info.voltage[3] <= held);
    }
    assert_int_equal(mode_of(&d), PZS_MODE_RUNNING);
    assert_true(moved > fabs(before) / 2);
    close_plate(&s, &d);
}

/*
 * Law: the command to park ends a polarity test. After the command to resume, control goes on
 * without another one if the load has gone.
 */
static void parking_ends_the_polarity_test(void **state)
{
    modal_structure s;
    damped_loop d;
    (void)state;
    open_tolerant_plate(&s, &d, 1);
    const int period = d.supervision.polarity_ticks;
    pzs_supervisor *supervisor = pzs_loop_find(&d.loop, &pzs_supervisor_block);
    provoke_test(&d);
    assert_int_equal(pzs_supervisor_give(supervisor, PZS_COMMAND_PARK), PZS_OK);
    assert_true(run_until(&d, PZS_MODE_PARKED, 10 * period));
    d.load = 0;
    for (int tick = 0; tick < 100 * period; tick++)
        (void)damped_loop_tick(&d, s.goal);
    assert_int_equal(pzs_supervisor_give(supervisor, PZS_COMMAND_RESUME), PZS_OK);
    assert_true(run_until(&d, PZS_MODE_RUNNING, 10 * period));
    for (int tick = 0; tick < 20 * period; tick++) {
        (void)damped_loop_tick(&d, s.goal);
        assert_int_equal(mode_of(&d), PZS_MODE_RUNNING);
    }
    close_plate(&s, &d);
}

/* Distance of the shape from the target, relative to the goal. */
static double shape_error(const damped_loop *d, const double *wanted)
{
    double sum = 0, all = 0;
    for (size_t i = 0; i < d->structure->outputs; i++) {
        sum += pow(d->shape[i] - wanted[i], 2);
        all += pow(d->structure->goal[i], 2);
    }
    return sqrt(sum / all);
}

/* Set the target to a part of the goal. */
static void scale_target(const damped_loop *d, double factor, double *wanted)
{
    for (size_t i = 0; i < d->structure->outputs; i++)
        wanted[i] = factor * d->structure->goal[i];
}

/*
 * Let all readings stick just before the target jumps from half of the goal to another part of it.
 * Returns the number of ticks from the jump to the first one that ignores the readings.
 *   worst out  largest error of the shape until the end of control, relative to the jump
 */
static int ticks_to_hold(damped_loop *d, plant_error error, double after, double *worst)
{
    const int settled = 6 * d->supervision.polarity_ticks;
    double *wanted = calloc(d->structure->outputs, sizeof *wanted);
    int tick = 0, held = 0;
    assert_non_null(wanted);
    damped_loop_reset(d, error);
    *worst = 0;
    while (!is_stopped(d) && tick < 3 * settled) {
        scale_target(d, tick < settled ? 0.5 : after, wanted);
        if (tick == settled - 5)
            d->stuck_sensors = d->sensors;
        if (damped_loop_tick(d, wanted) == PZS_W_HELD && held == 0)
            held = tick;
        if (tick >= settled)
            *worst = fmax(*worst, shape_error(d, wanted) / fabs(after - 0.5));
        tick++;
    }
    free(wanted);
    return held - settled;
}

/*
 * Law: where all readings stick before the target jumps by 0.5 or 1 of the goal, the loop ignores
 * them within a period of the first mode, and the supervisor ends control after its time-out and
 * names the fault. Until then the shape is never further from the target than at the jump, but for
 * an overshoot of 10 %.
 */
static void stuck_sensors_are_found(void **state)
{
    static const double play[] = {0, 0.1, 0.3}, after[] = {1, 0, -0.5};
    const damper_settings settings = damper_default_settings();
    (void)state;
    for (int k = 0; k < STRUCTURES; k++) {
        modal_structure s;
        damped_loop d;
        int latest = 0;
        double most = 0, worst;
        open_structure(&s, &structures[k]);
        damped_loop_open(&d, &s, structures[k].interval, s.limit / 15, 1, NULL, 0, &settings);
        damped_loop_supervise(&d);
        for (int i = 0; i < 9; i++) {
            const plant_error error = {1, 1, 1, 1, play[i % 3], 0, 1e-4};
            const int ticks = ticks_to_hold(&d, error, after[i / 3], &worst);
            const pzs_supervisor *supervisor = pzs_loop_find(&d.loop, &pzs_supervisor_block);
            assert_true(is_stopped(&d) && supervisor->info.cause == PZS_EVENT_TIMEOUT);
            assert_true(supervisor->info.is_stuck);
            assert_in_range(ticks, 1, d.supervision.polarity_ticks);
            latest = ticks > latest ? ticks : latest;
            most = fmax(most, worst);
        }
        print_message("%s: held after %d ticks at most, period %d, error %.2f jumps\n",
                      structures[k].name, latest, d.supervision.polarity_ticks, most);
        assert_true(most <= 1.1);
        damped_loop_close(&d);
        structure_close(&s);
    }
}

/*
 * Law: readings that repeat to the bit because nothing moves raise no alarm: neither with a target
 * of zero nor after the structure has come to rest at the goal, without noise, and with steps of
 * the converters of 0, 0.001 and 0.03 of the goal.
 */
static void resting_loops_raise_no_alarm(void **state)
{
    static const double quantum[] = {0, 1e-3, 0.03};
    const damper_settings settings = damper_default_settings();
    (void)state;
    for (int k = 0; k < STRUCTURES; k++) {
        modal_structure s;
        damped_loop d;
        open_structure(&s, &structures[k]);
        damped_loop_open(&d, &s, structures[k].interval, s.limit / 15, 1, NULL, 0, &settings);
        damped_loop_supervise(&d);
        double *wanted = calloc(s.outputs, sizeof *wanted);
        assert_non_null(wanted);
        for (int i = 0; i < 6; i++) {
            damped_loop_reset(&d, EXACT_PLANT);
            d.quantum = quantum[i / 2];
            scale_target(&d, i % 2, wanted);
            for (int tick = 0; tick < RUN_TICKS; tick++)
                (void)damped_loop_tick(&d, wanted);
            assert_int_equal(mode_of(&d), PZS_MODE_RUNNING);
        }
        free(wanted);
        damped_loop_close(&d);
        structure_close(&s);
    }
}

/*
 * Let all readings stay where they are, but for their noise, just before the target jumps by the
 * goal. Returns the number of ticks from the jump to the alarm.
 */
static int ticks_to_noisy_alarm(damped_loop *d, double play)
{
    const int settled = 6 * d->supervision.polarity_ticks;
    double *wanted = calloc(d->structure->outputs, sizeof *wanted);
    int tick = 0;
    assert_non_null(wanted);
    damped_loop_reset(d, (plant_error){1, 1, 1, 1, play, 0, 1e-4});
    d->is_stuck_noisy = true;
    for (; !is_stopped(d) && tick < 2 * settled; tick++) {
        scale_target(d, tick < settled ? 0.5 : -0.5, wanted);
        d->stuck_sensors = tick < settled - 5 ? 0 : d->sensors;
        (void)damped_loop_tick(d, wanted);
    }
    free(wanted);
    return tick - settled;
}

/*
 * Law: where all readings stay where they are but for their noise, a jump of the target by the goal
 * raises the alarm within 4.5 periods of the first mode.
 */
static void noisy_stuck_sensors_are_found(void **state)
{
    static const double play[] = {0, 0.1, 0.3};
    const damper_settings settings = damper_default_settings();
    (void)state;
    for (int k = 0; k < STRUCTURES; k++) {
        modal_structure s;
        damped_loop d;
        int latest = 0;
        open_structure(&s, &structures[k]);
        damped_loop_open(&d, &s, structures[k].interval, s.limit / 15, 1, NULL, 0, &settings);
        damped_loop_supervise(&d);
        for (int i = 0; i < 3; i++) {
            const int ticks = ticks_to_noisy_alarm(&d, play[i]);
            latest = ticks > latest ? ticks : latest;
        }
        print_message("%s: alarm after %d ticks at most, period %d\n", structures[k].name, latest,
                      d.supervision.polarity_ticks);
        assert_in_range(latest, 1, 9 * d.supervision.polarity_ticks / 2);
        damped_loop_close(&d);
        structure_close(&s);
    }
}

/*
 * Law: a loop whose readings change again before the time-out goes on, and reaches the best shape.
 */
static void readings_return(void **state)
{
    const damper_settings settings = damper_default_settings();
    (void)state;
    modal_structure s;
    damped_loop d;
    open_structure(&s, &structures[0]);
    damped_loop_open(&d, &s, structures[0].interval, s.limit / 15, 1, NULL, 0, &settings);
    damped_loop_supervise(&d);
    damped_loop_reset(&d, EXACT_PLANT);
    int held = 0;
    for (int tick = 0; tick < RUN_TICKS; tick++) {
        d.stuck_sensors = tick < 100 ? d.sensors : 0;
        held += damped_loop_tick(&d, s.goal) == PZS_W_HELD;
    }
    assert_in_range(held, 10, 99);
    assert_int_equal(mode_of(&d), PZS_MODE_RUNNING);
    double *best = calloc(s.outputs, sizeof *best);
    assert_non_null(best);
    damped_loop_optimum(&d, s.goal, best);
    assert_true(damped_loop_distance(&d, best) < 0.01);
    free(best);
    damped_loop_close(&d);
    structure_close(&s);
}

/* Course of a run of a loop without faults: target, load, ticks of their next jumps. */
typedef struct course {
    unsigned seed;
    double *wanted;
    int next_target, next_load, next_impulse;
} course;

static int ticks_until(course *c, double low, double high, int period)
{
    return 1 + (int)(uniform(&c->seed, low, high) * period);
}

/* A part of the goal, or the shape of voltages up to twice the limits. */
static void set_target(course *c, const modal_structure *s)
{
    const double factor = uniform(&c->seed, -1, 1);
    const bool is_shape = uniform(&c->seed, 0, 1) < 0.3;
    for (size_t i = 0; i < s->outputs; i++)
        c->wanted[i] = is_shape ? 0 : factor * s->goal[i];
    for (size_t j = 0; j < s->inputs && is_shape; j++) {
        const double voltage = uniform(&c->seed, -2 * s->limit, 2 * s->limit);
        for (size_t i = 0; i < s->outputs; i++)
            c->wanted[i] += s->influence[i * s->inputs + j] * voltage;
    }
}

/* Load factor whose effect is the largest sudden load that the supervisor tolerates. */
static double largest_load(const damped_loop *d)
{
    double squares = 0;
    for (size_t i = 0; i < d->structure->outputs; i++)
        squares += pow(d->structure->load_shape[i], 2) / (double)d->structure->outputs;
    return (double)d->supervision.load / sqrt(squares);
}

/* Strike the structure, so that its first mode vibrates with up to the largest sudden load. */
static void strike(course *c, damped_loop *d)
{
    d->velocity[0] += uniform(&c->seed, -1, 1) * (double)d->supervision.load;
}

/* Let target, load and velocities jump when their time has come. */
static void disturb(course *c, damped_loop *d, int tick, int period)
{
    if (tick >= c->next_target) {
        set_target(c, d->structure);
        c->next_target = tick + ticks_until(c, 0.2, 6, period);
    }
    if (tick >= c->next_load) {
        d->load = uniform(&c->seed, -0.5, 0.5) * largest_load(d);
        c->next_load = tick + ticks_until(c, 1, 6, period);
    }
    if (tick >= c->next_impulse) {
        strike(c, d);
        c->next_impulse = tick + ticks_until(c, 2, 8, period);
    }
}

/* A plant in the box of the certificate, with hysteresis of up to 30 %. */
static plant_error random_plant(course *c, int delay)
{
    return (plant_error){uniform(&c->seed, 0.8, 1.33),
                         uniform(&c->seed, 0.9, 1.1),
                         1,
                         delay,
                         uniform(&c->seed, 0, 1) < 0.3 ? 0.3 : uniform(&c->seed, 0, 0.3),
                         0,
                         1e-4};
}

/* Let sensors of half of the runs round, to steps of up to 0.01 of the target, without noise. */
static void set_converters(damped_loop *d, course *c)
{
    if (uniform(&c->seed, 0, 1) < 0.5)
        return;
    d->error.noise = 0;
    d->quantum = pow(10, uniform(&c->seed, -5, -2));
}

/* Run a healthy loop. Returns the tick of an alarm, or 0. */
static int run_healthy(damped_loop *d, unsigned seed, int delay)
{
    const modal_structure *s = d->structure;
    course c = {.seed = seed, .wanted = calloc(s->outputs, sizeof(double))};
    assert_non_null(c.wanted);
    damped_loop_reset(d, random_plant(&c, delay));
    set_converters(d, &c);
    const int fails = uniform(&c.seed, 0, 1) < 0.5 ? RUN_TICKS / 2 : RUN_TICKS;
    const int which = (int)uniform(&c.seed, 0, (double)s->inputs),
              period = d->supervision.polarity_ticks;
    int alarm = 0;
    for (int tick = 0; tick < RUN_TICKS && alarm == 0; tick++) {
        disturb(&c, d, tick, period);
        d->stuck_input = tick < fails ? -1 : which;
        (void)damped_loop_tick(d, c.wanted);
        alarm = is_stopped(d) ? tick + 1 : 0;
    }
    free(c.wanted);
    return alarm;
}

/*
 * Law: no alarm comes on structures in the box of the certificate (gain 0.8 to 1.33, frequencies
 * 0.9 to 1.1 of the model), with 0 to 30 % hysteresis, targets that jump beyond the limits, loads
 * and impulses as large as the supervisor tolerates, and in half of the runs a stuck electrode,
 * however slowly the supervisor judges vibration.
 */
static void healthy_loops_raise_no_alarm(void **state)
{
    static const int delays[] = {0, 1, 3};
    const damper_settings settings = damper_default_settings();
    (void)state;
    for (int k = 0; k < STRUCTURES; k++) {
        modal_structure s;
        long alarms = 0;
        open_structure(&s, &structures[k]);
        for (int i = 0; i < 6; i++) {
            damped_loop d;
            damped_loop_open(&d, &s, structures[k].interval, s.limit / (i % 2 ? 60 : 15),
                             delays[i / 2], NULL, 0, &settings);
            damped_loop_supervise(&d);
            slow_down(&d, 1 + i % 3);
            for (unsigned run = 0; run < HEALTHY_RUNS / 6; run++)
                alarms += run_healthy(&d, 1 + run * 6 + (unsigned)i, delays[i / 2]) > 0;
            damped_loop_close(&d);
        }
        print_message("%s: %ld alarms in %d runs of %d ticks\n", structures[k].name, alarms,
                      HEALTHY_RUNS / 6 * 6, RUN_TICKS);
        assert_int_equal(alarms, 0);
        structure_close(&s);
    }
}

/*
 * Run a healthy loop whose targets are jumps between -part and part of the goal. Returns whether an
 * alarm has come.
 */
static bool is_parked_at_small_targets(damped_loop *d, double play, double part)
{
    const int period = d->supervision.polarity_ticks;
    double *wanted = calloc(d->structure->outputs, sizeof *wanted);
    unsigned seed = 3;
    assert_non_null(wanted);
    damped_loop_reset(d, (plant_error){1, 1, 1, 1, play, 0, 1e-4 * part});
    for (int tick = 0; tick < 40 * period && !is_stopped(d); tick++) {
        if (tick % (4 * period) == 0)
            scale_target(d, part * (uniform(&seed, 0, 1) < 0.5 ? -1 : 1) * uniform(&seed, 0.5, 1),
                         wanted);
        (void)damped_loop_tick(d, wanted);
    }
    free(wanted);
    return is_stopped(d);
}

/*
 * Law: small targets, of 0.02 to 0.2 of the goal, whose motions hysteresis of 5 to 30 % may take at
 * first, raise no alarm of a supervisor with tolerances in their unit.
 */
static void small_targets_raise_no_alarm(void **state)
{
    static const double play[] = {0.05, 0.1, 0.3}, part[] = {0.02, 0.05, 0.2};
    const damper_settings settings = damper_default_settings();
    int alarms = 0;
    (void)state;
    for (int k = 0; k < STRUCTURES; k++) {
        modal_structure s;
        damped_loop d;
        open_structure(&s, &structures[k]);
        damped_loop_open(&d, &s, structures[k].interval, s.limit / 15, 1, NULL, 0, &settings);
        for (int i = 0; i < 9; i++) {
            damped_loop_supervise(&d);
            d.supervision.noise *= (pzs_real)part[i / 3];
            d.supervision.load *= (pzs_real)part[i / 3];
            assert_int_equal(pzs_supervision_seal(&d.supervision), PZS_OK);
            alarms += is_parked_at_small_targets(&d, play[i % 3], part[i / 3]);
        }
        damped_loop_close(&d);
        structure_close(&s);
    }
    print_message("small targets: %d alarms in %d runs\n", alarms, 9 * STRUCTURES);
    assert_int_equal(alarms, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(wrong_polarity_is_found),
                                       cmocka_unit_test(wrong_polarity_is_found_under_jumps),
                                       cmocka_unit_test(wrong_polarity_at_the_limits_is_found),
                                       cmocka_unit_test(large_loads_pass_the_polarity_test),
                                       cmocka_unit_test(missing_readings_delay_the_polarity_test),
                                       cmocka_unit_test(held_inputs_stay_in_the_polarity_test),
                                       cmocka_unit_test(parking_ends_the_polarity_test),
                                       cmocka_unit_test(stuck_sensors_are_found),
                                       cmocka_unit_test(noisy_stuck_sensors_are_found),
                                       cmocka_unit_test(readings_return),
                                       cmocka_unit_test(resting_loops_raise_no_alarm),
                                       cmocka_unit_test(small_targets_raise_no_alarm),
                                       cmocka_unit_test(healthy_loops_raise_no_alarm)};
    return cmocka_run_group_tests_name("polarity", tests, NULL, NULL);
}
