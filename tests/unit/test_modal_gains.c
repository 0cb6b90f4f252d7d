/*
 * Gains and leaks of modes: the tick is a leaky integrator for each mode, ends at the optimum that
 * its gains weigh, amplifies noise as theory says, and winds up at no limit. With a file name the
 * random loops are written to it, for the same laws in numpy (tests/oracle/modal_gains.py).
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { N = 7, M = 20, LOOPS = 60, TICKS = 12, REST = 3000 };
enum { MOST_INPUTS = N, MOST_OUTPUTS = M };

#include "../rigs/problem_rig.h"

static const double infinite = HUGE_VAL;
static FILE *dump;

/* A static plant that is the model, with a disturbance, and its loop with gains of modes. */
typedef struct rig {
    problem_rig problem;
    pzs_modal_gains gains;
    pzs_real pattern[N * N], effect[N * N], gain[N], leak[N];
    double hessian[N][N]; /* with regularisation */
    double disturbance[M];
    pzs_real wanted[M];
    pzs_block block[2];
    pzs_loop loop;
    void *work;
    unsigned seed;
} rig;

/* ---- tables --------------------------------------------------------------- */

static void make_hessian(rig *r)
{
    const problem_rig *p = &r->problem;
    for (int j = 0; j < N; j++)
        for (int k = 0; k < N; k++) {
            r->hessian[j][k] = j == k ? (double)p->tables.regularisation : 0;
            for (int i = 0; i < M; i++)
                r->hessian[j][k] += (double)p->weight[i] * (double)p->weight[i] *
                                    (double)p->influence[i * N + j] *
                                    (double)p->influence[i * N + k];
        }
}

/* Random modes, orthonormal in the Hessian. */
static void make_modes(rig *r, int modes)
{
    double p[N][N], e[N][N];
    for (int mode = 0; mode < modes; mode++) {
        for (int k = 0; k < N; k++)
            p[mode][k] = uniform(&r->seed, -1, 1);
        for (int again = 0; again < 2; again++)
            for (int other = 0; other < mode; other++) {
                double part = 0;
                for (int k = 0; k < N; k++)
                    part += e[other][k] * p[mode][k];
                for (int k = 0; k < N; k++)
                    p[mode][k] -= part * p[other][k];
            }
        double square = 0;
        for (int j = 0; j < N; j++) {
            e[mode][j] = 0;
            for (int k = 0; k < N; k++)
                e[mode][j] += r->hessian[j][k] * p[mode][k];
            square += e[mode][j] * p[mode][j];
        }
        for (int k = 0; k < N; k++) {
            p[mode][k] /= sqrt(square);
            e[mode][k] /= sqrt(square);
            r->pattern[mode * N + k] = (pzs_real)p[mode][k];
            r->effect[mode * N + k] = (pzs_real)e[mode][k];
        }
    }
}

/*
 * Tables of a random problem with `modes` random modes of gain 1 and leak 0. Influence coefficients
 * are about 1e-6 m/V, largest at output k for input k, so that the problem is well conditioned.
 */
static void make_tables(rig *r, unsigned seed, int modes, double limit, double regularisation)
{
    memset(r, 0, sizeof *r);
    r->seed = seed;
    problem_open(&r->problem, N, M, -limit, limit, infinite);
    fill_random(&r->seed, r->problem.influence, M * N, 2e-7);
    for (int k = 0; k < N; k++)
        r->problem.influence[k * N + k] += PZS_R(1e-6);
    for (int i = 0; i < M; i++)
        r->problem.weight[i] = (pzs_real)uniform(&r->seed, 0.5, 2);
    r->problem.tables.regularisation = (pzs_real)regularisation;
    problem_seal(&r->problem);
    make_hessian(r);
    make_modes(r, modes);
    fill_reals(r->gain, N, 1);
    r->gains = (pzs_modal_gains){.scene = SCENE,
                                 .inputs = N,
                                 .modes = (uint16_t)modes,
                                 .pattern = modes > 0 ? r->pattern : NULL,
                                 .effect = modes > 0 ? r->effect : NULL,
                                 .gain = modes > 0 ? r->gain : NULL,
                                 .leak = modes > 0 ? r->leak : NULL,
                                 .other_gain = 1};
    for (int i = 0; i < M; i++) {
        r->disturbance[i] = uniform(&r->seed, -1e-5, 1e-5);
        r->wanted[i] = (pzs_real)uniform(&r->seed, -5e-5, 5e-5);
    }
}

