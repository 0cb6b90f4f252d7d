/*
 * Fault detector of damped loops (lib/control/pulse_faults.c) on a strip without mass: proofs,
 * interruptions, holds by the program, missing readings, tables. tests/unit/sweep_faults.c measures
 * the detector on structures that vibrate.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>
#include "../rigs/uniform.h"

enum { INPUTS = 4, SENSORS = 12, PULSE = 64, DELAY = 2 };
/* Ticks from the end of a pulse until it is evaluated: late readings, and the evaluation. */
enum { EVALUATION = DELAY + 1 + 4 };
/* Ticks from the end of a window until its means are compared and an electrode is suspected. */
enum { COMPARISON = 4 };
/* Duration of two windows in which readings are averaged and of two pulses, with their delays. */
enum { PROOF = 3 * PULSE + 2 * (DELAY + 1) + 2 * COMPARISON + 2 * EVALUATION };

static const double limit = 130, step_limit = 40, height = 20;

/* A strip, clamped at one end, whose electrodes follow each other along its length. */
typedef struct strip {
    pzs_real influence[SENSORS * INPUTS];
    pzs_real lower[INPUTS], upper[INPUTS], step[INPUTS], zero[INPUTS], amplitude[INPUTS];
    pzs_real weight[SENSORS], scale[SENSORS], noise[SENSORS];
    pzs_problem problem;
    pzs_selftest_tables tables;
    pzs_block block[3];
    bool is_kept;
    pzs_loop loop;
    pzs_real work[3000];
    pzs_real wanted[SENSORS], readings[SENSORS];
    double acting[INPUTS];           /* voltages that act on the electrodes (V) */
    double past[DELAY + 1][SENSORS]; /* readings of the last ticks */
    pzs_electrode_fault fault[INPUTS];
    double load[SENSORS]; /* change of the readings by a load */
    size_t missing;       /* number of sensors, from the first one, that give NaN */
    double gain;          /* response of all electrodes relative to the model */
    int tick;
    unsigned seed;
} strip;

static void fill(pzs_real *to, size_t count, double value)
{
    for (size_t k = 0; k < count; k++)
        to[k] = (pzs_real)value;
}

/* Deflection at the place x of a strip whose curvature is 1 from `from` to `to`, and 0 elsewhere.
 */
static double deflection(double x, double from, double to)
{
    const double bent = fmin(fmax(x - from, 0), to - from);
    return bent * bent / 2 + bent * fmax(x - to, 0);
}

static size_t no_memory(const void *tables, const pzs_problem *problem)
{
    (void)tables;
    (void)problem;
    return 0;
}

static pzs_status begin_keeper(void *self, const void *tables, pzs_loop_signals *signals)
{
    (void)self;
    (void)tables;
    (void)signals;
    return PZS_OK;
}

/* A supervisor that determines the voltages if its tables are true. */
static pzs_status keep_voltages(void *self, pzs_loop_signals *signals)
{
    (void)self;
    signals->control->state.is_taken_over = *(const bool *)signals->tables;
    return PZS_OK;
}

static const pzs_block_type keeper_block = {"keeper",     PZS_PHASE_SUPERVISE, no_memory,
                                            begin_keeper, keep_voltages,       NULL};

static void open_strip(strip *s)
{
    memset(s, 0, sizeof *s);
    for (size_t k = 0; k < SENSORS * INPUTS; k++) {
        const double place = (double)(k / INPUTS + 1) / SENSORS;
        const double from = (double)(k % INPUTS) / INPUTS;
        s->influence[k] = (pzs_real)deflection(place, from, from + 1.0 / INPUTS);
    }
    fill(s->lower, INPUTS, -limit);
    fill(s->upper, INPUTS, limit);
    fill(s->step, INPUTS, step_limit);
    fill(s->amplitude, INPUTS, height);
    fill(s->weight, SENSORS, 1);
    fill(s->scale, SENSORS, 10);
    s->problem = (pzs_problem){.scene = 1,
                               .inputs = INPUTS,
                               .outputs = SENSORS,
                               .influence = s->influence,
                               .weight = s->weight,
                               .lower = s->lower,
                               .upper = s->upper,
                               .step_limit = s->step,
                               .reference_voltage = s->zero};
    s->tables = (pzs_selftest_tables){.scene = 1,
                                      .inputs = INPUTS,
                                      .sensors = SENSORS,
                                      .delay = DELAY,
                                      .pulse_ticks = PULSE,
                                      .amplitude = s->amplitude,
                                      .scale = s->scale,
                                      .noise = s->noise,
                                      .gain_tolerance = 1};
    s->block[0] = (pzs_block){&pzs_step_block, &s->problem};
    s->block[1] = (pzs_block){&pzs_pulse_detector_block, &s->tables};
    s->block[2] = (pzs_block){&keeper_block, &s->is_kept};
    s->gain = 1;
    s->seed = 1;
    assert_int_equal(pzs_problem_seal(&s->problem), PZS_OK);
    assert_int_equal(pzs_selftest_seal(&s->tables), PZS_OK);
    assert_int_equal(pzs_loop_init(&s->loop, s->block, 3, NULL, s->work, sizeof s->work), PZS_OK);
}

