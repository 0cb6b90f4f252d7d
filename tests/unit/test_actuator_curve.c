/*
 * Actuator curves: effects against their definition, the inverse against the effect, limits and
 * step limits of voltages in a loop to the last bit at both ends, optimum in effects, refused
 * curves.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../lib/control/actuator_curve.h"

#ifdef __SANITIZE_ADDRESS__
enum { SHARE = 10 }; /* one of so many repetitions is run with the sanitizers */
#else
enum { SHARE = 1 };
#endif

enum { N = 6, M = 20, POINTS = 9 };
enum { MOST_INPUTS = N, MOST_OUTPUTS = M };

#include "../rigs/problem_rig.h"

typedef struct rig {
    pzs_actuator_curves curves;
    pzs_real voltage[N * POINTS], effect[N * POINTS], bend[N * (POINTS - 1)];
    problem_rig problem;
    pzs_amplifier amplifier;
    pzs_real wanted[M], measured[M], given[N];
    pzs_block block[6];
    size_t count;
    pzs_loop loop;
    void *work;
    unsigned seed;
} rig;

static double draw(rig *r, double least, double most)
{
    return uniform(&r->seed, least, most);
}

/* Draw a rising curve of input k with slopes that differ by up to a factor of 100. */
static void fill_curve(rig *r, int k)
{
    double voltage = draw(r, -200, 50), effect = draw(r, -3, 3);
    for (int i = 0; i < POINTS; i++) {
        r->voltage[k * POINTS + i] = (pzs_real)voltage;
        r->effect[k * POINTS + i] = (pzs_real)effect;
        const double step = draw(r, 2, 40);
        voltage += step;
        effect += step * draw(r, 0.001, 0.1);
    }
    for (int i = 0; i < POINTS - 1; i++) {
        const double bend = draw(r, -1.5, 1.5);
        r->bend[k * (POINTS - 1) + i] = (pzs_real)fmin(fmax(bend, -1), 1);
    }
}

static void append(rig *r, const pzs_block_type *type, const void *tables)
{
    r->block[r->count++] = (pzs_block){type, tables};
}

static void list_blocks(rig *r, bool is_quantised)
{
    r->count = 0;
    append(r, &pzs_curve_block, &r->curves);
    append(r, &pzs_step_block, &r->problem.tables);
    append(r, &pzs_curve_inverse_block, &r->curves);
    if (is_quantised)
        append(r, &pzs_amplifier_block, &r->amplifier);
}

static pzs_status init(rig *r)
{
    const pzs_status status = start_loop(&r->loop, r->block, r->count, &r->work);
    if (status == PZS_OK)
        memcpy(r->given, r->loop.info.voltage, sizeof r->given);
    return status;
}

/* The effects of one input of a column of the influence matrix all make shapes of about 1e-5 m. */
static void fill_influence(rig *r)
{
    for (int i = 0; i < M; i++)
        for (int k = 0; k < N; k++) {
            const pzs_real *effect = r->effect + k * POINTS;
            r->problem.influence[i * N + k] =
                (pzs_real)(draw(r, -1e-5, 1e-5) / (double)(effect[POINTS - 1] - effect[0]));
        }
}

/* A problem on actuators of random curves, with voltage limits at the ends of the curves. */
static void open_rig(rig *r, unsigned seed)
{
    memset(r, 0, sizeof *r);
    r->seed = seed;
    for (int k = 0; k < N; k++)
        fill_curve(r, k);
    r->curves = (pzs_actuator_curves){.scene = SCENE,
                                      .inputs = N,
                                      .sets = N,
                                      .points = POINTS,
                                      .voltage = r->voltage,
                                      .effect = r->effect,
                                      .bend = r->bend};
    assert_int_equal(pzs_actuator_curves_seal(&r->curves), PZS_OK);
    r->amplifier = (pzs_amplifier){PZS_R(0.05), PZS_R(0.02)};
    problem_open(&r->problem, N, M, 0, 0, 0);
    fill_influence(r);
    for (int k = 0; k < N; k++) {
        const pzs_real *voltage = r->voltage + k * POINTS;
        r->problem.lower[k] = voltage[0];
        r->problem.upper[k] = voltage[POINTS - 1];
        r->problem.step_limit[k] =
            (pzs_real)(draw(r, 0.02, 0.3) * (double)(voltage[POINTS - 1] - voltage[0]));
    }
    problem_seal(&r->problem);
    list_blocks(r, false);
}

