/*
 * What stands beside the controller: the shape from a few sensors, known loads fed forward,
 * amplifiers with steps.
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
#include "../../lib/control/estimate.h"
#include "../../lib/core/guard.h"
#include "../../lib/control/control.h"

enum { N = 7, M = 30, K = 5, LOADS = 3 };
enum { MOST_INPUTS = N, MOST_OUTPUTS = M };

#include "../rigs/problem_rig.h"

#define EPS ((double)PZS_EPSILON)

/* A controller of seven amplifiers on thirty outputs; five sensors see what three loads do to the
 * outputs. */
typedef struct rig {
    problem_rig problem;
    pzs_control control;
    pzs_estimator tables;
    pzs_estimate estimate;
    pzs_feed_forward_table known;
    pzs_real wanted[M], measured[M], given[N];
    pzs_real direct[K * N], gain[M * K], per[M * LOADS], sensed[K];
    double real[M * N], by_load[M * LOADS], seen[K * LOADS];
    void *work, *estimate_work;
    unsigned seed;
} rig;

/* G [M][K] with G seen = by_load, exact for the loads: by_load (seen' seen)^-1 seen'. */
static void make_gain(rig *r)
{
    double a[LOADS][2 * LOADS] = {{0}};
    for (int i = 0; i < LOADS; i++) {
        a[i][LOADS + i] = 1;
        for (int j = 0; j < LOADS; j++)
            for (int k = 0; k < K; k++)
                a[i][j] += r->seen[k * LOADS + i] * r->seen[k * LOADS + j];
    }
    for (int p = 0; p < LOADS; p++)
        for (int i = 0; i < LOADS; i++) {
            const double factor = i == p ? 1 - 1 / a[p][p] : a[i][p] / a[p][p];
            for (int j = 0; j < 2 * LOADS; j++)
                a[i][j] -= factor * a[p][j];
        }
    for (int i = 0; i < M; i++)
        for (int k = 0; k < K; k++) {
            double sum = 0;
            for (int l = 0; l < LOADS; l++)
                for (int j = 0; j < LOADS; j++)
                    sum += r->by_load[i * LOADS + l] * a[l][LOADS + j] * r->seen[k * LOADS + j];
            r->gain[i * K + k] = (pzs_real)sum;
        }
}

static void start(rig *r)
{
    problem_seal(&r->problem);
    r->tables.crc = pzs_estimate_crc(&r->tables);
    r->known.crc = pzs_estimate_known_crc(&r->known);
    assert_int_equal(
        pzs_control_init(&r->control, &r->problem.tables, NULL, r->work, PZS_CONTROL_BYTES(N, M)),
        PZS_OK);
    assert_int_equal(pzs_estimate_init(&r->estimate, &r->control, &r->tables, r->estimate_work,
                                       PZS_ESTIMATE_BYTES(K)),
                     PZS_OK);
    assert_int_equal(pzs_feed_forward_check(&r->known), PZS_OK);
    memcpy(r->given, r->control.info.voltage, sizeof r->given);
}

static void rig_open(rig *r, unsigned seed)
{
    memset(r, 0, sizeof *r);
    r->seed = seed;
    problem_open(&r->problem, N, M, -100, 100, 15);
    fill_random(&r->seed, r->problem.influence, M * N, 1e-6);
    for (int i = 0; i < M * N; i++)
        r->real[i] = (double)r->problem.influence[i];
    fill_random(&r->seed, r->wanted, M, 1e-5);
    for (int i = 0; i < M * LOADS; i++) {
        r->by_load[i] = uniform(&r->seed, -1e-5, 1e-5);
        r->per[i] = (pzs_real)r->by_load[i];
    }
    fill_random(&r->seed, r->direct, K * N, 1);
    for (int i = 0; i < K * LOADS; i++)
        r->seen[i] = uniform(&r->seed, -10, 10);
    make_gain(r);
    const pzs_estimator e = {PZS_TABLE_FORMAT, SCENE, 0, N, M, K, r->direct, r->gain};
    const pzs_feed_forward_table known = {PZS_TABLE_FORMAT, SCENE, 0, LOADS, M, r->per};
    r->tables = e;
    r->known = known;
    r->work = malloc(PZS_CONTROL_BYTES(N, M));
    r->estimate_work = malloc(PZS_ESTIMATE_BYTES(K));
    assert_true(r->work && r->estimate_work);
    start(r);
}

