/*
 * Laws of the plant with inertia, without any controller: free decay, energy, static limit, events
 * and imperfections one by one.
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
#include "../rigs/scene_assert.h"
#include "../rigs/testdata.h"
#include "../rigs/uniform.h"
#include "../../host_tools/model/certificate_make.h"
#include "../../host_tools/simulate/simulate_loop.h"
#include "../../host_tools/simulate/storm.h"

#ifdef __SANITIZE_ADDRESS__
enum { SANITIZED = 1 };
#else
enum { SANITIZED = 0 };
#endif

static const double pi = 3.14159265358979323846;

/* ---- modes alone ------------------------------------------------------ */

/* A structure of `modes` modes with one row each and two inputs. */
typedef struct rig {
    double frequency[8], damping[8], shape[64], response[16];
    modal modal;
    inertia inertia;
} rig;

static void open_rig(rig *r, int modes, double first, double damping)
{
    memset(r, 0, sizeof *r);
    for (int i = 0; i < modes; i++) {
        r->frequency[i] = first * (1 + 1.7 * i);
        r->damping[i] = damping;
        r->shape[i * modes + i] = 1;
        r->response[2 * i] = 1.0 / (1 + i);
        r->response[2 * i + 1] = 0.3 - 0.1 * i;
    }
    r->modal =
        (modal){(size_t)modes, (size_t)modes, 2, r->frequency, r->damping, r->shape, r->response};
    assert_true(inertia_open(&r->inertia, &r->modal));
}

/*
 * Free decay is exp(-damping w t) times the sine of the damped frequency, whatever the intervals:
 * to rounding. The sum of k intervals has a relative error of up to k epsilon/2, which turns the
 * exact value by w t times as much.
 */
static void test_free_decay(void **state)
{
    static const double damping[] = {0.001, 0.005, 0.1, 0.9};
    uint32_t seed = 1;
    (void)state;
    for (int c = 0; c < 4; c++) {
        rig r;
        double time = 0, y[3];
        open_rig(&r, 3, 94.5, damping[c]);
        for (int i = 0; i < 3; i++)
            r.inertia.velocity[i] = 1;
        for (int k = 0; k < 4000; k++) {
            const double interval = 1e-3 * (k % 2 ? 1 : 0.5 + uniform(&seed, 0, 1));
            inertia_advance(&r.inertia, interval);
            time += interval;
            inertia_observe(&r.inertia, 0, 3, y);
            for (int i = 0; i < 3; i++) {
                const double w = r.frequency[i], root = sqrt(1 - damping[c] * damping[c]);
                const double exact = exp(-damping[c] * w * time) * sin(w * root * time) / root;
                const double rounding = DBL_EPSILON * (k + 8) * (1 + w * time);
                if (!(fabs(y[i] - exact) <= rounding * exp(-damping[c] * w * time) / root + 1e-300))
                    fail_msg("damping %g, mode %d, t %g: %.17g instead of %.17g", damping[c], i,
                             time, y[i], exact);
            }
        }
        inertia_close(&r.inertia);
    }
}

/* Without inputs the energy of no mode rises, with any damping and any interval. */
static void test_energy_falls(void **state)
{
    uint32_t seed = 7;
    (void)state;
    for (int c = 0; c < 300; c++) {
        rig r;
        open_rig(&r, 5, pow(10, 4 * uniform(&seed, 0, 1)),
                 c % 10 == 0 ? 0 : pow(10, 4 * uniform(&seed, 0, 1) - 3));
        for (int i = 0; i < 5; i++) {
            r.inertia.deviation[i] = uniform(&seed, 0, 1) - 0.5;
            r.inertia.velocity[i] = uniform(&seed, 0, 1) - 0.5;
        }
        for (int k = 0; k < 50; k++) {
            const double before = inertia_energy(&r.inertia);
            inertia_advance(&r.inertia, pow(10, 4 * uniform(&seed, 0, 1) - 5));
            assert_true(inertia_energy(&r.inertia) <= before * (1 + 8 * DBL_EPSILON));
        }
        inertia_close(&r.inertia);
    }
}

/* An input that jumps leaves the displacement of the modes where it is, and an impulse changes the
 * velocity alone: by w^2 g seconds, so by w g seconds over w. */