static const pzs_pulse_detector *detector_of(const strip *s)
{
    return pzs_loop_find(&s->loop, &pzs_pulse_detector_block);
}

/* Set the target to the shape of random voltages, as far as the strip can follow them. */
static void move_target(strip *s)
{
    for (size_t i = 0; i < SENSORS; i++)
        s->wanted[i] = 0;
    for (size_t j = 0; j < INPUTS; j++) {
        const double sign = uniform(&s->seed, 0, 1) < 0.5 ? -1 : 1;
        const double voltage = sign * uniform(&s->seed, 0.3, 0.7) * limit;
        for (size_t i = 0; i < SENSORS; i++)
            s->wanted[i] += s->influence[i * INPUTS + j] * (pzs_real)voltage;
    }
}

/* Let the electrodes act under the voltages that the loop gives. */
static void act(strip *s)
{
    for (size_t j = 0; j < INPUTS; j++) {
        const double voltage = (double)s->loop.info.voltage[j];
        if (s->fault[j] == PZS_FAULT_DEAD)
            s->acting[j] = 0;
        else if (s->fault[j] != PZS_FAULT_STUCK)
            s->acting[j] = s->fault[j] == PZS_FAULT_REVERSED ? -voltage : voltage;
    }
}

/*
 * Run one tick with readings that are DELAY ticks old.
 *   has_readings in  false: no reading arrives in this tick
 */
static pzs_status run_tick(strip *s, bool has_readings)
{
    double *now = s->past[s->tick % (DELAY + 1)];
    for (size_t i = 0; i < SENSORS; i++) {
        now[i] = s->load[i];
        for (size_t j = 0; j < INPUTS; j++)
            now[i] += s->gain * (double)s->influence[i * INPUTS + j] * s->acting[j];
    }
    const int then = s->tick > DELAY ? s->tick - DELAY : 0;
    for (size_t i = 0; i < SENSORS; i++)
        s->readings[i] = (pzs_real)(i < s->missing ? (double)NAN : s->past[then % (DELAY + 1)][i]);
    s->tick++;
    const pzs_status status = pzs_loop_tick(&s->loop, s->wanted, has_readings ? s->readings : NULL);
    for (size_t j = 0; j < INPUTS; j++)
        assert_true(fabs((double)s->loop.info.voltage[j]) <= limit);
    act(s);
    return status;
}

/* Run some ticks. Returns the number of ticks that report a faulty electrode. */
static int run_ticks(strip *s, int ticks)
{
    int found = 0;
    for (int tick = 0; tick < ticks; tick++)
        found += run_tick(s, true) == PZS_W_ELECTRODE;
    return found;
}

/* Run a rest of a healthy strip after a new target. */
static void rest(strip *s)
{
    move_target(s);
    (void)run_ticks(s, 2 * PULSE);
}

/*
 * A dead, a stuck and a reversed electrode are held and named within one rest and one proof of a
 * motion of the target, and nothing else, whatever the gain of the strip.
 */
static void test_named(void **state)
{
    static const double gains[] = {0.8, 1, 1.33};
    static strip s;
    (void)state;
    for (int k = 0; k < 3 * INPUTS * 3; k++) {
        const pzs_electrode_fault fault = (pzs_electrode_fault)(PZS_FAULT_DEAD + k % 3);
        const size_t j = (size_t)k / 3 % INPUTS;
        open_strip(&s);
        s.seed = 7u + (unsigned)k;
        s.gain = gains[k / 3 / INPUTS];
        rest(&s);
        s.fault[j] = fault;
        rest(&s);
        (void)run_ticks(&s, PROOF);
        for (size_t other = 0; other < INPUTS; other++)
            assert_int_equal(s.loop.info.electrode[other] == PZS_ELECTRODE_HELD, other == j);
        assert_int_equal(detector_of(&s)->info.found, 1);
        assert_int_equal(detector_of(&s)->info.fault[j] == PZS_FAULT_REVERSED,
                         fault == PZS_FAULT_REVERSED);
        assert_int_equal(pzs_release(s.loop.info.control, (uint16_t)j), PZS_OK);
    }
}