static double range_of(const pzs_real *number)
{
    return (double)(number[POINTS - 1] - number[0]) + fabs((double)number[0]);
}

static pzs_real effect_of(const rig *r, int k, pzs_real voltage)
{
    return pzs_actuator_curve_effect(&r->curves, (uint32_t)k, voltage);
}

static pzs_real voltage_of(const rig *r, int k, pzs_real effect)
{
    return pzs_actuator_curve_voltage(&r->curves, (uint32_t)k, effect);
}

/* ---- curves --------------------------------------------------------------- */

/* The effect by its definition, in segment i of the curve of input k. */
static long double textbook(const rig *r, int k, int i, long double voltage)
{
    const pzs_real *v = r->voltage + k * POINTS + i, *e = r->effect + k * POINTS + i;
    const long double t = (voltage - (long double)v[0]) / ((long double)v[1] - (long double)v[0]);
    const long double b = (long double)r->bend[k * (POINTS - 1) + i];
    return (long double)e[0] + ((long double)e[1] - (long double)e[0]) * t * (1 - b * (1 - t));
}

/*
 * Laws: the effect is that of the definition. At each point of the curve, effect and voltage are
 * those of the tables to the last bit. Outside the curve, and for NaN, both are those of an end.
 */
static void test_textbook(void **state)
{
    static rig r;
    (void)state;
    for (unsigned seed = 1; seed <= 100 / SHARE; seed++) {
        open_rig(&r, seed);
        for (int k = 0; k < N; k++) {
            const pzs_real *v = r.voltage + k * POINTS, *e = r.effect + k * POINTS;
            for (int i = 0; i < POINTS; i++) {
                assert_true(effect_of(&r, k, v[i]) == e[i]);
                assert_true(voltage_of(&r, k, e[i]) == v[i]);
            }
            for (int trial = 0; trial < 100; trial++) {
                const int i = (int)draw(&r, 0, POINTS - 1);
                const pzs_real voltage = (pzs_real)draw(&r, (double)v[i], (double)v[i + 1]);
                const double error = (double)((long double)effect_of(&r, k, voltage) -
                                              textbook(&r, k, i, (long double)voltage));
                assert_true(fabs(error) <= 8 * (double)PZS_EPSILON * range_of(e));
            }
            assert_true(effect_of(&r, k, v[0] - 1) == e[0]);
            assert_true(effect_of(&r, k, v[POINTS - 1] + 1) == e[POINTS - 1]);
            assert_true(effect_of(&r, k, (pzs_real)NAN) == e[0]);
            assert_true(voltage_of(&r, k, e[0] - 1) == v[0]);
            assert_true(voltage_of(&r, k, e[POINTS - 1] + 1) == v[POINTS - 1]);
            assert_true(voltage_of(&r, k, (pzs_real)NAN) == v[0]);
        }
    }
}

/*
 * Law: the effect of the inverse is the wanted effect up to the rounding of effect and voltage. The
 * slope of a segment is at most twice that of its straight line, which is at most 0.1 per volt.
 */
static void test_inverse(void **state)
{
    static rig r;
    (void)state;
    for (unsigned seed = 1; seed <= 200 / SHARE; seed++) {
        open_rig(&r, 1000 + seed);
        for (int k = 0; k < N; k++) {
            const pzs_real *v = r.voltage + k * POINTS, *e = r.effect + k * POINTS;
            const double exact = 8 * (double)PZS_EPSILON * (range_of(e) + 2 * 0.1 * range_of(v));
            pzs_real last = v[0], effect = e[0];
            for (int trial = 0; trial < 200; trial++) {
                const pzs_real wanted = (pzs_real)draw(&r, (double)e[0], (double)e[POINTS - 1]);
                const pzs_real voltage = voltage_of(&r, k, wanted);
                assert_true(voltage >= v[0] && voltage <= v[POINTS - 1]);
                assert_true(fabs((double)(effect_of(&r, k, voltage) - wanted)) <= exact);
                const bool rises = wanted > effect ? voltage >= last : voltage <= last;
                assert_true(rises || fabs((double)(wanted - effect)) <= exact);
                last = voltage;
                effect = wanted;
            }
        }
    }
}