static void set_gains(rig *r, double gain, double leak)
{
    fill_reals(r->gain, N, gain);
    fill_reals(r->leak, N, leak);
    r->gains.other_gain = (pzs_real)gain;
    r->gains.other_leak = (pzs_real)leak;
}

static void random_gains(rig *r)
{
    for (int k = 0; k < N; k++) {
        r->gain[k] = (pzs_real)uniform(&r->seed, 0.05, 1.2);
        r->leak[k] = (pzs_real)uniform(&r->seed, 0, 0.7);
    }
    r->gains.other_gain = (pzs_real)uniform(&r->seed, 0.05, 1.2);
    r->gains.other_leak = (pzs_real)uniform(&r->seed, 0, 0.5);
}

static pzs_status start(rig *r)
{
    assert_int_equal(pzs_modal_gains_seal(&r->gains), PZS_OK);
    problem_seal(&r->problem);
    r->block[0] = (pzs_block){&pzs_modal_gains_block, &r->gains};
    r->block[1] = (pzs_block){&pzs_step_block, &r->problem.tables};
    return start_loop(&r->loop, r->block, 2, &r->work);
}

static void close_rig(rig *r)
{
    free(r->work);
}

/* ---- plant and ticks --------------------------------------------------------- */

/* Measured shape of the plant under the present voltages, with uniform noise. out [M] */
static void measure(rig *r, double noise, pzs_real *out)
{
    for (int i = 0; i < M; i++) {
        double sum = r->disturbance[i] + uniform(&r->seed, -noise, noise);
        for (int k = 0; k < N; k++)
            sum += (double)r->problem.influence[i * N + k] * (double)r->loop.info.voltage[k];
        out[i] = (pzs_real)sum;
    }
}

static pzs_status tick(rig *r)
{
    pzs_real measured[M];
    measure(r, 0, measured);
    return pzs_loop_tick(&r->loop, r->wanted, measured);
}

/* Solve H x = x in place, by elimination without pivots (H is positive definite). */
static void solve(const rig *r, double *x)
{
    double a[N][N];
    memcpy(a, r->hessian, sizeof a);
    for (int j = 0; j < N; j++)
        for (int i = j + 1; i < N; i++) {
            const double factor = a[i][j] / a[j][j];
            for (int k = j; k < N; k++)
                a[i][k] -= factor * a[j][k];
            x[i] -= factor * x[j];
        }
    for (int i = N; i-- > 0;) {
        for (int k = i + 1; k < N; k++)
            x[i] -= a[i][k] * x[k];
        x[i] /= a[i][i];
    }
}

static double deviation(const rig *r, int k)
{
    return (double)r->loop.info.voltage[k] - (double)r->problem.reference_voltage[k];
}

/* Change of the voltages in a tick without gains and limits (V). change [N] out */
static void full_step(const rig *r, const pzs_real *measured, double *change)
{
    for (int k = 0; k < N; k++) {
        change[k] = -(double)r->problem.tables.regularisation * deviation(r, k);
        for (int i = 0; i < M; i++)
            change[k] += (double)r->problem.influence[i * N + k] * (double)r->problem.weight[i] *
                         (double)r->problem.weight[i] *
                         ((double)r->wanted[i] - (double)measured[i]);
    }
    solve(r, change);
}

/* Coordinate of a mode in a vector of voltages. */
static double coordinate(const rig *r, int mode, const double *voltage)
{
    double sum = 0;
    for (int j = 0; j < N; j++)
        for (int k = 0; k < N; k++)
            sum += (double)r->pattern[mode * N + j] * r->hessian[j][k] * voltage[k];
    return sum;
}