static void test_jump_and_kick(void **state)
{
    rig r;
    const double input[2] = {2, -3}, zero[2] = {0, 0};
    (void)state;
    open_rig(&r, 4, 100, 0.01);
    inertia_rest(&r.inertia, zero);
    inertia_jump(&r.inertia, input);
    for (int i = 0; i < 4; i++) {
        const double equilibrium = r.response[2 * i] * 2 - r.response[2 * i + 1] * 3;
        assert_true(fabs(r.inertia.deviation[i] + equilibrium) <= 4 * DBL_EPSILON * 3);
    }
    inertia_rest(&r.inertia, input);
    inertia_kick(&r.inertia, 1, 0.02);
    for (int i = 0; i < 4; i++) {
        assert_true(r.inertia.deviation[i] == 0);
        assert_true(fabs(r.inertia.velocity[i] - r.frequency[i] * r.response[2 * i + 1] * 0.02) <=
                    1e-14);
    }
    inertia_close(&r.inertia);
}

/*
 * Law: where some of many inputs jump, the deviation of every mode falls by gain x response x
 * change, summed over these inputs; so it does after the gain has changed. Each term is rounded
 * three times (two products, one difference) in units of the largest sum.
 */
static void test_jumps_of_many_inputs(void **state)
{
    enum { MODES = 5, MANY = 150, JUMPS = 6 };
    static double response[MODES * MANY], input[MANY];
    double frequency[MODES] = {1, 2, 3, 4, 5}, damping[MODES] = {0}, shape[MODES] = {0},
           expected[MODES] = {0};
    const modal modal = {MODES, 1, MANY, frequency, damping, shape, response};
    inertia inertia;
    uint32_t seed = 3;
    (void)state;
    for (int i = 0; i < MODES * MANY; i++)
        response[i] = uniform(&seed, 0, 1) - 0.5;
    assert_true(inertia_open(&inertia, &modal));
    for (int jump = 0; jump < JUMPS; jump++) {
        inertia.gain = jump < JUMPS / 2 ? 0.8 : 1.33;
        for (int k = jump % 3; k < MANY; k += 1 + jump) {
            const double change = uniform(&seed, 0, 1) - 0.5;
            for (int i = 0; i < MODES; i++)
                expected[i] -= inertia.gain * response[i * MANY + k] * change;
            input[k] += change;
        }
        inertia_jump(&inertia, input);
    }
    for (int i = 0; i < MODES; i++)
        assert_true(fabs(inertia.deviation[i] - expected[i]) <=
                    3 * DBL_EPSILON * JUMPS * MANY * 0.5 * 0.5 * 1.33);
    inertia_close(&inertia);
}

/* The outputs are those of the oracle's matrix exponentials, to the rounding of these. */
static void check_oracle(const testdata *d)
{
    const testdata_array *shape = testdata_find(d, "shape"), *in = testdata_find(d, "input");
    const size_t rows = (size_t)shape->rows, inputs = (size_t)in->columns;
    const double *kick = testdata_values(d, "kick"), *fixed = testdata_values(d, "static"),
                 *expected = testdata_values(d, "output"),
                 *interval = testdata_values(d, "interval");
    const modal modal = {(size_t)shape->columns,
                         rows,
                         inputs,
                         testdata_find(d, "frequency")->value,
                         testdata_find(d, "damping")->value,
                         shape->value,
                         testdata_find(d, "response")->value};
    inertia inertia;
    double y[8];
    assert_true(rows <= 8 && inertia_open(&inertia, &modal));
    for (int step = 0; step < in->rows; step++) {
        const double *v = in->value + (size_t)step * inputs;
        for (size_t k = 0; k < inputs; k++)
            inertia_kick(&inertia, k, kick[(size_t)step * inputs + k]);
        inertia_jump(&inertia, v);
        inertia_advance(&inertia, interval[step]);
        inertia_observe(&inertia, 0, rows, y);
        for (size_t i = 0; i < rows; i++) {
            for (size_t k = 0; k < inputs; k++)
                y[i] += fixed[i * inputs + k] * v[k];
            if (!(fabs(y[i] - expected[(size_t)step * rows + i]) < 1e-10))
                fail_msg("%s, step %d, row %zu: %.15g instead of %.15g", d->name, step, i, y[i],
                         expected[(size_t)step * rows + i]);
        }
    }
    inertia_close(&inertia);
}

static void test_oracle(void **state)
{
    FILE *file = fopen(SOURCE_FOLDER "/tests/oracle/data/plant.txt", "r");
    testdata d;
    int cases = 0;
    (void)state;
    assert_non_null(file);
    for (; testdata_next(file, &d); cases++) {
        check_oracle(&d);
        testdata_free(&d);
    }
    fclose(file);
    assert_int_equal(cases, 3);
}

/* ---- the plant of a scene --------------------------------------------- */

#define LINEAR                                                                                     \
    "kinematics=linear;simulate.influence=undeformed;"                                             \
    "simulate.plant={kinematics: linear, hysteresis: 0, modes: 30};"                               \
    "simulate.sensors={noise: 0};simulate.amplifiers={step: 0};"
