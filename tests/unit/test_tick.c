/*
 * The control tick as a firmware sees it: limits, slew, lost sensors, dead electrodes, bad tables.
 * Both precisions.
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
#include "../../lib/control/sensor_check.h"
#include "../../lib/core/guard.h"
#include "../../lib/control/control.h"

#ifndef LONG_TICKS
#define LONG_TICKS 200000
#endif

enum { N = 8, M = 20 };
enum { MOST_INPUTS = N, MOST_OUTPUTS = M };

#include "../rigs/problem_rig.h"

#define EPS ((double)PZS_EPSILON)

/* A controller of eight amplifiers on twenty outputs, in a workspace of exactly the promised size.
 */
typedef struct rig {
    problem_rig problem;
    pzs_control control;
    pzs_real wanted[M], measured[M];
    void *work;
    unsigned seed;
} rig;

static void rig_open(rig *r)
{
    memset(r, 0, sizeof *r);
    r->seed = 5;
    problem_open(&r->problem, N, M, -30, 50, 7);
    fill_random(&r->seed, r->problem.influence, M * N, 1e-6);
    fill_random(&r->seed, r->wanted, M, 1e-4);
    problem_seal(&r->problem);
    r->work = malloc(PZS_CONTROL_BYTES(N, M));
    assert_non_null(r->work);
}

static pzs_status rig_start(rig *r)
{
    return pzs_control_init(&r->control, &r->problem.tables, NULL, r->work,
                            PZS_CONTROL_BYTES(N, M));
}

static void assert_allowed(const rig *r, const pzs_real *before)
{
    for (int k = 0; k < N; k++) {
        const pzs_real v = r->control.info.voltage[k];
        assert_true(v >= r->problem.lower[k] && v <= r->problem.upper[k]);
        if (before) /* the window is rounded inwards, so the difference is exact up to its own
                       rounding */
            assert_true(fabs((double)v - (double)before[k]) <=
                        (double)r->problem.step_limit[k] * (1 + 2 * EPS));
    }
}

static void tick(rig *r, const pzs_real *measured, pzs_status expected)
{
    pzs_real before[N];
    memcpy(before, r->control.info.voltage, sizeof before);
    assert_int_equal(pzs_tick(&r->control, r->wanted, measured), expected);
    assert_allowed(r, before);
}

/* How good the volts of the last tick are. */
static pzs_report assess(rig *r)
{
    pzs_real error[M];
    pzs_report report = {0};
    for (int i = 0; i < M; i++)
        error[i] = r->wanted[i] - r->control.info.disturbance[i];
    assert_int_equal(pzs_assess(&r->control, error, &report), PZS_OK);
    return report;
}

/* What a plant of 90 % of the tables' strength shows, with a disturbance. */
static void plant(rig *r, double disturbance)
{
    for (int i = 0; i < M; i++) {
        double y = disturbance * (i - M / 2);
        for (int k = 0; k < N; k++)
            y += 0.9 * (double)r->problem.influence[i * N + k] * (double)r->control.info.voltage[k];
        r->measured[i] = (pzs_real)y;
    }
}

/* Law: volts move by at most the slew a tick and stay inside the limits, until the bounded optimum
 * is reached. */
static void test_slew_then_optimum(void **state)
{
    (void)state;
    rig r;
    rig_open(&r);
    assert_int_equal(rig_start(&r), PZS_OK);
    for (int i = 0; i < 30; i++)
        tick(&r, NULL, PZS_OK);
    const pzs_report slow = assess(&r);
    assert_true((double)slow.kkt_violation < 1e3 * EPS);
    assert_true(slow.active_limits > 0);
    for (int k = 0; k < N; k++)
        r.problem.step_limit[k] = (pzs_real)HUGE_VAL;
    r.problem.tables.crc = pzs_problem_crc(&r.problem.tables);
    assert_int_equal(rig_start(&r), PZS_OK);
    tick(&r, NULL, PZS_OK);
    assert_true(fabs((double)(assess(&r).relative_error - slow.relative_error)) < 1e3 * EPS);
    free(r.work);
}

/* Law: with measurements the loop ends where the measured shape is best, though the plant is weaker
 * than the tables. */