/* Voltages after a tick without limits, by the law of the leaky integrator. out [N] */
static void integrate(const rig *r, const pzs_real *measured, double *out)
{
    double change[N], from[N];
    full_step(r, measured, change);
    for (int k = 0; k < N; k++) {
        from[k] = deviation(r, k);
        out[k] = (double)r->loop.info.voltage[k] + (double)r->gains.other_gain * change[k] -
                 (double)r->gains.other_leak * from[k];
    }
    for (int mode = 0; mode < r->gains.modes; mode++) {
        const double step =
            ((double)r->gain[mode] - (double)r->gains.other_gain) * coordinate(r, mode, change) -
            ((double)r->leak[mode] - (double)r->gains.other_leak) * coordinate(r, mode, from);
        for (int k = 0; k < N; k++)
            out[k] += step * (double)r->pattern[mode * N + k];
    }
}

/* ---- dump for numpy --------------------------------------------------------- */

static void put(double x)
{
    if (dump)
        assert_int_equal(fwrite(&x, sizeof x, 1, dump), 1);
}

static void put_all(const pzs_real *x, size_t count)
{
    for (size_t i = 0; i < count; i++)
        put((double)x[i]);
}

/* Tables of a loop, then a record for each tick. */
static void put_tables(const rig *r, int ticks, double limit)
{
    const double head[] = {N,
                           M,
                           r->gains.modes,
                           ticks,
                           (double)PZS_EPSILON,
                           (double)r->problem.tables.regularisation,
                           (double)r->gains.other_gain,
                           (double)r->gains.other_leak,
                           limit};
    for (size_t i = 0; i < sizeof head / sizeof *head; i++)
        put(head[i]);
    put_all(r->problem.influence, M * N);
    put_all(r->problem.weight, M);
    put_all(r->problem.reference_voltage, N);
    put_all(r->problem.step_limit, N);
    put_all(r->pattern, (size_t)r->gains.modes * N);
    put_all(r->gain, r->gains.modes);
    put_all(r->leak, r->gains.modes);
    put_all(r->wanted, M);
}

/* ---- laws ------------------------------------------------------------------ */

/*
 * Without limits every tick is the leaky integrator of each mode, to rounding: of the voltages, of
 * the modes and of the gradient.
 */
static void ticks_are_leaky_integrators(void **state)
{
    rig *r = calloc(1, sizeof *r);
    const double unit = 64 * N * M * (double)PZS_EPSILON;
    (void)state;
    for (unsigned loop = 0; loop < LOOPS; loop++) {
        make_tables(r, 11 + loop, (int)(loop % (N + 1)), infinite, loop % 3 == 0 ? 1e-13 : 0);
        fill_random(&r->seed, r->problem.reference_voltage, N, 20);
        random_gains(r);
        assert_int_equal(start(r), PZS_OK);
        for (int t = 0; t < TICKS; t++) {
            pzs_real measured[M];
            double next[N], size = 0;
            measure(r, 1e-6, measured);
            integrate(r, measured, next);
            assert_int_equal(pzs_loop_tick(&r->loop, r->wanted, measured), PZS_OK);
            for (int k = 0; k < N; k++)
                size = fmax(size, fabs(next[k]));
            for (int k = 0; k < N; k++)
                assert_true(fabs((double)r->loop.info.voltage[k] - next[k]) <= unit * (size + 50));
        }
        close_rig(r);
    }
    free(r);
}

/* Random loops with voltage limits and step limits, for numpy: each tick, and the state of rest. */
static void random_loops(void **state)
{
    rig *r = calloc(1, sizeof *r);
    (void)state;
    for (unsigned loop = 0; loop < LOOPS; loop++) {
        const double limit = loop % 4 == 3 ? infinite : 40;
        const bool rests = loop % 2 == 0;
        make_tables(r, 500 + loop, (int)(loop % (N + 1)), limit, loop % 3 == 0 ? 1e-13 : 0);
        fill_random(&r->seed, r->problem.reference_voltage, N, 20);
        random_gains(r);
        if (loop % 4 == 1)
            fill_reals(r->problem.step_limit, N, 15);
        assert_int_equal(start(r), PZS_OK);
        put_tables(r, rests ? -1 : TICKS, limit);
        for (int t = 0; t < (rests ? REST : TICKS); t++) {
            pzs_real measured[M];
            measure(r, rests ? 0 : 1e-6, measured);
            if (!rests)
                put_all(r->loop.info.voltage, N);
            if (!rests || t == REST - 1)
                put_all(measured, M);
            assert_int_equal(pzs_loop_tick(&r->loop, r->wanted, measured), PZS_OK);
            if (!rests || t == REST - 1)
                put_all(r->loop.info.voltage, N);
            for (int k = 0; k < N; k++)
                assert_true(fabs((double)r->loop.info.voltage[k]) <= limit);
        }
        close_rig(r);
    }
    free(r);
}