/* Without modes, where they do not matter. */
#define STILL LINEAR "simulate.plant.inertia=false;"
#define IDLE "simulate.events=[{at: 0, missed_ticks: 100000}]"

typedef struct bench {
    scene_run run;
    simulation s;
    loop loop;
    char error[SCENE_ERROR];
} bench;

static void open_loop(bench *b, const char *changes, int quasi_static)
{
    memset(b, 0, sizeof *b);
    open_run(&b->run, "plate-closed-loop", changes);
    b->run.analysis.quasi_static = quasi_static;
    if (analysis_influence(&b->run.analysis, b->error) < 0 ||
        simulate_open(&b->s, &b->run.analysis, b->error) < 0 ||
        loop_open(&b->loop, &b->s, LAW_CONTROLLER, b->error) < 0)
        fail_msg("%s", b->error);
}

/* A loop whose controller has no vibration model. */
static void open_bench(bench *b, const char *changes)
{
    open_loop(b, changes, 1);
}

static void close_bench(bench *b)
{
    loop_close(&b->loop);
    simulate_close(&b->s);
    scene_run_close(&b->run);
}

static void tick(bench *b, int number)
{
    if (loop_tick(&b->loop, number, b->error) < 0)
        fail_msg("%s", b->error);
}

#define SLOW                                                                                       \
    LINEAR "control.rate=0.01;dynamics={damping: 0.7};simulate.ticks=200;simulate.events=[{at: "   \
           "60, target: 0.5}, {at: 100, load: 0, factor: 3}, {at: 110, dead: [v_2_2]}];"

/*
 * The static limit: nearly critical damping and ticks of 100 s, so that every mode has come to rest
 * when the next tick is taken. The whole closed loop is then that around the quasi-static plant.
 */
static void test_static_limit(void **state)
{
    bench with, without;
    (void)state;
    open_bench(&with, SLOW "simulate.plant.inertia=true");
    open_bench(&without, SLOW "simulate.plant.inertia=false");
    assert_true(with.s.plant.has_inertia && !without.s.plant.has_inertia);
    assert_int_equal(with.s.plant.modal.modes, 30);
    for (int k = 0; k < 200; k++) {
        tick(&with, k);
        tick(&without, k);
        /* A load that changes at a tick moves the modes after it: one tick later than the
         * quasi-static plant, until both have settled. */
        if (k < 100 || k > 180)
            assert_near("error of the shape", with.loop.error, without.loop.error, 1e-10);
    }
    close_bench(&with);
    close_bench(&without);
}

/* Root of the sum of squares of the targets' deviation from the static equilibrium. */
static double vibration_of(const bench *b)
{
    double sum = 0;
    for (int i = 0; i < b->loop.design->targets; i++)
        sum += b->s.plant.deviation[i] * b->s.plant.deviation[i];
    return sqrt(sum);
}

/* Amplitude of the first mode about the equilibrium without the load. */
static double amplitude(const bench *b)
{
    const inertia *inertia = &b->s.plant.inertia;
    const size_t load = (size_t)b->loop.design->amplifiers;
    const double equilibrium = inertia->modal->response[load] * inertia->input[load];
    return hypot(inertia->deviation[0] + equilibrium, inertia->velocity[0]);
}

/*
 * A load at the frequency of the first mode: the mode grows to its static displacement over twice
 * the damping ratio, here 1/(2 0.05) times. Three other modes of the plate move with less than 1 %.
 * The parts of an interval hold the load: first order in w T / 8, here below 0.2 %.
 */
static void test_resonance(void **state)
{
    bench b;
    char changes[500];
    double most = 0;
    (void)state;
    open_bench(&b, LINEAR "simulate.plant.inertia=true;" IDLE);
    const double first = b.s.plant.modal.frequency[0] / (2 * pi);
    close_bench(&b);
    snprintf(changes, sizeof changes,
             LINEAR
             "simulate.plant.inertia=true;dynamics={damping: 0.05};simulate.ticks=1200;"
             "simulate.events=[{at: 0, missed_ticks: 1200}, {at: 0, load: 0, factor: 0}, {at: 1, "
             "load: 0, factor: 0.2, frequency: %.15g, ticks: 1100}]",
             first);
    open_bench(&b, changes);
    const modal *m = &b.s.plant.modal;
    const double equilibrium = fabs(0.2 * m->response[b.loop.design->amplifiers]);
    for (int k = 0; k < 1100; k++) {
        tick(&b, k);
        if (k > 1000)
            most = fmax(most, amplitude(&b));
    }
    assert_near("amplitude at resonance", most, 10 * equilibrium, 0.01);
    /* When the sine ends, the plate decays freely: twenty periods leave exp(-20 2 pi 0.05) of it.
     */
    for (int k = 1100; k < 1200; k++)
        tick(&b, k);
    const double periods = 100 * 1e-3 * first;
    assert_near("decay", amplitude(&b) / most, exp(-2 * pi * 0.05 * periods), 0.1);
    close_bench(&b);
}