/*
 * Law: the square of the voltage between two limits is one segment of the bend (v1 - v0) / (v1 +
 * v0). From 0 V, the inverse is the square root, and small voltages keep their relative accuracy.
 */
static void test_square(void **state)
{
    static const double lowest[] = {0, 30};
    (void)state;
    for (size_t trial = 0; trial < sizeof lowest / sizeof *lowest; trial++) {
        const double low = lowest[trial], high = 200;
        pzs_real voltage[2] = {(pzs_real)low, (pzs_real)high};
        pzs_real effect[2] = {(pzs_real)(low * low), (pzs_real)(high * high)};
        pzs_real bend = (pzs_real)((high - low) / (high + low));
        pzs_actuator_curves curves = {.inputs = N,
                                      .sets = 1,
                                      .points = 2,
                                      .voltage = voltage,
                                      .effect = effect,
                                      .bend = &bend};
        assert_int_equal(pzs_actuator_curves_seal(&curves), PZS_OK);
        for (double v = high; v > low; v = low + (v - low) * 0.9 - 1e-9) {
            const pzs_real at = (pzs_real)v;
            const double square = (double)at * (double)at, rounding = 8 * (double)PZS_EPSILON;
            const pzs_real found = pzs_actuator_curve_effect(&curves, N - 1, at);
            assert_true(fabs((double)found - square) <= rounding * square);
            const double back = (double)pzs_actuator_curve_voltage(&curves, 2, found);
            assert_true(fabs(back - (double)at) <= rounding * (double)at);
        }
    }
}

/* ---- loop ----------------------------------------------------------------- */

/* Measure the shape of actuators with the curves of the tables, times `gain`. */
static void measure(rig *r, double gain)
{
    for (int i = 0; i < M; i++) {
        r->measured[i] = (pzs_real)draw(r, -1e-12, 1e-12);
        for (int k = 0; k < N; k++)
            r->measured[i] +=
                (pzs_real)gain * r->problem.influence[i * N + k] * effect_of(r, k, r->given[k]);
    }
}

/* Shape of random effects around the middle of their ranges, `factor` times the ranges wide. */
static void throw_target(rig *r, double factor)
{
    memset(r->wanted, 0, sizeof r->wanted);
    for (int k = 0; k < N; k++) {
        const pzs_real *e = r->effect + k * POINTS;
        const double low = (double)e[0], high = (double)e[POINTS - 1];
        const double effect = (low + high) / 2 + draw(r, -factor, factor) * (high - low) / 2;
        for (int i = 0; i < M; i++)
            r->wanted[i] += r->problem.influence[i * N + k] * (pzs_real)effect;
    }
}

/* How often voltages have reached their limits and their step limits. */
typedef struct reached {
    int lower, upper, down, up;
} reached;

/* Take the voltages as amplifiers do, which checks them: no tolerance. */
static void take(rig *r, const bool *is_held, reached *ends)
{
    for (int k = 0; k < N; k++) {
        const pzs_real voltage = r->loop.info.voltage[k], most = r->problem.step_limit[k];
        const pzs_real change =
            voltage > r->given[k] ? voltage - r->given[k] : r->given[k] - voltage;
        assert_true(isfinite(voltage) && voltage >= r->problem.lower[k] &&
                    voltage <= r->problem.upper[k]);
        assert_true((is_held && is_held[k]) || change <= most);
        if (ends) {
            const bool is_whole =
                (double)change >=
                (double)most - 4 * (double)PZS_EPSILON * range_of(r->voltage + k * POINTS);
            ends->lower += voltage <= r->problem.lower[k];
            ends->upper += voltage >= r->problem.upper[k];
            ends->down += is_whole && voltage < r->given[k];
            ends->up += is_whole && voltage > r->given[k];
        }
        r->given[k] = voltage;
    }
}