/*
 * Law: if an electrode dies when the target moves, a suspicion arises within PZS_SUSPICION_TICKS,
 * whenever this happens between two comparisons of readings.
 */
static void test_suspicion_time(void **state)
{
    static strip s;
    (void)state;
    for (int k = 0; k < 2 * PULSE; k++) {
        const size_t j = (size_t)k % INPUTS;
        open_strip(&s);
        rest(&s);
        (void)run_ticks(&s, k);
        s.fault[j] = PZS_FAULT_DEAD;
        move_target(&s);
        (void)run_ticks(&s, (int)PZS_SUSPICION_TICKS(PULSE, DELAY));
        assert_in_range(detector_of(&s)->state.suspect, 0, INPUTS - 1);
    }
}

/* Let an electrode die in a motion, and run until its test pulse begins. */
static void doubt(strip *s, size_t j)
{
    open_strip(s);
    rest(s);
    s->fault[j] = PZS_FAULT_DEAD;
    move_target(s);
    for (int tick = 0; tick < PROOF && s->loop.info.electrode[j] != PZS_ELECTRODE_TESTED; tick++)
        (void)run_tick(s, true);
    assert_int_equal(s->loop.info.electrode[j], PZS_ELECTRODE_TESTED);
}

/* Let an electrode die in a motion, and run until the middle of its first test pulse. */
static void suspect(strip *s, size_t j)
{
    doubt(s, j);
    (void)run_ticks(s, PULSE / 2);
}

/* Assert that no electrode is held, and that all limits in force are those of the tables. */
static void assert_free(const strip *s)
{
    const pzs_control_info *info = &s->loop.info.control->info;
    for (size_t j = 0; j < INPUTS; j++) {
        assert_int_not_equal(s->loop.info.electrode[j], PZS_ELECTRODE_HELD);
        assert_true(info->lower[j] <= s->lower[j] && info->upper[j] >= s->upper[j]);
    }
}

/*
 * A healthy strip has no finding, in rests and while the target moves; a load with the shape of one
 * electrode is no fault either.
 */
static void test_healthy(void **state)
{
    static strip s;
    (void)state;
    open_strip(&s);
    for (int k = 0; k < 60; k++) {
        move_target(&s);
        assert_int_equal(run_ticks(&s, k % 3 ? PULSE / 3 : 4 * PULSE), 0);
        if (k % 3 == 0)
            for (size_t i = 0; i < SENSORS; i++)
                s.load[i] = 60 * (double)s.influence[i * INPUTS + (size_t)(k / 3) % INPUTS];
    }
    assert_int_equal(run_ticks(&s, 2 * PROOF), 0);
    assert_true(detector_of(&s)->info.tests > 0);
    assert_free(&s);
}

/* Let the load change by the response to a voltage at electrode j. */
static void add_load(strip *s, size_t j, double voltage)
{
    for (size_t i = 0; i < SENSORS; i++)
        s->load[i] += voltage * (double)s->influence[i * INPUTS + j];
}

/*
 * Run one pulse of electrode j, in which the load jumps in the shape of the electrode at two thirds
 * of the pulse. A jump of 1 to 1.5 times the pulse hides most of the response.
 *   size in  jump of the load relative to the height of the pulse (1)
 */
static int run_hidden_pulse(strip *s, size_t j, double size)
{
    const double start = (double)s->loop.info.voltage[j];
    int found = run_ticks(s, PULSE / 2);
    const double sign = (double)s->loop.info.voltage[j] > start ? 1 : -1;
    found += run_ticks(s, PULSE / 6);
    add_load(s, j, sign * size * height);
    return found + run_ticks(s, PULSE + EVALUATION - PULSE / 2 - PULSE / 6);
}

/*
 * A load that jumps in every pulse, and hides the response, makes no electrode faulty that is
 * healthy again when the first pulse begins.
 */
static void test_load_jumps(void **state)
{
    static strip s;
    (void)state;
    for (int k = 0; k < 6 * INPUTS; k++) {
        const size_t j = (size_t)(k % INPUTS);
        doubt(&s, j);
        s.fault[j] = PZS_FAULT_NONE;
        for (int pulse = 0; pulse < 4; pulse++)
            assert_int_equal(run_hidden_pulse(&s, j, 1 + 0.1 * (k / INPUTS)), 0);
        assert_int_equal(run_ticks(&s, 2 * PROOF), 0);
        assert_free(&s);
    }
}