static void test_measured_disturbance(void **state)
{
    (void)state;
    rig r;
    rig_open(&r);
    for (int k = 0; k < N; k++)
        r.problem.upper[k] = 5000, r.problem.lower[k] = -5000, r.problem.step_limit[k] = 500;
    r.problem.tables.crc = pzs_problem_crc(&r.problem.tables);
    assert_int_equal(rig_start(&r), PZS_OK);
    for (int i = 0; i < 60; i++) {
        plant(&r, 1e-6);
        tick(&r, r.measured, PZS_OK);
    }
    plant(&r, 1e-6);
    for (int k = 0; k < N; k++) { /* no voltage could improve the true misfit: B'(wanted - measured)
                                     = 0 */
        double slope = 0, scale = 0;
        for (int i = 0; i < M; i++) {
            slope += (double)r.problem.influence[i * N + k] *
                     ((double)r.wanted[i] - (double)r.measured[i]);
            scale += fabs((double)r.problem.influence[i * N + k] * (double)r.wanted[i]);
        }
        assert_true(fabs(slope) < 1e4 * EPS * scale);
    }
    free(r.work);
}

/* Law: a measurement that is not finite keeps its output's last disturbance; all of them gone,
 * volts are held. */
static void test_lost_sensors(void **state)
{
    (void)state;
    rig r;
    pzs_real held[N];
    rig_open(&r);
    assert_int_equal(rig_start(&r), PZS_OK);
    for (int i = 0; i < 10; i++) {
        plant(&r, 1e-7);
        tick(&r, r.measured, PZS_OK);
    }
    const pzs_real kept = r.control.info.disturbance[3];
    plant(&r, 5e-7);
    r.measured[3] = (pzs_real)NAN;
    r.measured[7] = (pzs_real)INFINITY;
    tick(&r, r.measured, PZS_W_SENSOR);
    assert_int_equal(r.control.info.where, 3);
    assert_true(!(r.control.info.disturbance[3] < kept) && !(r.control.info.disturbance[3] > kept));
    memcpy(held, r.control.info.voltage, sizeof held);
    for (int i = 0; i < M; i++)
        r.measured[i] = (pzs_real)NAN;
    tick(&r, r.measured, PZS_W_HELD);
    assert_memory_equal(held, r.control.info.voltage, sizeof held);
    plant(&r, 1e-7);
    tick(&r, r.measured, PZS_OK);
    r.wanted[2] = (pzs_real)-INFINITY;
    memcpy(held, r.control.info.voltage, sizeof held);
    tick(&r, r.measured, PZS_W_HELD);
    assert_memory_equal(held, r.control.info.voltage, sizeof held);
    free(r.work);
}

/* Law: a sensor that shows the same bits while its output should move is found and set aside, and
 * taken back when it lives. */
static void test_stuck_sensor(void **state)
{
    (void)state;
    rig r;
    rig_open(&r);
    assert_int_equal(rig_start(&r), PZS_OK);
    pzs_real stuck = 0;
    int found = 0;
    for (int i = 0; i < 60; i++) {
        for (int j = 0; j < M; j++)
            r.wanted[j] = (pzs_real)(1e-5 * ((i * 7 + j * 3) % 11 - 5));
        plant(&r, 0);
        if (i == 20)
            stuck = r.measured[4];
        if (i >= 20)
            r.measured[4] = stuck;
        const pzs_status status = pzs_tick(&r.control, r.wanted, r.measured);
        assert_allowed(&r, NULL);
        found += status == PZS_W_SENSOR && r.control.info.where == 4;
        if (i < 20)
            assert_int_equal(status, PZS_OK);
    }
    assert_true(found >= 20);
    plant(&r, 0);
    tick(&r, r.measured, PZS_OK);
    free(r.work);
}

/* Law: a sensor that was missing is taken back at once, also if it returns with the bits that it
 * had before; and a stuck sensor is found although it is missing in every third tick. */