/* An impulse moves every mode by w g seconds sin(w t) exp(-damping w t); nothing moves before it.
 */
static void test_impulse(void **state)
{
    bench b;
    (void)state;
    open_bench(&b, LINEAR "simulate.plant.inertia=true;simulate.ticks=60;simulate.events=[{at: 0, "
                          "missed_ticks: 60}, {at: 20, load: 0, impulse: 0.003}]");
    const modal *m = &b.s.plant.modal;
    const size_t load = (size_t)b.loop.design->amplifiers;
    for (int k = 0; k < 60; k++) {
        tick(&b, k);
        if (k < 20)
            assert_true(vibration_of(&b) == 0);
        for (size_t i = 0; i < m->modes && k > 20; i++) {
            const double w = m->frequency[i], z = m->damping[i], root = sqrt(1 - z * z);
            const double t = 1e-3 * (k - 20), size = w * m->response[i * m->inputs + load] * 0.003;
            const double exact = size * exp(-z * w * t) * sin(w * root * t) / root;
            assert_true(fabs(b.s.plant.inertia.deviation[i] - exact) <=
                        64 * DBL_EPSILON * fabs(size) * (1 + w * t));
        }
    }
    close_bench(&b);
}

/* Give constant voltages at tick 0, and return the deviation of the first mode at tick 1. */
static double after_step(const char *changes)
{
    bench b;
    open_bench(&b, changes);
    tick(&b, 0);
    for (int k = 0; k < b.loop.design->amplifiers; k++)
        b.loop.output[k] = 100;
    tick(&b, 1);
    const double q = b.s.plant.inertia.deviation[0];
    close_bench(&b);
    return q;
}

/*
 * Voltages that act late act for the rest of the interval only; an interval that varies is longer
 * or shorter by the part that is drawn. Deviation of the first mode after voltages 0 -> 100 V:
 * -g 100 cos(w t) for the time t during which they acted.
 */
static void test_late_and_jitter(void **state)
{
    static const char *const event[] = {"", ", {at: 0, late: 0.9, ticks: 9}",
                                        ", {at: 0, jitter: 0.9, ticks: 9}"};
    double acted[3];
    (void)state;
    for (int c = 0; c < 3; c++) {
        char changes[500];
        bench b;
        snprintf(changes, sizeof changes,
                 LINEAR "simulate.plant.inertia=true;simulate.ticks=20;simulate.events=[{at: 0, "
                        "missed_ticks: 20}%s]",
                 event[c]);
        open_bench(&b, changes);
        const modal *m = &b.s.plant.modal;
        double g = 0;
        for (int k = 0; k < b.loop.design->amplifiers; k++)
            g += 100 * m->response[k];
        const double w = m->frequency[0];
        close_bench(&b);
        /* q/g = 1 - exp(-z w t)(cos + ..): t from the angle; damping 0.005 changes it by 1 %. */
        acted[c] = acos(fmin(1, fabs(after_step(changes) / g))) / w;
    }
    assert_near("time on time", acted[0], 1e-3, 0.05);
    assert_true(acted[1] > 0.1e-3 && acted[1] < 0.98e-3);
    assert_true(fabs(acted[2] / 1e-3 - 1) > 0.01 && acted[2] > 0.1e-3 && acted[2] < 1.9e-3);
}

/* A delay beyond the believed one: the readings are those of so many ticks before. */
static void test_more_delay(void **state)
{
    bench b;
    double history[40];
    (void)state;
    open_bench(&b, LINEAR
               "simulate.plant.inertia=true;simulate.ticks=40;simulate.events=[{at: 0, "
               "missed_ticks: 40}, {at: 2, load: 0, impulse: 0.003}, {at: 10, delay: 3, ticks: "
               "10}]");
    for (int k = 0; k < 40; k++) {
        tick(&b, k);
        history[k] = b.loop.shape[60];
        assert_true(b.loop.sensed[60] == history[k >= 10 && k < 20 ? k - 3 : k]);
    }
    close_bench(&b);
}

static void actuate(bench *b, const double *output, double interval, double *effect)
{
    const imperfections on = loop_imperfections(&b->loop);
    imperfections_actuate(&on, output, interval, effect);
}