/*
 * Law: in ticks of targets that jump far beyond the limits, on a plant of another gain, with inputs
 * held and released, readings lost and restarts, no voltage leaves its limits or its step limit by
 * one bit, the last gate never has to correct one, and both ends of both limits are reached.
 */
static void test_inside_limits(void **state)
{
    reached ends = {0, 0, 0, 0};
    (void)state;
    for (unsigned trial = 0; trial < 10; trial++) {
        static rig r;
        bool is_held[N] = {false};
        open_rig(&r, 300 + trial);
        list_blocks(&r, trial % 2 != 0);
        assert_int_equal(init(&r), PZS_OK);
        for (int tick = 0; tick < 10000 / SHARE; tick++) {
            if (tick % 17 == 0)
                throw_target(&r, 3);
            const uint16_t k = (uint16_t)draw(&r, 0, N);
            if (tick % 101 == 50) {
                is_held[k] = true;
                (void)pzs_hold(r.loop.info.control, k, (pzs_real)draw(&r, -300, 300));
            } else if (tick % 101 == 80) {
                (void)pzs_release(r.loop.info.control, k);
            }
            measure(&r, 0.8);
            r.measured[3] = tick % 11 == 0 ? (pzs_real)NAN : r.measured[3];
            r.wanted[0] = tick % 501 == 500 ? (pzs_real)NAN : r.wanted[0];
            const pzs_status status =
                pzs_loop_tick(&r.loop, r.wanted, tick % 13 == 0 ? NULL : r.measured);
            if (PZS_IS_ERROR(status) || status == PZS_W_OUTPUT)
                fail_msg("trial %u tick %d: %s", trial, tick, pzs_status_text(status));
            take(&r, is_held, trial % 2 ? NULL : &ends);
            if (tick % 997 == 996) {
                memset(is_held, 0, sizeof is_held);
                assert_int_equal(pzs_loop_start(&r.loop, r.given), PZS_OK);
            }
        }
        free(r.work);
    }
    assert_true(ends.lower > 0 && ends.upper > 0 && ends.down > 0 && ends.up > 0);
}

/* |shape - wanted|^2 for effects. */
static double objective(const rig *r, const pzs_real *effect)
{
    double sum = 0;
    for (int i = 0; i < M; i++) {
        double misfit = -(double)r->wanted[i];
        for (int k = 0; k < N; k++)
            misfit += (double)(r->problem.influence[i * N + k] * effect[k]);
        sum += misfit * misfit;
    }
    return sum;
}

/*
 * Law: without step limits, one tick gives the bounded optimum of the effects: a controller whose
 * limits are the effects at both voltage limits finds no better one.
 */
static void test_optimum(void **state)
{
    static double work[PZS_CONTROL_BYTES(N, M) / sizeof(double) + 8];
    (void)state;
    for (unsigned seed = 40; seed < 80; seed++) {
        static rig r;
        pzs_real low[N], high[N], effect[N];
        double scale = 0;
        pzs_control best;
        open_rig(&r, seed);
        fill_reals(r.problem.step_limit, N, HUGE_VAL);
        problem_seal(&r.problem);
        assert_int_equal(init(&r), PZS_OK);
        throw_target(&r, 1.5);
        pzs_problem problem = r.problem.tables;
        for (int k = 0; k < N; k++) {
            low[k] = r.effect[k * POINTS];
            high[k] = r.effect[k * POINTS + POINTS - 1];
        }
        problem.lower = low;
        problem.upper = high;
        assert_int_equal(pzs_problem_seal(&problem), PZS_OK);
        assert_int_equal(pzs_control_init(&best, &problem, NULL, work, sizeof work), PZS_OK);
        assert_int_equal(pzs_step(&best, r.wanted), PZS_OK);
        assert_int_equal(pzs_loop_tick(&r.loop, r.wanted, NULL), PZS_OK);
        take(&r, NULL, NULL);
        for (int k = 0; k < N; k++)
            effect[k] = effect_of(&r, k, r.given[k]);
        for (int i = 0; i < M; i++)
            scale += (double)(r.wanted[i] * r.wanted[i]);
        assert_true(fabs(objective(&r, effect) - objective(&r, best.info.voltage)) <=
                    PZS_BY_BITS(1e-4, 1e-11) * scale);
        free(r.work);
    }
}