/*
 * Run one pulse of electrode j, in which a load with the shape of the electrode comes and goes.
 *   size   in  size of the load relative to the height of the pulse, against the pulse (1)
 *   length in  length of the load in the middle of the pulse (ticks)
 * Returns the number of ticks that report a faulty electrode.
 */
static int run_covered_pulse(strip *s, size_t j, double size, int length)
{
    const int before = (PULSE - length) / 2;
    const double start = (double)s->loop.info.voltage[j];
    int found = run_ticks(s, before);
    const double sign = (double)s->loop.info.voltage[j] > start ? -1 : 1;
    add_load(s, j, sign * size * height);
    found += run_ticks(s, length);
    add_load(s, j, -sign * size * height);
    return found + run_ticks(s, PULSE + EVALUATION - before - length);
}

/*
 * Law: a load that comes and goes within one pulse, and takes most of the response of a healthy
 * electrode away, does not make it faulty. It does not show in sums that are odd in time.
 */
static void test_covering_load(void **state)
{
    static const struct {
        double size;
        int length;
    } cases[] = {{0.8, 24}, {1.4, 24}, {0.8, 28}, {1.1, 36}, {1.25, 38}, {1.55, 40}, {1.95, 42}};
    static strip s;
    (void)state;
    for (size_t k = 0; k < INPUTS * sizeof cases / sizeof *cases; k++) {
        const size_t j = k % INPUTS;
        doubt(&s, j);
        s.fault[j] = PZS_FAULT_NONE;
        const double size = cases[k / INPUTS].size;
        assert_int_equal(run_covered_pulse(&s, j, size, cases[k / INPUTS].length), 0);
        assert_int_equal(run_ticks(&s, 2 * PROOF), 0);
        assert_free(&s);
    }
}

/*
 * Law: a load that returns with every pulse, and takes most of the first response of a healthy
 * electrode away, does not make it faulty where the voltage limits allow a pulse of opposite sign,
 * because the load adds to the response to this second pulse.
 */
static void test_returning_load(void **state)
{
    static const double sizes[] = {0.8, 0.9, 1};
    enum {
        LENGTH = 28,
        BEFORE = (PULSE - LENGTH) / 2,
        AFTER = PULSE + EVALUATION - BEFORE - LENGTH
    };
    static strip s;
    int tried = 0;
    (void)state;
    for (size_t k = 0; k < INPUTS * sizeof sizes / sizeof *sizes; k++) {
        const size_t j = k % INPUTS;
        doubt(&s, j);
        s.fault[j] = PZS_FAULT_NONE;
        const double start = (double)s.loop.info.voltage[j];
        const double load = (start > 0 ? 1 : -1) * sizes[k / INPUTS] * height;
        if (fabs(start) + height > limit)
            continue;
        for (int pulse = 0; pulse < 2; pulse++) {
            assert_int_equal(run_ticks(&s, BEFORE), 0);
            add_load(&s, j, load);
            assert_int_equal(run_ticks(&s, LENGTH), 0);
            add_load(&s, j, -load);
            assert_int_equal(run_ticks(&s, AFTER), 0);
        }
        assert_int_equal(run_ticks(&s, 2 * PROOF), 0);
        assert_free(&s);
        tried++;
    }
    assert_true(tried > 0);
}

/*
 * Run one pulse of a dead electrode, in which a load jumps up and down with the pulse and
 * enlarges the response of the electrode with which it is compared.
 *   gain in  response of that electrode relative to the model
 */
static int run_enlarged_pulse(strip *s, double gain)
{
    bool is_tested[INPUTS];
    double start[INPUTS];
    int found = 0;
    for (size_t k = 0; k < INPUTS; k++) {
        is_tested[k] = s->loop.info.electrode[k] == PZS_ELECTRODE_TESTED;
        start[k] = s->acting[k];
    }
    for (int tick = 0; tick < PULSE + EVALUATION; tick++) {
        memset(s->load, 0, sizeof s->load);
        for (size_t k = 0; k < INPUTS; k++)
            if (is_tested[k])
                add_load(s, k, (gain - 1) * (s->acting[k] - start[k]));
        found += run_tick(s, true) == PZS_W_ELECTRODE;
    }
    memset(s->load, 0, sizeof s->load);
    return found;
}