static double sense(bench *b, int sensor, double value)
{
    const imperfections on = loop_imperfections(&b->loop);
    return imperfections_sense(&on, sensor, value);
}

/* ---- imperfections ---------------------------------------------------- */

/*
 * The amplifiers' lag: a step reaches 1 - exp(-2 pi f t), and its mean over an interval is exact.
 * Creep: c of the voltage for each time constant. Cables: swapped and reversed.
 */
static void test_actuators(void **state)
{
    double effect[64], output[64], sum = 0;
    bench b;
    (void)state;
    open_bench(&b, STILL "simulate.amplifiers={step: 0, bandwidth: "
                         "40 Hz, swapped: [v_1_1, v_1_2], reversed: [v_1_3]};" IDLE);
    for (int k = 0; k < 25; k++)
        output[k] = 10 + k;
    for (int i = 0; i < 30; i++) {
        actuate(&b, output, 1e-3, effect);
        sum += effect[5] * 1e-3;
        const double tau = 1 / (2 * pi * 40), t = 1e-3 * (i + 1);
        assert_near("integral of a lagging step", sum, 15 * (t + tau * expm1(-t / tau)), 1e-12);
    }
    actuate(&b, output, 0, effect);
    const double part = -expm1(-2 * pi * 40 * 30e-3);
    assert_near("lag", effect[5], 15 * part, 1e-12);
    assert_near("swapped", effect[0], 11 * part, 1e-12);
    assert_near("swapped", effect[1], 10 * part, 1e-12);
    assert_near("reversed", effect[2], -12 * part, 1e-12);
    close_bench(&b);
    open_bench(&b, STILL "simulate.plant.creep=0.02;" IDLE);
    for (int i = 0; i < 5000; i++)
        actuate(&b, output, 1e-3, effect);
    actuate(&b, output, 0, effect);
    const double grown = 3 - exp(-50) - exp(-5) - exp(-0.5);
    assert_near("creep after 5 s", effect[3], 13 * (1 + 0.02 * grown), 1e-11);
    close_bench(&b);
}

/* The width of the hysteresis loop is as asked, and does not depend on the rate. */
static void test_hysteresis_rate(void **state)
{
    double width[2];
    (void)state;
    for (int fine = 0; fine < 2; fine++) {
        bench b;
        double at_zero[2] = {0, 0}, output[64] = {0}, effect[64];
        const int steps = fine ? 4000 : 40;
        open_bench(&b, STILL "simulate.plant.hysteresis=0.15;" IDLE);
        for (int i = 0; i <= 2 * steps; i++) {
            const double phase = 4.0 * (i % steps) / steps;
            const double falling = phase < 3 ? 2 - phase : phase - 4;
            output[3] = 300 * (phase < 1 ? phase : falling);
            actuate(&b, output, fine ? 1e-5 : 1e-2, effect);
            if (i == steps + steps / 2 || i == 2 * steps)
                at_zero[i == 2 * steps] = effect[3];
        }
        width[fine] = at_zero[0] - at_zero[1];
        assert_true(fabs(width[fine] - 0.15 * 600) < 1e-12 * 600);
        close_bench(&b);
    }
    assert_true(fabs(width[0] - width[1]) < 1e-12 * 600);
}

/* A piezoceramic between finite limits has 10 % of hysteresis unless the scene says otherwise. */
static void test_usual_hysteresis(void **state)
{
    static const struct {
        const char *changes;
        double expected;
    } of[] = {{"simulate.plant={kinematics: linear}", 0.1},
              {"simulate.plant={hysteresis: 0}", 0},
              {"simulate.plant={hysteresis: 0.2}", 0.2},
              {"simulate.plant={kinematics: linear};limits={step_limit: 20}", 0}};
    (void)state;
    for (int i = 0; i < 4; i++) {
        scene_run run;
        char changes[200];
        snprintf(changes, sizeof changes, "kinematics=linear;simulate.influence=undeformed;%s",
                 of[i].changes);
        open_run(&run, "plate-closed-loop", changes);
        assert_int_equal(analysis_influence(&run.analysis, run.error), 0);
        assert_true(imperfections_hysteresis(&run.analysis.design) == of[i].expected);
        scene_run_close(&run);
    }
}