/*
 * Gain 1 and leak 0 are the tick without the block. Equal gains end at its optimum, with voltages
 * at their limits and with an input that is held.
 */
static void equal_gains_end_at_the_optimum(void **state)
{
    static const double gain[] = {1, 0.3, 1.5};
    rig *r = calloc(1, sizeof *r), *plain = calloc(1, sizeof *plain);
    (void)state;
    for (int i = 0; i < 6; i++) {
        make_tables(r, 90, i % 2 ? 3 : 0, 30, 1e-13);
        make_tables(plain, 90, 0, 30, 1e-13);
        memcpy(plain->wanted, r->wanted, sizeof plain->wanted);
        memcpy(plain->disturbance, r->disturbance, sizeof plain->disturbance);
        set_gains(r, gain[i / 2], 0);
        assert_int_equal(start(r), PZS_OK);
        plain->block[0] = (pzs_block){&pzs_step_block, &plain->problem.tables};
        assert_int_equal(start_loop(&plain->loop, plain->block, 1, &plain->work), PZS_OK);
        assert_int_equal(pzs_hold(r->loop.info.control, 4, 7), PZS_OK);
        assert_int_equal(pzs_hold(plain->loop.info.control, 4, 7), PZS_OK);
        for (int t = 0; t < 400; t++) {
            assert_int_equal(tick(r), PZS_OK);
            assert_int_equal(tick(plain), PZS_OK);
        }
        int at_limit = 0;
        for (int k = 0; k < N; k++) {
            const double best = (double)plain->loop.info.voltage[k];
            at_limit += fabs(best) >= 30;
            assert_true(fabs((double)r->loop.info.voltage[k] - best) <=
                        400 * N * M * (double)PZS_EPSILON * 30);
        }
        assert_true(at_limit > 0);
        close_rig(r);
        close_rig(plain);
    }
    free(r);
    free(plain);
}

/*
 * Leak 1 with gain 0 brings a mode to the reference voltages in one tick; gain 0 with leak 0 leaves
 * it where it is, to the rounding of many ticks.
 */
static void leak_forgets_and_gain_0_stays(void **state)
{
    rig *r = calloc(1, sizeof *r);
    (void)state;
    for (int leak = 0; leak <= 1; leak++) {
        make_tables(r, 17, N, infinite, 0);
        set_gains(r, 0.5, 0);
        r->gain[2] = 0;
        r->leak[2] = (pzs_real)leak;
        assert_int_equal(start(r), PZS_OK);
        pzs_real first[N];
        for (int k = 0; k < N; k++)
            first[k] = 50 * r->pattern[2 * N + k] / r->pattern[2 * N];
        assert_int_equal(pzs_loop_start(&r->loop, first), PZS_OK);
        double from[N], now[N];
        for (int k = 0; k < N; k++)
            from[k] = (double)first[k];
        const double before = coordinate(r, 2, from), size = fabs(before) + 1e-4;
        const int ticks = leak ? 1 : 1000;
        for (int t = 0; t < ticks; t++)
            assert_int_equal(tick(r), PZS_OK);
        for (int k = 0; k < N; k++)
            now[k] = (double)r->loop.info.voltage[k];
        const double wanted = leak ? 0 : before;
        assert_true(fabs(coordinate(r, 2, now) - wanted) <=
                    ticks * N * M * (double)PZS_EPSILON * size);
        close_rig(r);
    }
    free(r);
}

/*
 * White noise of the measured shape in a mode gives its coordinate the variance
 * g^2 s2 / ((g + l) (2 - g - l)), g / (2 - g) s2 without leak. The variance of so many correlated
 * samples is known to about sqrt(2 (2 - g - l) / ((g + l) samples)) of itself; 5 times that is
 * allowed.
 */