/*
 * Law: one pulse without any response of the suspected electrode proves its fault where the
 * electrode with which it is compared responds 0.75 to 1.65 times as much as the model. No healthy
 * structure responds more: a load has jumped then, and the healthy electrode is not held.
 */
static void test_one_pulse(void **state)
{
    static const struct {
        double gain;
        int found;
    } cases[] = {{0.7, 0}, {0.8, 1}, {1, 1}, {1.4, 1}, {1.6, 1}, {1.7, 0}, {3, 0}};
    static strip s;
    (void)state;
    for (size_t k = 0; k < INPUTS * sizeof cases / sizeof *cases; k++) {
        const size_t j = k % INPUTS;
        doubt(&s, j);
        assert_int_equal(run_enlarged_pulse(&s, cases[k / INPUTS].gain), cases[k / INPUTS].found);
        s.fault[j] = PZS_FAULT_NONE;
        assert_int_equal(run_ticks(&s, 2 * PROOF), 0);
        assert_int_equal(s.loop.info.electrode[j] == PZS_ELECTRODE_HELD, cases[k / INPUTS].found);
    }
}

/* Return the electrode that makes test pulses together with electrode j. */
static size_t partner_of(const strip *s, size_t j)
{
    for (size_t k = 0; k < INPUTS; k++)
        if (k != j && s->loop.info.electrode[k] == PZS_ELECTRODE_TESTED)
            return k;
    fail_msg("no electrode is tested together with electrode %zu", j);
    return j;
}

/*
 * Law: if the suspected electrode responds to its test pulse, and the one with which it is compared
 * does not, the latter is held, after two pulses, and the former is free.
 */
static void test_faulty_partner(void **state)
{
    static strip s;
    (void)state;
    for (size_t j = 0; j < INPUTS; j++) {
        doubt(&s, j);
        const size_t partner = partner_of(&s, j);
        s.fault[j] = PZS_FAULT_NONE;
        s.fault[partner] = PZS_FAULT_STUCK;
        assert_int_equal(run_ticks(&s, 2 * (PULSE + EVALUATION)), 1);
        for (size_t k = 0; k < INPUTS; k++)
            assert_int_equal(s.loop.info.electrode[k] == PZS_ELECTRODE_HELD, k == partner);
    }
}

/* A target that moves interrupts a proof, which gives all electrodes free and is made later. */
static void test_interruption(void **state)
{
    static strip s;
    (void)state;
    suspect(&s, 1);
    for (int k = 0; k < 40; k++) {
        move_target(&s);
        assert_int_equal(run_ticks(&s, PULSE / 4), 0);
        assert_free(&s);
    }
    assert_int_equal(run_ticks(&s, 3 * PROOF), 1);
    assert_int_equal(s.loop.info.electrode[1], PZS_ELECTRODE_HELD);
}

/*
 * A supervisor that keeps the voltages during a test pulse ends the pulse: the electrodes do not
 * answer, but no fault is found, and all are free.
 */
static void test_taken_over(void **state)
{
    static strip s;
    double kept[INPUTS];
    (void)state;
    suspect(&s, 1);
    s.fault[1] = PZS_FAULT_NONE;
    memcpy(kept, s.acting, sizeof kept);
    s.is_kept = true;
    (void)run_tick(&s, true);
    memcpy(s.acting, kept, sizeof kept);
    for (int tick = 0; tick < 3 * PROOF; tick++) {
        assert_int_not_equal(run_tick(&s, true), PZS_W_ELECTRODE);
        memcpy(s.acting, kept, sizeof kept);
        assert_free(&s);
    }
}

/* An electrode that the program holds or releases during its test pulse is left as it is. */
static void test_program(void **state)
{
    static strip s;
    (void)state;
    suspect(&s, 2);
    assert_int_equal(pzs_hold(s.loop.info.control, 2, 5), PZS_OK);
    assert_int_equal(run_ticks(&s, 2 * PROOF), 0);
    const pzs_control_info *info = &s.loop.info.control->info;
    assert_true(info->lower[2] >= 5 && info->upper[2] <= 5);
    suspect(&s, 2);
    assert_int_equal(pzs_release(s.loop.info.control, 2), PZS_OK);
    (void)run_ticks(&s, 1);
    assert_free(&s);
}

/*
 * Nothing is found without readings, or while more than an eighth of the sensors gives none; with
 * one sensor of twelve missing, the electrode is found.
 */