/* Sensors: drift in proportion to time, steps of the converter, and as many outliers as asked. */
static void test_sensors(void **state)
{
    bench b;
    int outliers = 0;
    (void)state;
    open_bench(&b, STILL "simulate.sensors={drift: 1e-6};" IDLE);
    for (int i = 0; i < b.loop.sensors; i++) {
        b.loop.time = 2;
        const double twice = sense(&b, i, 0);
        b.loop.time = 4;
        assert_near("drift", sense(&b, i, 0), 2 * twice, 1e-14);
        assert_true(fabs(twice) <= 2e-6);
    }
    close_bench(&b);
    open_bench(&b, STILL "simulate.sensors={quantum: 2e-7};" IDLE);
    assert_near("quantum", sense(&b, 0, 5.2e-7), 6e-7, 1e-14);
    assert_near("quantum", sense(&b, 0, -4.9e-7), -4e-7, 1e-14);
    close_bench(&b);
    open_bench(&b, STILL "simulate.sensors={outliers: {chance: 0.1, size: 1e-3}};" IDLE);
    for (int i = 0; i < 10000; i++) {
        const double reading = sense(&b, 0, 0);
        outliers += reading != 0;
        assert_true(fabs(reading) <= 1e-3);
    }
    assert_true(abs(outliers - 1000) < 150); /* five standard deviations of 30 */
    close_bench(&b);
}

/* ---- nonlinear motion -------------------------------------------------- */

#define NONLINEAR                                                                                  \
    "kinematics=nonlinear;simulate.influence=undeformed;simulate.ticks=40;"                        \
    "simulate.sensors={noise: 0};simulate.amplifiers={step: 0};"

/*
 * Shapes of the plant in 40 ticks after a small voltage at all electrodes and a small impulse.
 *   shape [40][targets] out
 */
static void vibrate(const char *motion, double *shape, size_t *targets)
{
    bench b;
    char changes[600];
    snprintf(changes, sizeof changes,
             NONLINEAR "simulate.plant={kinematics: nonlinear, hysteresis: 0, motion: %s};"
                       "simulate.events=[{at: 0, missed_ticks: 40}, {at: 0, load: 0, factor: 0}, "
                       "{at: 12, load: 0, impulse: 1e-6}]",
             motion);
    open_bench(&b, changes);
    *targets = (size_t)b.loop.design->targets;
    for (int k = 0; k < 40; k++) {
        tick(&b, k);
        memcpy(shape + (size_t)k * *targets, b.loop.shape, *targets * sizeof *shape);
        for (int i = 0; i < b.loop.design->amplifiers; i++)
            b.loop.output[i] = 0.01;
    }
    close_bench(&b);
}

/*
 * Small vibrations of a nonlinear plant with all its degrees of freedom are those in the modes of
 * the undeformed state. Of the fastest mode with half a radian a step, the phase is wrong by a part
 * of 0.5^2/12; the first modes, which make most of the shape, are far below.
 */
static void test_small_vibration(void **state)
{
    double *shape[2];
    size_t targets = 0;
    (void)state;
    for (int i = 0; i < 2; i++) {
        shape[i] = calloc(40 * 200, sizeof *shape[i]);
        assert_non_null(shape[i]);
        vibrate(i ? "modal" : "nonlinear", shape[i], &targets);
        assert_true(targets <= 200);
    }
    double difference = 0, size = 0;
    for (size_t i = 0; i < 40 * targets; i++) {
        difference = hypot(difference, shape[0][i] - shape[1][i]);
        size = hypot(size, shape[1][i]);
    }
    print_message("    nonlinear and modal motion differ by %.4f\n", difference / size);
    assert_true(size > 0 && difference < 0.02 * size);
    free(shape[0]);
    free(shape[1]);
}

/* ---- which plant ------------------------------------------------------ */

/* Inertia by default where all densities are given; never without; as the scene says. */
static void test_which(void **state)
{
    static const struct {
        const char *changes;
        bool has_inertia;
        const char *reason;
    } of[] = {{"simulate.plant={kinematics: linear}", true, ""},
              {"simulate.plant={inertia: false}", false, "inertia: false"},
              {"simulate.plant={kinematics: linear};materials.G1195.density=0", false, "'G1195'"}};
    (void)state;
    for (int i = 0; i < 3; i++) {
        bench b;
        char changes[200];
        snprintf(changes, sizeof changes, "kinematics=linear;simulate.influence=undeformed;%s",
                 of[i].changes);
        open_bench(&b, changes);
        assert_int_equal(b.s.plant.has_inertia, of[i].has_inertia);
        assert_non_null(strstr(b.s.plant.reason, of[i].reason));
        close_bench(&b);
    }
}