/*
 * Law: with readings of actuators that follow their curves, the loop reaches a target inside its
 * limits, and stays there.
 */
static void test_target_reached(void **state)
{
    (void)state;
    for (unsigned seed = 80; seed < 100; seed++) {
        static rig r;
        open_rig(&r, seed);
        assert_int_equal(init(&r), PZS_OK);
        throw_target(&r, 0.9);
        for (int tick = 0; tick < 200; tick++) {
            measure(&r, 1);
            assert_int_equal(pzs_loop_tick(&r.loop, r.wanted, r.measured), PZS_OK);
            take(&r, NULL, NULL);
        }
        double sum = 0, size = 0;
        measure(&r, 1);
        for (int i = 0; i < M; i++) {
            sum += pow((double)(r.measured[i] - r.wanted[i]), 2);
            size += pow((double)r.wanted[i], 2);
        }
        assert_true(sqrt(sum / size) <= PZS_BY_BITS(1e-4, 1e-6));
        free(r.work);
    }
}

/*
 * Law: without a target the loop keeps its effects, and so its voltages up to the rounding of the
 * inverse, also where the program has set the voltages or the amplifiers have changed them. The
 * smallest slope of an unbent curve is 0.001 per volt.
 */
static void test_kept(void **state)
{
    (void)state;
    for (unsigned seed = 120; seed < 160; seed++) {
        static rig r;
        open_rig(&r, seed);
        r.curves.bend = NULL;
        assert_int_equal(pzs_actuator_curves_seal(&r.curves), PZS_OK);
        list_blocks(&r, seed % 2 != 0);
        r.amplifier.dead_band = 0;
        assert_int_equal(init(&r), PZS_OK);
        for (int tick = 0; tick < 20; tick++) {
            for (int k = 0; k < N && tick % 4 == 0; k++)
                r.given[k] = (pzs_real)draw(&r, (double)r.problem.lower[k] * 0.999,
                                            (double)r.problem.upper[k] * 0.999);
            if (tick % 4 == 0)
                assert_int_equal(pzs_loop_start(&r.loop, r.given), PZS_OK);
            throw_target(&r, 0.9);
            if (tick % 2 == 1)
                assert_int_equal(pzs_loop_tick(&r.loop, r.wanted, NULL), PZS_OK);
            take(&r, NULL, NULL);
            r.wanted[2] = (pzs_real)NAN;
            assert_int_equal(pzs_loop_tick(&r.loop, r.wanted, NULL), PZS_W_HELD);
            for (int k = 0; k < N; k++) {
                const double exact = 512 * (double)PZS_EPSILON *
                                         (range_of(r.voltage + k * POINTS) +
                                          range_of(r.effect + k * POINTS) / 0.001) +
                                     (seed % 2 ? (double)r.amplifier.step : 0);
                assert_true(fabs((double)(r.loop.info.voltage[k] - r.given[k])) <= exact);
            }
            take(&r, NULL, NULL);
        }
        free(r.work);
    }
}

/* ---- other blocks --------------------------------------------------------- */

/* Supervisor tables that never alarm, with parking voltages at the lower limits. */
static void seal_supervision(rig *r, pzs_supervision *supervision)
{
    *supervision = (pzs_supervision){.scene = SCENE,
                                     .inputs = N,
                                     .timeout = 0,
                                     .ramp_ticks = 8,
                                     .alarm_ticks = 60000,
                                     .polarity_ticks = 60000,
                                     .park = r->problem.lower,
                                     .fading = PZS_R(0.9),
                                     .noise = 1,
                                     .load = 1};
    assert_int_equal(pzs_supervision_seal(supervision), PZS_OK);
}