static void noise_is_amplified_as_theory_says(void **state)
{
    static const double gain[] = {0.1, 0.5, 1, 1.4, 0.2}, leak[] = {0, 0, 0, 0, 0.1};
    enum { SAMPLES = 20000, SETTLE = 200 };
    const double noise = 1e-5;
    rig *r = calloc(1, sizeof *r);
    (void)state;
    for (int i = 0; i < 5; i++) {
        make_tables(r, 33, N, infinite, 0);
        fill_reals(r->problem.weight, M, 1);
        problem_seal(&r->problem);
        make_hessian(r);
        make_modes(r, N);
        set_gains(r, gain[i], leak[i]);
        fill_reals(r->wanted, M, 0);
        memset(r->disturbance, 0, sizeof r->disturbance);
        assert_int_equal(start(r), PZS_OK);
        double squares = 0;
        for (int t = 0; t < SETTLE + SAMPLES; t++) {
            pzs_real measured[M];
            double now[N];
            measure(r, noise, measured);
            assert_int_equal(pzs_loop_tick(&r->loop, r->wanted, measured), PZS_OK);
            for (int k = 0; k < N; k++)
                now[k] = (double)r->loop.info.voltage[k];
            for (int mode = 0; mode < N && t >= SETTLE; mode++)
                squares += pow(coordinate(r, mode, now), 2) / (N * (double)SAMPLES);
        }
        const double sum = gain[i] + leak[i];
        const double theory = gain[i] * gain[i] / (sum * (2 - sum)) * noise * noise / 3;
        const double spread = sqrt(2 * (2 - sum) / (sum * SAMPLES * N));
        assert_true(fabs(squares / theory - 1) <= 5 * spread + 5 * sqrt(2.0 / SAMPLES / N));
        close_rig(r);
    }
    free(r);
}

/*
 * The memory of the integrator is the voltages: after 3 and after 3000 ticks against the limits the
 * loop comes back with the same bits.
 */
static void nothing_winds_up(void **state)
{
    rig *r[2] = {calloc(1, sizeof *r[0]), calloc(1, sizeof *r[1])};
    (void)state;
    for (int i = 0; i < 2; i++) {
        make_tables(r[i], 71, 4, 20, 0);
        random_gains(r[i]);
        assert_int_equal(start(r[i]), PZS_OK);
        pzs_real far[M], at[N];
        for (int j = 0; j < M; j++)
            far[j] = 100 * r[i]->wanted[j];
        for (int t = 0; t < (i ? 3000 : 60); t++) {
            pzs_real measured[M];
            measure(r[i], 0, measured);
            assert_int_equal(pzs_loop_tick(&r[i]->loop, far, measured), PZS_OK);
        }
        for (int k = 0; k < N; k++)
            at[k] = r[0]->loop.info.voltage[k];
        if (i)
            assert_int_equal(pzs_loop_start(&r[1]->loop, at), PZS_OK);
        else
            assert_int_equal(pzs_loop_start(&r[0]->loop, at), PZS_OK);
    }
    for (int t = 0; t < 30; t++) {
        assert_int_equal(tick(r[0]), PZS_OK);
        assert_int_equal(tick(r[1]), PZS_OK);
        assert_memory_equal(r[0]->loop.info.voltage, r[1]->loop.info.voltage, N * sizeof(pzs_real));
    }
    for (int i = 0; i < 2; i++) {
        close_rig(r[i]);
        free(r[i]);
    }
}

/* Readings that are missing or not finite, alone and all together, and a target that is NaN. */
static void bad_readings_keep_voltages_finite(void **state)
{
    rig *r = calloc(1, sizeof *r);
    (void)state;
    make_tables(r, 3, 4, 30, 0);
    random_gains(r);
    assert_int_equal(start(r), PZS_OK);
    for (int t = 0; t < 200; t++) {
        pzs_real measured[M], wanted[M];
        measure(r, 1e-6, measured);
        memcpy(wanted, r->wanted, sizeof wanted);
        for (int i = 0; i < M; i++)
            if (t % 7 == 3 || uniform(&r->seed, 0, 1) < 0.1)
                measured[i] = t % 2 ? (pzs_real)NAN : (pzs_real)HUGE_VAL;
        if (t % 11 == 5)
            wanted[t % M] = (pzs_real)NAN;
        const pzs_status status = pzs_loop_tick(&r->loop, wanted, t % 13 == 4 ? NULL : measured);
        assert_false(PZS_IS_ERROR(status));
        assert_true(t % 11 != 5 || status == PZS_W_HELD);
        for (int k = 0; k < N; k++)
            assert_true(fabs((double)r->loop.info.voltage[k]) <= 30);
    }
    close_rig(r);
    free(r);
}