static void rig_close(rig *r)
{
    free(r->work);
    free(r->estimate_work);
}

/* Shape and readings under the volts and loads. */
static void act(rig *r, const double *load)
{
    for (int i = 0; i < M; i++) {
        double sum = 0;
        for (int k = 0; k < N; k++)
            sum += r->real[i * N + k] * (double)r->control.info.voltage[k];
        for (int l = 0; l < LOADS; l++)
            sum += r->by_load[i * LOADS + l] * load[l];
        r->measured[i] = (pzs_real)sum;
    }
    for (int s = 0; s < K; s++) {
        double sum = 0;
        for (int k = 0; k < N; k++)
            sum += (double)r->direct[s * N + k] * (double)r->control.info.voltage[k];
        for (int l = 0; l < LOADS; l++)
            sum += r->seen[s * LOADS + l] * load[l];
        r->sensed[s] = (pzs_real)sum;
    }
}

/* ---- estimate --------------------------------------------------------- */

/* Loads that the gains were made for show in full, under any volts: the estimate is the shape, to
 * rounding. */
static void test_estimate_exact(void **state)
{
    rig r;
    (void)state;
    rig_open(&r, 3);
    for (int t = 0; t < 50; t++) {
        const double load[LOADS] = {uniform(&r.seed, -1, 1), uniform(&r.seed, -1, 1),
                                    uniform(&r.seed, -1, 1)};
        pzs_real shape[M];
        act(&r, load);
        assert_int_equal(pzs_estimate_tick(&r.estimate, r.sensed, shape), PZS_OK);
        for (int i = 0; i < M; i++) /* five sensors of up to 700, gains of about 1e-5/10 */
            assert_true(fabs((double)(shape[i] - r.measured[i])) < 1e3 * EPS * 1e-3);
        assert_int_equal(pzs_tick(&r.control, r.wanted, shape), PZS_OK);
    }
    rig_close(&r);
}

/* In closed loop through the sensors alone the unmeasured shape ends where the measured one would.
 */
static void test_estimate_in_loop(void **state)
{
    const double load[LOADS] = {1, -0.5, 0.25};
    double end[2] = {0};
    (void)state;
    for (int estimated = 0; estimated < 2; estimated++) {
        rig r;
        rig_open(&r, 5);
        for (int t = 0; t < 60; t++) {
            pzs_real shape[M];
            act(&r, load);
            assert_int_equal(pzs_estimate_tick(&r.estimate, r.sensed, shape), PZS_OK);
            assert_int_equal(pzs_tick(&r.control, r.wanted, estimated ? shape : r.measured),
                             PZS_OK);
        }
        act(&r, load);
        for (int i = 0; i < M; i++)
            end[estimated] += pow((double)(r.measured[i] - r.wanted[i]), 2);
        rig_close(&r);
    }
    assert_true(fabs(end[1] / end[0] - 1) < 1e5 * EPS);
}

/* A reading that is no number or frozen keeps its last difference; all gone, the model goes on
 * alone, and says so. */