static void test_returning_sensor(void **state)
{
    (void)state;
    rig r;
    int found = 0;
    rig_open(&r);
    assert_int_equal(rig_start(&r), PZS_OK);
    for (int i = 0; i < 200; i++) { /* until voltages and readings stand still */
        plant(&r, 1e-7);
        tick(&r, r.measured, PZS_OK);
    }
    const pzs_real last = r.measured[4];
    r.measured[4] = (pzs_real)NAN;
    tick(&r, r.measured, PZS_W_SENSOR);
    r.measured[4] = last;
    tick(&r, r.measured, PZS_OK);
    for (int i = 0; i < 60; i++) {
        for (int j = 0; j < M; j++)
            r.wanted[j] = (pzs_real)(1e-5 * ((i * 7 + j * 3) % 11 - 5));
        plant(&r, 0);
        r.measured[4] = i % 3 == 0 ? (pzs_real)NAN : last;
        found += pzs_tick(&r.control, r.wanted, r.measured) == PZS_W_SENSOR && i % 3 != 0;
    }
    assert_true(found >= 20);
    free(r.work);
}

/* Law: a repeated reading counts as stuck after SENSOR_STUCK_TICKS ticks in which its expected
 * value moved by more than a 64th of |reading| + 3 times the RMS of all expected values, and never
 * where it moved by less. */
static void test_resolution(void **state)
{
    (void)state;
    static const double part[] = {0.98, 1.02};
    for (int k = 0; k < 2; k++) {
        pzs_real expected[4] = {1, -1, 1, -1}, measured[4] = {1, 0, 0, 0}, last[4] = {1, 0, 0, 0};
        pzs_real difference[4] = {(pzs_real)(part[k] / 32), 1, -1, 1};
        uint8_t repeats[4] = {0};
        const sensor_check all = {4, expected, last, difference, repeats};
        uint32_t unusable = 0;
        for (unsigned i = 1; i <= SENSOR_STUCK_TICKS; i++) {
            int32_t where = -1;
            bool is_repeated = true;
            /* only the first value moves, between 1 - 1/32 and 1 + 1/32: the RMS stays 1 to 0.8 %
             */
            expected[0] = (pzs_real)(1 + (i % 2 ? part[k] : -part[k]) / 32);
            unusable = pzs_sensor_check(&all, measured, &where, &is_repeated);
            assert_true(i == SENSOR_STUCK_TICKS || unusable == 0);
        }
        assert_int_equal(unusable, k);
    }
}

/* Law: a held input goes to its voltage within the slew and stays; released, it works again. All
 * held: the loop lives. */
static void test_held_inputs(void **state)
{
    (void)state;
    rig r;
    rig_open(&r);
    assert_int_equal(rig_start(&r), PZS_OK);
    for (int i = 0; i < 20; i++)
        tick(&r, NULL, PZS_OK);
    assert_int_equal(pzs_hold(&r.control, 2, 0), PZS_OK);
    assert_int_equal(pzs_hold(&r.control, 3, 1000), PZS_OK); /* cut to its limit */
    for (int i = 0; i < 20; i++) {
        pzs_real before[N];
        memcpy(before, r.control.info.voltage, sizeof before);
        const pzs_status status = pzs_tick(&r.control, r.wanted, NULL);
        assert_true(status == PZS_OK || status == PZS_W_STEP_LIMIT);
        assert_allowed(&r, NULL);
        (void)before;
    }
    assert_true(!(r.control.info.voltage[2] < 0) && !(r.control.info.voltage[2] > 0));
    assert_true(!(r.control.info.voltage[3] < 50));
    for (uint16_t k = 0; k < N; k++)
        assert_int_equal(pzs_hold(&r.control, k, 0), PZS_OK);
    for (int i = 0; i < 20; i++)
        assert_false(PZS_IS_ERROR(pzs_tick(&r.control, r.wanted, NULL)));
    for (int k = 0; k < N; k++)
        assert_true(!(r.control.info.voltage[k] < 0) && !(r.control.info.voltage[k] > 0));
    for (uint16_t k = 0; k < N; k++)
        assert_int_equal(pzs_release(&r.control, k), PZS_OK);
    for (int i = 0; i < 20; i++)
        tick(&r, NULL, PZS_OK);
    assert_true((double)assess(&r).kkt_violation < 1e3 * EPS);
    assert_int_equal(pzs_hold(&r.control, N, 0), PZS_E_ARGUMENT);
    assert_int_equal(pzs_hold(&r.control, 0, (pzs_real)NAN), PZS_E_NONFINITE);
    free(r.work);
}