/*
 * Rounding error of a shape: shapes are about 1e-5 m, and the terms of their sums have the size of
 * the largest effect of a curve over its range.
 */
static double shape_rounding(const rig *r)
{
    double size = 0;
    for (int k = 0; k < N; k++) {
        const pzs_real *effect = r->effect + k * POINTS;
        size = fmax(size, range_of(effect) / (double)(effect[POINTS - 1] - effect[0]));
    }
    return 1e-5 * N * size * 256 * (double)PZS_EPSILON;
}

/* The displacement of an output under the effects of given voltages (m). */
static double displaced(const rig *r, const pzs_real *voltage, int output)
{
    double shape = 0;
    for (int k = 0; k < N; k++)
        shape += (double)r->problem.influence[output * N + k] * (double)effect_of(r, k, voltage[k]);
    return shape;
}

/*
 * Law: the shape that the supervisor compares with the readings is the influence matrix times the
 * effects of the voltages that the amplifiers give, also where their converters round the voltages
 * and while the supervisor ramps them.
 */
static void test_predicted(void **state)
{
    (void)state;
    for (unsigned seed = 200; seed < 220; seed++) {
        static rig r;
        pzs_supervision supervision;
        open_rig(&r, seed);
        seal_supervision(&r, &supervision);
        list_blocks(&r, true);
        append(&r, &pzs_supervisor_block, &supervision);
        assert_int_equal(init(&r), PZS_OK);
        pzs_supervisor *supervisor = pzs_loop_find(&r.loop, &pzs_supervisor_block);
        for (int tick = 0; tick < 100; tick++) {
            if (tick % 10 == 0)
                throw_target(&r, 0.9);
            if (tick == 50)
                assert_int_equal(pzs_supervisor_give(supervisor, PZS_COMMAND_PARK), PZS_OK);
            measure(&r, 1);
            assert_false(PZS_IS_ERROR(pzs_loop_tick(&r.loop, r.wanted, r.measured)));
            const pzs_real *predicted = r.loop.info.control->info.predicted;
            for (int i = 0; i < M; i++)
                assert_true(fabs(displaced(&r, r.loop.info.voltage, i) - (double)predicted[i]) <=
                            shape_rounding(&r));
            take(&r, NULL, NULL);
        }
        assert_memory_equal(r.loop.info.voltage, r.problem.lower, N * sizeof(pzs_real));
        free(r.work);
    }
}

/*
 * Law: where readings are late by some ticks, and the loop corrects them for the changes of the
 * effects since then, the shape is that of a loop with punctual readings, on a plant that equals
 * the tables. Both differ by the noise of the readings, 1e-12 m, and by rounding, once a tick.
 */
static void test_late(void **state)
{
    enum { DELAY = 3, TICKS = 40 };
    (void)state;
    for (unsigned seed = 230; seed < 245; seed++) {
        static rig r, late;
        static pzs_real history[TICKS + DELAY][M];
        pzs_reading_delay delay = {.scene = SCENE, .inputs = N, .sensors = M, .delay = DELAY};
        assert_int_equal(pzs_reading_delay_seal(&delay), PZS_OK);
        open_rig(&r, seed);
        open_rig(&late, seed);
        late.count = 0;
        append(&late, &pzs_curve_block, &late.curves);
        append(&late, &pzs_reading_delay_block, &delay);
        append(&late, &pzs_step_block, &late.problem.tables);
        append(&late, &pzs_curve_inverse_block, &late.curves);
        assert_int_equal(init(&r), PZS_OK);
        assert_int_equal(init(&late), PZS_OK);
        for (int i = 0; i < DELAY; i++) {
            measure(&late, 1);
            memcpy(history[i], late.measured, sizeof late.measured);
        }
        const double more = TICKS * (2e-12 * sqrt(M) + shape_rounding(&r));
        for (int tick = 0; tick < TICKS; tick++) {
            if (tick % 8 == 0)
                throw_target(&r, 0.9);
            measure(&r, 1);
            measure(&late, 1);
            memcpy(history[tick + DELAY], late.measured, sizeof late.measured);
            assert_false(PZS_IS_ERROR(pzs_loop_tick(&r.loop, r.wanted, r.measured)));
            assert_false(PZS_IS_ERROR(pzs_loop_tick(&late.loop, r.wanted, history[tick])));
            take(&r, NULL, NULL);
            take(&late, NULL, NULL);
            for (int i = 0; i < M; i++)
                assert_true(fabs(displaced(&r, r.given, i) - displaced(&late, late.given, i)) <=
                            more);
        }
        free(r.work);
        free(late.work);
    }
}