/* Damping by one ratio, by a list whose last entry holds on, and by Rayleigh's coefficients. */
static void test_damping(void **state)
{
    (void)state;
    bench b;
    open_bench(&b, LINEAR "simulate.plant.inertia=true;dynamics={damping: [0.01, 0.02]};" IDLE);
    assert_true(b.s.plant.modal.damping[0] == 0.01 && b.s.plant.modal.damping[1] == 0.02 &&
                b.s.plant.modal.damping[20] == 0.02);
    close_bench(&b);
    open_bench(&b, LINEAR
               "simulate.plant.inertia=true;dynamics={damping: {rayleigh: [3, 1e-5]}};" IDLE);
    const double w = b.s.plant.modal.frequency[7];
    assert_near("Rayleigh", b.s.plant.modal.damping[7], 1.5 / w + 0.5e-5 * w, 1e-14);
    close_bench(&b);
}

static void test_refused(void **state)
{
    static const refusal bad[] = {
        {"dynamics={damping: []}", "empty list"},
        {"dynamics={damping: [0.1, 2]}", "between 0 and 1"},
        {"dynamics={damping: {rayleigh: [0, 0]}}", "both of Rayleigh's"},
        {"dynamics={damping: {rayleigh: [-1, 0]}}", "rayleigh"},
        {"simulate.plant.modes=0", "from 1 to 200"},
        {"simulate.plant={kinematics: linear, motion: nonlinear}", "needs a nonlinear plant"},
        {"simulate.plant.motion=waltz", "waltz"},
        {"simulate.plant={kinematics: linear, steps: 5}", "'steps' belongs to motion: nonlinear"},
        {"simulate.plant={kinematics: nonlinear, motion: modal, steps: 5}", "'steps' belongs"},
        {"simulate.plant={kinematics: nonlinear, motion: nonlinear, modes: 5}",
         "'modes' belongs to motion: modal"},
        {"simulate.plant={kinematics: nonlinear, modes: 5}", "'modes' belongs to motion: modal"},
        {"simulate.plant={kinematics: nonlinear, inertia: false, motion: nonlinear}",
         "'motion' belongs to a plant with inertia"},
        {"simulate.plant.steps=0", "from 1 to 1000"},
        {"simulate.plant.creep=0.5", "creep"},
        {"simulate.amplifiers={bandwidth: 0}", "bandwidth"},
        {"simulate.amplifiers={swapped: [v_1_1]}", "not pairs"},
        {"simulate.amplifiers={swapped: [v_1_1, v_1_1]}", "'v_1_1' is named twice"},
        {"simulate.amplifiers={swapped: [v_1_1, v_1_2, v_1_2, v_1_3]}", "'v_1_2' is named twice"},
        {"simulate.amplifiers={reversed: [v_1_2, v_1_1, v_1_2]}", "'v_1_2' is named twice"},
        {"simulate.amplifiers={reversed: [w]}", "no actuator 'w'"},
        {"simulate.sensors={outliers: {chance: 2, size: 1}}", "chance"},
        {"simulate.sensors={quantum: -1}", "quantum"},
        {"simulate.events=[{at: 0, load: 0, impulse: 1, factor: 1}]", "impulse"},
        {"simulate.events=[{at: 0, load: 0, frequency: 3 Hz}]", "factor"},
        {"simulate.events=[{at: 0, load: 0, factor: 1, frequency: 3 Hz}]", "add ticks"},
        {"simulate.events=[{at: 0, late: 0.95, ticks: 5}]", "between 0 and 0.9"},
        {"simulate.events=[{at: 0, jitter: 0.5}]", "add ticks"},
        {"simulate.events=[{at: 0, delay: 17, ticks: 3}]", "0 to 16"},
        {"simulate.events=[{at: 0, target: 1, impulse: 3}]", "impulse"},
    };
    scene_run run;
    simulation s;
    (void)state;
    assert_refused("plate-closed-loop", bad, sizeof bad / sizeof *bad);
    open_run(&run, "plate-closed-loop",
             LINEAR "simulate.plant.inertia=false;simulate.events=[{at: 0, load: 0, impulse: 1}]");
    assert_int_equal(analysis_influence(&run.analysis, run.error), 0);
    assert_int_equal(simulate_open(&s, &run.analysis, run.error), -1);
    assert_non_null(strstr(run.error, "needs a plant with inertia"));
    scene_run_close(&run);
}

/* ---- the control loop on the plant ------------------------------------ */

#define TARGET_STEP                                                                                \
    LINEAR "simulate.plant.inertia=true;simulate.ticks=400;simulate.events=[{at: 0, load: 0, "     \
           "factor: 0}]"

/* The control step without a vibration model diverges on the demo's plate at 1000 ticks a second;
 * with one the shape settles within 1 % of the target of the optimum, and the vibration decays. */