/* Law: a tick after plain steps, on a plant that is as the tables say, has nothing to correct. */
static void test_tick_after_step(void **state)
{
    (void)state;
    rig r;
    pzs_real before[N];
    rig_open(&r);
    assert_int_equal(rig_start(&r), PZS_OK);
    for (int i = 0; i < 20; i++)
        assert_int_equal(pzs_step(&r.control, r.wanted), PZS_OK);
    for (int i = 0; i < M; i++) {
        r.measured[i] = 0;
        for (int k = 0; k < N; k++)
            r.measured[i] += r.problem.influence[i * N + k] * r.control.info.voltage[k];
    }
    memcpy(before, r.control.info.voltage, sizeof before);
    tick(&r, r.measured, PZS_OK);
    for (int k = 0; k < N; k++)
        assert_true(fabs((double)(r.control.info.voltage[k] - before[k])) < 1e4 * EPS * 50);
    free(r.work);
}

/* Law: an electrode held dead is dead after the next tick, even one without any usable measurement
 * or target. */
static void test_hold_without_senses(void **state)
{
    (void)state;
    for (int lost = 0; lost < 2; lost++) {
        rig r;
        rig_open(&r);
        assert_int_equal(rig_start(&r), PZS_OK);
        for (int i = 0; i < 20; i++)
            tick(&r, NULL, PZS_OK);
        assert_true(fabs((double)r.control.info.voltage[1]) > 1);
        assert_int_equal(pzs_hold(&r.control, 1, 0), PZS_OK);
        for (int i = 0; i < M; i++)
            r.measured[i] = (pzs_real)NAN;
        if (lost)
            r.wanted[0] = (pzs_real)NAN;
        assert_int_equal(pzs_tick(&r.control, r.wanted, lost ? NULL : r.measured), PZS_W_HELD);
        assert_true(fabs((double)r.control.info.voltage[1]) <= 0);
        free(r.work);
    }
}

/* Law: the volts do not depend on the unit of length, to the last bit, over fifteen orders of
 * magnitude. */
static void test_unit_of_length(void **state)
{
    (void)state;
    pzs_real voltage[N];
    for (int power = 0; power < 4; power++) {
        static const int exponent[4] = {0, -20, -10, 30};
        const pzs_real unit = (pzs_real)ldexp(1, exponent[power]);
        rig r;
        rig_open(&r);
        for (int i = 0; i < M * N; i++)
            r.problem.influence[i] *= unit;
        for (int i = 0; i < M; i++)
            r.wanted[i] *= unit;
        r.problem.tables.crc = pzs_problem_crc(&r.problem.tables);
        assert_int_equal(rig_start(&r), PZS_OK);
        for (int i = 0; i < 30; i++)
            tick(&r, NULL, PZS_OK);
        if (power == 0)
            memcpy(voltage, r.control.info.voltage, sizeof voltage);
        assert_memory_equal(voltage, r.control.info.voltage, sizeof voltage);
        free(r.work);
    }
}

/* Law: every way to start wrongly has its status, and a controller that never started refuses to
 * tick. */