static void test_missing(void **state)
{
    static strip s;
    (void)state;
    suspect(&s, 0);
    for (int tick = 0; tick < 2 * PROOF; tick++)
        (void)run_tick(&s, false);
    assert_int_equal(detector_of(&s)->info.found, 0);
    for (size_t missing = 1; missing <= 2; missing++) {
        suspect(&s, 0);
        s.missing = missing;
        (void)run_ticks(&s, 2 * PROOF);
        assert_int_equal(detector_of(&s)->info.found, missing == 1);
    }
}

/* After pzs_loop_start the detector begins anew, and no voltage is held. */
static void test_start(void **state)
{
    static strip s;
    pzs_real voltage[INPUTS];
    (void)state;
    suspect(&s, 3);
    memcpy(voltage, (const void *)s.loop.info.voltage, sizeof voltage);
    assert_int_equal(pzs_loop_start(&s.loop, voltage), PZS_OK);
    assert_int_equal(run_ticks(&s, 1), 0);
    assert_free(&s);
    assert_int_equal(detector_of(&s)->info.tests, 0);
}

/*
 * With fewer than four sensors no fault can be proved: all electrodes are said to be unobservable,
 * and none is ever tested. An electrode whose response all others share in shape, because a single
 * sensor of four moves, is unobservable, too.
 */
static void test_few_sensors(void **state)
{
    static strip s;
    (void)state;
    for (uint16_t sensors = 3; sensors <= 4; sensors++) {
        open_strip(&s);
        assert_int_equal(detector_of(&s)->info.unobservable, 0);
        s.tables.sensors = sensors;
        s.problem.outputs = sensors;
        s.problem.regularisation = (pzs_real)1e-3;
        for (size_t k = INPUTS; k < 4 * INPUTS && sensors == 4; k++)
            s.influence[k] = 0;
        assert_int_equal(pzs_problem_seal(&s.problem), PZS_OK);
        assert_int_equal(pzs_selftest_seal(&s.tables), PZS_OK);
        assert_int_equal(pzs_loop_init(&s.loop, s.block, 2, NULL, s.work, sizeof s.work), PZS_OK);
        assert_int_equal(detector_of(&s)->info.unobservable, INPUTS);
        rest(&s);
        s.fault[1] = PZS_FAULT_DEAD;
        rest(&s);
        (void)run_ticks(&s, 2 * PROOF);
        assert_int_equal(detector_of(&s)->info.tests, 0);
    }
}

/* Tables that are damaged, do not fit or would break a limit are refused. */
static void test_bad_tables(void **state)
{
    static strip s;
    (void)state;
    open_strip(&s);
    s.tables.pulse_ticks++;
    assert_int_equal(pzs_loop_init(&s.loop, s.block, 2, NULL, s.work, sizeof s.work), PZS_E_CRC);
    fill(s.amplitude, INPUTS, limit);
    assert_int_equal(pzs_selftest_seal(&s.tables), PZS_OK);
    assert_int_equal(pzs_loop_init(&s.loop, s.block, 2, NULL, s.work, sizeof s.work), PZS_OK);
    fill(s.amplitude, INPUTS, limit * 1.01);
    assert_int_equal(pzs_selftest_seal(&s.tables), PZS_OK);
    assert_int_equal(pzs_loop_init(&s.loop, s.block, 2, NULL, s.work, sizeof s.work), PZS_E_LIMITS);
    fill(s.amplitude, INPUTS, height);
    fill(s.scale, SENSORS, 0);
    assert_int_equal(pzs_selftest_seal(&s.tables), PZS_OK);
    assert_int_equal(pzs_loop_init(&s.loop, s.block, 2, NULL, s.work, sizeof s.work),
                     PZS_E_NONFINITE);
    s.tables.inputs--;
    assert_int_equal(pzs_selftest_seal(&s.tables), PZS_OK);
    assert_int_equal(pzs_loop_init(&s.loop, s.block, 2, NULL, s.work, sizeof s.work),
                     PZS_E_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_named),          cmocka_unit_test(test_suspicion_time),
        cmocka_unit_test(test_healthy),        cmocka_unit_test(test_interruption),
        cmocka_unit_test(test_program),        cmocka_unit_test(test_missing),
        cmocka_unit_test(test_load_jumps),     cmocka_unit_test(test_one_pulse),
        cmocka_unit_test(test_covering_load),  cmocka_unit_test(test_returning_load),
        cmocka_unit_test(test_faulty_partner), cmocka_unit_test(test_start),
        cmocka_unit_test(test_bad_tables),     cmocka_unit_test(test_few_sensors),
        cmocka_unit_test(test_taken_over),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