/* ---- wrong tables -------------------------------------------------------------- */

static void expect(rig *r, pzs_status status, int where)
{
    assert_int_equal(start(r), status);
    assert_ptr_equal(r->loop.info.block, &pzs_modal_gains_block);
    if (where >= 0)
        assert_int_equal(r->loop.info.where, where);
}

static void wrong_tables_are_refused(void **state)
{
    static const double gain[] = {-0.1, 2, 1.5, 0.5, 0.5, (double)NAN, 1, (double)INFINITY};
    static const double leak[] = {0, 0, 0.5, 1.01, -0.01, 0, (double)NAN, 0};
    rig *r = calloc(1, sizeof *r);
    (void)state;
    for (int i = 0; i < 8; i++) {
        make_tables(r, 8, 3, 30, 0);
        r->gain[1] = (pzs_real)gain[i];
        r->leak[1] = (pzs_real)leak[i];
        expect(r, PZS_E_ARGUMENT, 1);
        close_rig(r);
        make_tables(r, 8, 3, 30, 0);
        r->gains.other_gain = (pzs_real)gain[i];
        r->gains.other_leak = (pzs_real)leak[i];
        expect(r, PZS_E_ARGUMENT, 3);
        close_rig(r);
    }
    make_tables(r, 8, 3, 30, 0);
    r->gains.inputs = N - 1;
    expect(r, PZS_E_ARGUMENT, -1);
    close_rig(r);
    make_tables(r, 8, 3, 30, 0);
    r->gains.scene = SCENE + 1;
    expect(r, PZS_E_FORMAT, -1);
    close_rig(r);
    make_tables(r, 8, 3, 30, 0);
    r->pattern[N + 2] = (pzs_real)NAN;
    expect(r, PZS_E_NONFINITE, -1);
    close_rig(r);
    make_tables(r, 8, 3, 30, 0);
    assert_int_equal(start(r), PZS_OK);
    r->effect[5] += 1;
    assert_int_equal(start_loop(&r->loop, r->block, 2, &r->work), PZS_E_CRC);
    close_rig(r);
    make_tables(r, 8, 3, 30, 0);
    r->gains.leak = NULL;
    assert_int_equal(pzs_modal_gains_seal(&r->gains), PZS_E_ARGUMENT);
    assert_int_equal(pzs_modal_gains_seal(NULL), PZS_E_ARGUMENT);
    free(r);
}

/* A table that is damaged while the loop runs is found by the checksum of its arrays. */
static void damaged_tables_are_found(void **state)
{
    rig *r = calloc(1, sizeof *r);
    (void)state;
    make_tables(r, 8, 3, 30, 0);
    assert_int_equal(start(r), PZS_OK);
    pzs_status status = tick(r);
    r->gain[2] += PZS_R(0.25);
    for (int t = 0; t < 2000 && status != PZS_E_CRC; t++)
        status = tick(r);
    assert_int_equal(status, PZS_E_CRC);
    assert_ptr_equal(r->loop.info.block, &pzs_modal_gains_block);
    close_rig(r);
    free(r);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ticks_are_leaky_integrators),
        cmocka_unit_test(random_loops),
        cmocka_unit_test(equal_gains_end_at_the_optimum),
        cmocka_unit_test(leak_forgets_and_gain_0_stays),
        cmocka_unit_test(noise_is_amplified_as_theory_says),
        cmocka_unit_test(nothing_winds_up),
        cmocka_unit_test(bad_readings_keep_voltages_finite),
        cmocka_unit_test(wrong_tables_are_refused),
        cmocka_unit_test(damaged_tables_are_found),
    };
    cmocka_set_message_output(CM_OUTPUT_TAP);
    dump = argc > 1 ? fopen(argv[1], "wb") : NULL;
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    if (dump)
        (void)fclose(dump);
    return failed;
}