/* Distance of the shape under the given voltages from the target, over the size of the target. */
static double misfit_of(const rig *r)
{
    double missed = 0, size = 0;
    for (int i = 0; i < M; i++) {
        missed += pow(displaced(r, r->given, i) - (double)r->wanted[i], 2);
        size += pow((double)r->wanted[i], 2);
    }
    return sqrt(missed / size);
}

/*
 * Run some ticks with readings. Where bytes > 0, a bit of so many bytes of the workspace flips
 * before every tenth tick.
 */
static void run_ticks(rig *r, int ticks, size_t bytes)
{
    for (int tick = 0; tick < ticks; tick++) {
        if (bytes > 0 && tick % 10 == 0)
            ((uint8_t *)r->work)[(size_t)draw(r, 0, (double)bytes - 1e-6)] ^=
                (uint8_t)(1u << (int)draw(r, 0, 7.999));
        measure(r, 1);
        assert_false(PZS_IS_ERROR(pzs_loop_tick(&r->loop, r->wanted, r->measured)));
        take(r, NULL, NULL);
    }
}

/*
 * Law: whatever bit of the workspace flips between two ticks, no voltage leaves its limits, its
 * step limit or the finite numbers. 400 ticks after the last flip the loop is as near to its target
 * as before.
 */
static void test_flipped_bits(void **state)
{
    static rig r;
    (void)state;
    open_rig(&r, 250);
    assert_int_equal(init(&r), PZS_OK);
    const size_t bytes = PZS_LOOP_BYTES(3, N) + PZS_STEP_BLOCK_BYTES(N, M) +
                         PZS_CURVE_BLOCK_BYTES(N) + PZS_CURVE_INVERSE_BLOCK_BYTES(N);
    for (int turn = 0; turn < 100 / SHARE; turn++) {
        throw_target(&r, 0.9);
        run_ticks(&r, 400, 0);
        const double before = misfit_of(&r);
        run_ticks(&r, 200, bytes - 8);
        run_ticks(&r, 400, 0);
        if (!(fabs(misfit_of(&r) - before) < 1e-3))
            fail_msg("turn %d: misfit %g, %g before", turn, misfit_of(&r), before);
    }
    free(r.work);
}

/* ---- refused -------------------------------------------------------------- */

static pzs_status init_with(rig *r, pzs_real *entry, double value)
{
    const pzs_real kept = *entry;
    *entry = (pzs_real)value;
    assert_int_equal(pzs_actuator_curves_seal(&r->curves), PZS_OK);
    const pzs_status status = init(r);
    *entry = kept;
    assert_int_equal(pzs_actuator_curves_seal(&r->curves), PZS_OK);
    return status;
}