static void test_estimate_lost(void **state)
{
    const double load[LOADS] = {1, 1, -1};
    pzs_real before[M], shape[M], stuck = 0;
    int told = 0;
    rig r;
    (void)state;
    rig_open(&r, 7);
    act(&r, load);
    assert_int_equal(pzs_estimate_tick(&r.estimate, r.sensed, before), PZS_OK);
    r.sensed[2] = (pzs_real)NAN;
    assert_int_equal(pzs_estimate_tick(&r.estimate, r.sensed, shape), PZS_W_SENSOR);
    assert_int_equal(r.estimate.info.where, 2);
    assert_memory_equal(shape, before, sizeof shape);
    for (int s = 0; s < K; s++)
        r.sensed[s] = s % 2 ? (pzs_real)NAN : (pzs_real)HUGE_VAL;
    assert_int_equal(pzs_estimate_tick(&r.estimate, r.sensed, shape), PZS_W_HELD);
    assert_memory_equal(shape, before, sizeof shape);
    for (int t = 0; t < 60; t++) {
        for (int i = 0; i < M; i++)
            r.wanted[i] = (pzs_real)(1e-5 * ((t * 7 + i * 3) % 11 - 5));
        act(&r, load);
        stuck = t == 20 ? r.sensed[1] : stuck;
        if (t >= 20)
            r.sensed[1] = stuck;
        const pzs_status status = pzs_estimate_tick(&r.estimate, r.sensed, shape);
        told += status == PZS_W_SENSOR && r.estimate.info.where == 1;
        assert_true(t >= 20 || status == PZS_OK);
        assert_false(PZS_IS_ERROR(pzs_tick(&r.control, r.wanted, shape)));
    }
    assert_true(told >= 20);
    rig_close(&r);
}

/* ---- known loads ------------------------------------------------------ */

/*
 * A load announced a tick ahead is met before it shows: the shape does not move at all where the
 * volts can hold it, while without feed-forward it is off by the load's whole effect for a tick.
 */
static void test_feed_forward(void **state)
{
    double off[2] = {0};
    (void)state;
    for (int known = 0; known < 2; known++) {
        rig r;
        rig_open(&r, 9);
        for (int i = 0; i < M; i++) /* a load that the volts can undo */
            for (int l = 0; l < LOADS; l++) {
                r.by_load[i * LOADS + l] = 4 * r.real[i * N + l];
                r.per[i * LOADS + l] = (pzs_real)r.by_load[i * LOADS + l];
            }
        memset(r.wanted, 0, sizeof r.wanted);
        start(&r);
        for (int t = 0; t < 40; t++) {
            const double now = t < 20 ? 0 : 1;
            const double next = t < 19 ? 0 : 1;
            const double load[LOADS] = {now, -now, 2 * now};
            const pzs_real acting[LOADS] = {(pzs_real)now, (pzs_real)-now, (pzs_real)(2 * now)};
            const pzs_real coming[LOADS] = {(pzs_real)next, (pzs_real)-next, (pzs_real)(2 * next)};
            pzs_real wanted[M];
            act(&r, load);
            for (int i = 0; i < M; i++)
                off[known] = fmax(off[known], fabs((double)r.measured[i]));
            memcpy(wanted, r.wanted, sizeof wanted);
            if (known) {
                assert_int_equal(pzs_feed_forward(&r.known, acting, r.measured), PZS_OK);
                assert_int_equal(pzs_feed_forward(&r.known, coming, wanted), PZS_OK);
            }
            assert_int_equal(pzs_tick(&r.control, wanted, r.measured), PZS_OK);
        }
        rig_close(&r);
    }
    assert_true(off[0] > 5e-6 && off[1] < 1e4 * EPS * 1e-5);
}

/* ---- amplifiers ------------------------------------------------------- */

/* What an electrode really does: its own strength, and a share of the others'. */
static void make_real(rig *r, double least, double most, double share)
{
    for (int k = 0; k < N; k++) {
        const double strength = uniform(&r->seed, least, most);
        for (int i = 0; i < M; i++) {
            r->real[i * N + k] = strength * (double)r->problem.influence[i * N + k];
            for (int j = 0; j < N && share > 0; j++)
                r->real[i * N + k] +=
                    uniform(&r->seed, -share, share) / N * (double)r->problem.influence[i * N + j];
        }
    }
}

/*
 * Volts are whole steps inside limits and slew, less than one short of those asked for, stand still
 * at rest whatever the plant's strength, and cost no more than what a step of each electrode does.
 */