static void test_step(void **state)
{
    bench b;
    (void)state;
    open_bench(&b, TARGET_STEP);
    for (int k = 0; k < 400; k++)
        tick(&b, k);
    print_message("    without a vibration model: %.0f times the target after 400 ticks\n",
                  b.loop.error);
    assert_true(b.loop.error > 10 && isfinite(b.loop.error));
    close_bench(&b);
    open_loop(&b, TARGET_STEP, 0);
    assert_true(b.loop.is_damped);
    for (int k = 0; k < 400; k++)
        tick(&b, k);
    print_message("    with one: %.4f of the target, vibration %.5f\n", b.loop.error,
                  b.loop.vibration);
    assert_true(b.loop.error < 0.07 && b.loop.vibration < 0.002);
    close_bench(&b);
}

/* Growth of the step without a vibration model, measured with the loop itself, over the spectral
 * radius of its matrix; in as many modes. */
static double growth_over_radius(const char *changes)
{
    scene_run run;
    storm_rig rig;
    storm_result result;
    const estimator none = {0};
    const damper unused = {0};
    const storm_plant model = {.gain = 1, .frequency = 1, .step_limit = HUGE_VAL, .seed = 5};
    loop_blocks blocks;
    open_run(&run, "plate-closed-loop", changes);
    assert_int_equal(analysis_influence(&run.analysis, run.error), 0);
    certificate_make(&run.analysis.certificate, &run.analysis);
    loop_blocks_fill(&blocks, &run.analysis.design, &none, &unused);
    assert_int_equal(storm_open(&rig, &run.analysis, NULL, run.error), 0);
    storm_use(&rig, blocks.block, blocks.count, run.scene.simulate.delay);
    if (storm_growth(&rig, &model, 600, &result, run.error) < 0)
        fail_msg("%s", run.error);
    const double radius = run.analysis.certificate.radius;
    print_message("    radius %.5f, growth of %d ticks %.5f\n", radius, result.ticks,
                  result.growth);
    storm_close(&rig);
    scene_run_close(&run);
    return result.growth / radius;
}

/*
 * The growth that a storm rig measures is the spectral radius that the certificate computes: two
 * programs that share neither the loop nor the structure. The largest root dominates only in the
 * end, so that a run over 1e6 knows it within some per cent of its distance from 1.
 */
static void test_growth_is_radius(void **state)
{
    static const char *const of[] = {LINEAR "", LINEAR "dynamics={damping: 0.3};control.rate=300",
                                     LINEAR "dynamics={damping: 0.1};simulate.sensors={delay: 1}",
                                     LINEAR "dynamics={damping: 0.4};control.rate=60"};
    (void)state;
    for (int i = 0; i < 4; i++)
        assert_true(fabs(growth_over_radius(of[i]) - 1) < 0.01);
}

/* A missed tick is predicted over: vibration goes on to decay, and the shape ends where it would.
 */
static void test_missed_ticks(void **state)
{
    double end[2];
    (void)state;
    for (int i = 0; i < 2; i++) {
        bench b;
        open_loop(&b,
                  i ? LINEAR "simulate.plant.inertia=true;simulate.ticks=600;simulate.events=[{at: "
                             "0, load: 0, factor: 0}, {at: 60, missed_ticks: 40}]"
                    : LINEAR "simulate.plant.inertia=true;simulate.ticks=600;simulate.events=[{at: "
                             "0, load: 0, factor: 0}]",
                  0);
        for (int k = 0; k < 600; k++)
            tick(&b, k);
        end[i] = b.loop.error;
        close_bench(&b);
    }
    assert_near("error after missed ticks", end[1], end[0], 0.01);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_free_decay),
        cmocka_unit_test(test_energy_falls),
        cmocka_unit_test(test_jump_and_kick),
        cmocka_unit_test(test_oracle),
        cmocka_unit_test(test_jumps_of_many_inputs),
        cmocka_unit_test(test_static_limit),
        cmocka_unit_test(test_resonance),
        cmocka_unit_test(test_impulse),
        cmocka_unit_test(test_late_and_jitter),
        cmocka_unit_test(test_more_delay),
        cmocka_unit_test(test_actuators),
        cmocka_unit_test(test_hysteresis_rate),
        cmocka_unit_test(test_usual_hysteresis),
        cmocka_unit_test(test_sensors),
        cmocka_unit_test(test_which),
        cmocka_unit_test(test_damping),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_small_vibration),
        cmocka_unit_test(test_step),
        cmocka_unit_test(test_missed_ticks),
        cmocka_unit_test(test_growth_is_radius),
    };
    /* Under the sanitizers the last four, with storms and long runs, would take too long. */
    const size_t count = sizeof tests / sizeof *tests;
    return _cmocka_run_group_tests("plant", tests, SANITIZED ? count - 4 : count, NULL, NULL);
}