static void test_misuse(void **state)
{
    (void)state;
    rig r;
    rig_open(&r);
    const size_t bytes = PZS_CONTROL_BYTES(N, M);
    assert_int_equal(pzs_tick(&r.control, r.wanted, NULL), PZS_E_STAGE);
    assert_int_equal(pzs_step(&r.control, r.wanted), PZS_E_STAGE);
    assert_int_equal(pzs_control_init(NULL, &r.problem.tables, NULL, r.work, bytes),
                     PZS_E_ARGUMENT);
    assert_int_equal(pzs_control_init(&r.control, NULL, NULL, r.work, bytes), PZS_E_ARGUMENT);
    assert_int_equal(pzs_control_init(&r.control, &r.problem.tables, NULL, NULL, bytes),
                     PZS_E_ARGUMENT);
    assert_int_equal(pzs_control_init(&r.control, &r.problem.tables, NULL, r.work, bytes - 1),
                     PZS_E_WORKSPACE);
    assert_int_equal(r.control.info.where, bytes);
    assert_int_equal(
        pzs_control_init(&r.control, &r.problem.tables, NULL, (char *)r.work + 1, bytes),
        PZS_E_WORKSPACE);
    r.problem.influence[5] *= 2;
    assert_int_equal(rig_start(&r), PZS_E_CRC);
    r.problem.tables.crc = pzs_problem_crc(&r.problem.tables);
    r.problem.tables.format++;
    assert_int_equal(rig_start(&r), PZS_E_FORMAT);
    r.problem.tables.format--;
    r.problem.lower[3] = 51;
    r.problem.tables.crc = pzs_problem_crc(&r.problem.tables);
    assert_int_equal(rig_start(&r), PZS_E_LIMITS);
    assert_int_equal(r.control.info.where, 3);
    r.problem.lower[3] = (pzs_real)NAN;
    r.problem.tables.crc = pzs_problem_crc(&r.problem.tables);
    assert_int_equal(rig_start(&r), PZS_E_LIMITS);
    r.problem.lower[3] = -30;
    r.problem.influence[9] = (pzs_real)NAN;
    r.problem.tables.crc = pzs_problem_crc(&r.problem.tables);
    assert_int_equal(rig_start(&r), PZS_E_NONFINITE);
    assert_int_equal(pzs_tick(&r.control, r.wanted, NULL), PZS_E_STAGE);
    r.problem.influence[9] = 0;
    r.problem.tables.crc = pzs_problem_crc(&r.problem.tables);
    assert_int_equal(rig_start(&r), PZS_OK);
    assert_int_equal(pzs_tick(&r.control, NULL, NULL), PZS_E_ARGUMENT);
    tick(&r, NULL, PZS_OK);
    free(r.work);
}

/* Law: 200,000 ticks of a wandering target, with bursts of wild measurements, leave no limit
 * violated, no NaN, no drift. */
static void test_long_walk(void **state)
{
    (void)state;
    static const double wild[] = {1e30, -1e30, 1e-38, 0, HUGE_VAL, -HUGE_VAL};
    rig r;
    double worst = 0;
    rig_open(&r);
    assert_int_equal(rig_start(&r), PZS_OK);
    for (int t = 0; t < LONG_TICKS; t++) {
        pzs_real before[N];
        for (int i = 0; i < M; i++)
            r.wanted[i] = (pzs_real)(0.999 * (double)r.wanted[i] + uniform(&r.seed, -3e-6, 3e-6));
        plant(&r, 1e-7);
        const int burst = t % 1000 < 3;
        if (burst)
            for (int i = 0; i < M; i += 3)
                r.measured[i] = (pzs_real)wild[(t + i) % 6];
        memcpy(before, r.control.info.voltage, sizeof before);
        const pzs_status status = pzs_tick(&r.control, r.wanted, r.measured);
        assert_false(PZS_IS_ERROR(status));
        assert_allowed(&r, before);
        if (!burst && t % 1000 > 20)
            worst = fmax(worst, (double)assess(&r).kkt_violation);
    }
    print_message("  %d ticks: optimality at most %.1e, most passes %d\n", LONG_TICKS, worst,
                  r.control.info.iterations_most);
    assert_true(worst < 1e4 * EPS);
    free(r.work);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_slew_then_optimum), cmocka_unit_test(test_measured_disturbance),
        cmocka_unit_test(test_lost_sensors),      cmocka_unit_test(test_stuck_sensor),
        cmocka_unit_test(test_returning_sensor),  cmocka_unit_test(test_resolution),
        cmocka_unit_test(test_held_inputs),       cmocka_unit_test(test_misuse),
        cmocka_unit_test(test_tick_after_step),   cmocka_unit_test(test_hold_without_senses),
        cmocka_unit_test(test_unit_of_length),    cmocka_unit_test(test_long_walk),
    };
    return cmocka_run_group_tests_name("tick", tests, NULL, NULL);
}