static void test_quantised(void **state)
{
    static const double steps[] = {0.05, 0.5, 3, 11};
    static const double load[LOADS];
    (void)state;
    for (int trial = 0; trial < 200; trial++) {
        const double step = steps[trial % 4];
        double error[2] = {0}, allowed = 0;
        for (int quantised = 0; quantised < 2; quantised++) {
            rig r;
            pzs_real before[N], wish[N];
            rig_open(&r, (unsigned)trial + 100u);
            make_real(&r, 0.5, 1.5, trial % 2 ? 0.5 : 0);
            int moved = 0;
            for (int t = 0; t < 200; t++) {
                memcpy(before, r.control.info.voltage, sizeof before);
                act(&r, load);
                assert_int_equal(pzs_tick(&r.control, r.wanted, r.measured), PZS_OK);
                memcpy(wish, r.control.info.voltage, sizeof wish);
                if (quantised)
                    assert_int_equal(pzs_quantise(&r.control, r.given, (pzs_real)step, 0), PZS_OK);
                for (int k = 0; k < N; k++) {
                    const pzs_real v = r.control.info.voltage[k];
                    const double count = (double)v / (double)(pzs_real)step;
                    assert_true(v >= r.problem.lower[k] && v <= r.problem.upper[k]);
                    assert_true(fabs((double)v - (double)before[k]) <=
                                (double)r.problem.step_limit[k] * (1 + 2 * EPS));
                    assert_true(!quantised || fabs(count - round(count)) <= 8 * EPS * fabs(count));
                    assert_true(fabs((double)(v - wish[k])) < step * (1 + 8 * EPS)); /* less than a
                                                                                        step is left
                                                                                      */
                    moved += t >= 100 && memcmp(&v, &before[k], sizeof v) != 0;
                }
            }
            assert_true(!quantised || moved == 0);
            for (int i = 0; i < M; i++)
                error[quantised] += pow((double)(r.measured[i] - r.wanted[i]), 2);
            for (int k = 0; k < N; k++) {
                double column = 0;
                for (int i = 0; i < M; i++)
                    column += pow(r.real[i * N + k], 2);
                allowed += step * sqrt(column);
            }
            rig_close(&r);
        }
        assert_true(sqrt(error[1]) <= sqrt(error[0]) + 2 * allowed);
    }
}

/* Changes inside the dead band are not made, nor predicted; volts of more steps than a real has are
 * left as they are. */
static void test_dead_band(void **state)
{
    rig r;
    (void)state;
    rig_open(&r, 21);
    r.control.state.voltage[0] = 5;
    r.control.state.voltage[1] = PZS_R(-2.75);
    r.control.state.voltage[2] = PZS_R(0.3);
    r.control.state.voltage[3] = 99;
    r.given[3] = 98;
    assert_int_equal(pzs_quantise(&r.control, r.given, PZS_R(0.5), PZS_R(0.5)), PZS_OK);
    assert_true((double)r.control.info.voltage[0] == 5 &&
                (double)r.control.info.voltage[1] == -2.5 &&
                (double)r.control.info.voltage[2] == 0);
    assert_true((double)r.control.info.voltage[3] == 99);
    r.control.state.voltage[1] = -2;
    assert_int_equal(pzs_quantise(&r.control, r.given, PZS_R(0.5), PZS_R(0.5)), PZS_OK);
    assert_true((double)r.control.info.voltage[1] == -2.5);
    r.control.state.voltage[1] = PZS_R(17.3);
    assert_int_equal(pzs_quantise(&r.control, r.given, PZS_R(1e-12), 0), PZS_OK);
    assert_memory_equal(&r.control.info.voltage[1], &r.given[1], sizeof r.given[1]);
    assert_true(fabs((double)r.control.info.voltage[1] - 17.3) < 1e-6);
    assert_memory_equal(r.control.info.voltage, r.given, sizeof r.given);
    rig_close(&r);
}

/* ---- misuse ----------------------------------------------------------- */