/* Curves that are not ascending, not finite, too short or damaged are refused. */
static void test_refused_curves(void **state)
{
    static rig r;
    static const double bad[] = {NAN, INFINITY, -INFINITY, -1e9, 1e9};
    (void)state;
    open_rig(&r, 91);
    assert_int_equal(init(&r), PZS_OK);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(init_with(&r, &r.voltage[2 * POINTS + 4], bad[i]), PZS_E_LIMITS);
        assert_int_equal(r.loop.info.where, 2);
        assert_int_equal(init_with(&r, &r.effect[3 * POINTS + 4], bad[i]), PZS_E_LIMITS);
        assert_int_equal(r.loop.info.where, 3);
        assert_int_equal(init_with(&r, &r.bend[POINTS - 1], bad[i]), PZS_E_LIMITS);
        assert_int_equal(r.loop.info.where, 1);
    }
    assert_int_equal(init_with(&r, &r.effect[4], (double)r.effect[3]), PZS_E_LIMITS);
    assert_int_equal(init_with(&r, &r.voltage[4], (double)r.voltage[3]), PZS_E_LIMITS);
    assert_int_equal(init_with(&r, &r.voltage[0], (double)r.voltage[0] + 1e-3), PZS_E_LIMITS);
    assert_int_equal(init_with(&r, &r.voltage[POINTS - 1], (double)r.voltage[POINTS - 1] - 1e-3),
                     PZS_E_LIMITS);
    assert_int_equal(init_with(&r, &r.bend[2], 1.001), PZS_E_LIMITS);
    assert_int_equal(init_with(&r, &r.bend[2], -1.001), PZS_E_LIMITS);
    assert_int_equal(init_with(&r, &r.bend[2], -1), PZS_OK);
    r.effect[3] += PZS_R(0.001);
    assert_int_equal(init(&r), PZS_E_CRC);
    r.effect[3] -= PZS_R(0.001);
    free(r.work);
}

/* Tables of wrong sizes, or beside limits or blocks for which effects have no meaning, are refused.
 */
static void test_refused_lists(void **state)
{
    static rig r;
    const pzs_fault_detection detection = {0, 0};
    (void)state;
    open_rig(&r, 92);
    r.curves.points = 1;
    assert_int_equal(pzs_actuator_curves_seal(&r.curves), PZS_E_ARGUMENT);
    r.curves.points = PZS_CURVE_POINTS + 1;
    assert_int_equal(pzs_actuator_curves_seal(&r.curves), PZS_E_ARGUMENT);
    r.curves.points = POINTS;
    r.curves.sets = 2;
    assert_int_equal(pzs_actuator_curves_seal(&r.curves), PZS_E_ARGUMENT);
    r.curves.sets = N;
    r.curves.scene++;
    assert_int_equal(pzs_actuator_curves_seal(&r.curves), PZS_OK);
    assert_int_equal(init(&r), PZS_E_FORMAT);
    r.curves.scene--;
    assert_int_equal(pzs_actuator_curves_seal(&r.curves), PZS_OK);
    assert_int_equal(pzs_actuator_curves_seal(NULL), PZS_E_ARGUMENT);
    r.count = 2; /* without the inverse */
    assert_int_equal(init(&r), PZS_E_STAGE);
    list_blocks(&r, false);
    append(&r, &pzs_fault_detector_block, &detection);
    assert_int_equal(init(&r), PZS_E_STAGE);
    assert_ptr_equal(r.loop.info.block, &pzs_fault_detector_block);
    r.count = 0;
    append(&r, &pzs_step_block, &r.problem.tables);
    append(&r, &pzs_curve_inverse_block, &r.curves);
    assert_int_equal(init(&r), PZS_OK);
    assert_int_equal(pzs_loop_tick(&r.loop, r.wanted, r.measured), PZS_E_STAGE);
    list_blocks(&r, false);
    r.problem.tables.regularisation = PZS_R(1e-20);
    problem_seal(&r.problem);
    assert_int_equal(init(&r), PZS_E_ARGUMENT);
    free(r.work);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_textbook),       cmocka_unit_test(test_inverse),
        cmocka_unit_test(test_square),         cmocka_unit_test(test_inside_limits),
        cmocka_unit_test(test_optimum),        cmocka_unit_test(test_target_reached),
        cmocka_unit_test(test_kept),           cmocka_unit_test(test_predicted),
        cmocka_unit_test(test_late),           cmocka_unit_test(test_flipped_bits),
        cmocka_unit_test(test_refused_curves), cmocka_unit_test(test_refused_lists)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