/* Every way to start wrongly has its status, and nothing runs before it has started. */
static void test_misuse(void **state)
{
    const size_t bytes = PZS_ESTIMATE_BYTES(K);
    pzs_real shape[M], amount[LOADS] = {0};
    rig r;
    (void)state;
    rig_open(&r, 23);
    pzs_estimate fresh;
    pzs_control none;
    memset(&fresh, 0, sizeof fresh);
    memset(&none, 0, sizeof none);
    assert_int_equal(pzs_estimate_tick(&fresh, r.sensed, shape), PZS_E_STAGE);
    assert_int_equal(pzs_estimate_tick(&r.estimate, NULL, shape), PZS_E_ARGUMENT);
    assert_int_equal(pzs_estimate_init(NULL, &r.control, &r.tables, r.estimate_work, bytes),
                     PZS_E_ARGUMENT);
    assert_int_equal(pzs_estimate_init(&fresh, NULL, &r.tables, r.estimate_work, bytes),
                     PZS_E_ARGUMENT);
    assert_int_equal(pzs_estimate_init(&fresh, &none, &r.tables, r.estimate_work, bytes),
                     PZS_E_STAGE);
    assert_int_equal(pzs_estimate_init(&fresh, &r.control, &r.tables, r.estimate_work, bytes - 1),
                     PZS_E_WORKSPACE);
    assert_int_equal(fresh.info.where, bytes);
    r.gain[3] *= 2;
    assert_int_equal(pzs_estimate_init(&fresh, &r.control, &r.tables, r.estimate_work, bytes),
                     PZS_E_CRC);
    r.gain[3] = (pzs_real)NAN;
    r.tables.crc = pzs_estimate_crc(&r.tables);
    assert_int_equal(pzs_estimate_init(&fresh, &r.control, &r.tables, r.estimate_work, bytes),
                     PZS_E_NONFINITE);
    r.tables.outputs--;
    assert_int_equal(pzs_estimate_init(&fresh, &r.control, &r.tables, r.estimate_work, bytes),
                     PZS_E_ARGUMENT);
    r.tables.scene++;
    assert_int_equal(pzs_estimate_init(&fresh, &r.control, &r.tables, r.estimate_work, bytes),
                     PZS_E_FORMAT);
    r.tables.scene--;
    r.tables.format++;
    assert_int_equal(pzs_estimate_init(&fresh, &r.control, &r.tables, r.estimate_work, bytes),
                     PZS_E_FORMAT);
    assert_int_equal(pzs_estimate_tick(&fresh, r.sensed, shape), PZS_E_STAGE);
    r.per[0] = -r.per[0];
    assert_int_equal(pzs_feed_forward_check(&r.known), PZS_E_CRC);
    assert_int_equal(pzs_feed_forward_check(NULL), PZS_E_ARGUMENT);
    memcpy(shape, r.wanted, sizeof shape);
    amount[1] = (pzs_real)NAN;
    assert_int_equal(pzs_feed_forward(&r.known, amount, shape), PZS_E_NONFINITE);
    assert_memory_equal(shape, r.wanted, sizeof shape);
    assert_int_equal(pzs_quantise(&none, r.given, 1, 0), PZS_E_STAGE);
    assert_int_equal(pzs_quantise(&r.control, r.given, -1, 0), PZS_E_ARGUMENT);
    assert_int_equal(pzs_quantise(&r.control, r.given, 1, (pzs_real)NAN), PZS_E_ARGUMENT);
    assert_int_equal(pzs_quantise(&r.control, NULL, 1, 0), PZS_E_ARGUMENT);
    const pzs_real voltage = r.control.info.voltage[0];
    r.given[0] = (pzs_real)NAN;
    assert_int_equal(pzs_quantise(&r.control, r.given, 1, 0), PZS_OK);
    assert_true(r.given[0] >= voltage && r.given[0] <= voltage &&
                r.control.info.voltage[0] >= voltage && r.control.info.voltage[0] <= voltage);
    rig_close(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_estimate_exact), cmocka_unit_test(test_estimate_in_loop),
        cmocka_unit_test(test_estimate_lost),  cmocka_unit_test(test_feed_forward),
        cmocka_unit_test(test_quantised),      cmocka_unit_test(test_dead_band),
        cmocka_unit_test(test_misuse),
    };
    return cmocka_run_group_tests_name("estimate", tests, NULL, NULL);
}
