/*
 * Late readings and missed ticks: the block that corrects late readings, pzs_loop_skip, and the
 * limit of the optimiser's work that the tables set.
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

enum { N = 6, M = 18, K = 8, TICKS = 80, KEPT = PZS_DELAY_LIMIT + 1 };
enum { MOST_INPUTS = N, MOST_OUTPUTS = M };

#include "../rigs/problem_rig.h"

/* A static plant that is the model, and its loop with readings of some age. */
typedef struct rig {
    problem_rig problem;
    pzs_estimator estimator;
    pzs_reading_delay late;
    pzs_fault_detection detection;
    pzs_supervision supervision;
    pzs_real park[N];
    pzs_real direct[K * N], gain[M * K], wanted[M];
    pzs_real history[KEPT][M]; /* readings of the last ticks */
    pzs_block block[5];
    size_t count;
    pzs_loop loop;
    void *work;
    unsigned seed;
    int tick;
    bool is_few; /* K sensors and the estimator */
} rig;

/* Tables; influence and readings of electrode k are largest at output and sensor k. */
static void make_tables(rig *r, int delay)
{
    problem_open(&r->problem, N, M, -100, 100, 50);
    fill_random(&r->seed, r->problem.influence, M * N, 1e-7);
    fill_random(&r->seed, r->direct, K * N, 0.1);
    fill_random(&r->seed, r->gain, M * K, 1e-7);
    for (int k = 0; k < N; k++) {
        r->problem.influence[k * N + k] += PZS_R(1e-6);
        r->direct[k * N + k] += 1;
    }
    r->estimator = (pzs_estimator){.scene = SCENE,
                                   .inputs = N,
                                   .outputs = M,
                                   .sensors = K,
                                   .direct = r->direct,
                                   .gain = r->gain};
    r->late = (pzs_reading_delay){.scene = SCENE,
                                  .inputs = N,
                                  .sensors = r->is_few ? K : M,
                                  .delay = (uint16_t)delay,
                                  .direct = r->is_few ? r->direct : NULL};
    r->detection.delay = (uint16_t)delay;
    r->supervision = (pzs_supervision){.scene = SCENE,
                                       .inputs = N,
                                       .timeout = 5,
                                       .ramp_ticks = 4,
                                       .alarm_ticks = 60000,
                                       .polarity_ticks = 60000,
                                       .park = r->park,
                                       .fading = PZS_R(0.9),
                                       .load = 1};
    problem_seal(&r->problem);
    assert_int_equal(pzs_estimator_seal(&r->estimator), PZS_OK);
    assert_int_equal(pzs_reading_delay_seal(&r->late), PZS_OK);
    assert_int_equal(pzs_supervision_seal(&r->supervision), PZS_OK);
}

static void append(rig *r, const pzs_block_type *type, const void *tables)
{
    r->block[r->count++] = (pzs_block){type, tables};
}

static pzs_status start(rig *r)
{
    return start_loop(&r->loop, r->block, r->count, &r->work);
}

/* A loop with or without the correction of late readings. */
static void open_rig(rig *r, int delay, bool is_few, bool is_corrected)
{
    memset(r, 0, sizeof *r);
    r->seed = 5;
    r->is_few = is_few;
    make_tables(r, delay);
    if (is_corrected)
        append(r, &pzs_reading_delay_block, &r->late);
    if (is_few)
        append(r, &pzs_estimator_block, &r->estimator);
    append(r, &pzs_step_block, &r->problem.tables);
    assert_int_equal(start(r), PZS_OK);
}

static void close_rig(rig *r)
{
    free(r->work);
}

/* Readings of the plant under the present voltages, with a trace of noise. out [K or M] */
static void read_plant(rig *r, pzs_real *out)
{
    const pzs_real *table = r->is_few ? r->direct : r->problem.influence;
    const double size = r->is_few ? 1e-7 : 1e-13;
    for (int i = 0; i < (r->is_few ? K : M); i++) {
        double sum = uniform(&r->seed, -size, size);
        for (int k = 0; k < N; k++)
            sum += (double)table[i * N + k] * (double)r->loop.info.voltage[k];
        out[i] = (pzs_real)sum;
    }
}

/* The plant at this tick is measured and kept; readings are those of `age` ticks ago. */
static const pzs_real *readings_of(rig *r, int age)
{
    read_plant(r, r->history[r->tick % KEPT]);
    const int then = r->tick > age ? r->tick - age : 0;
    r->tick++;
    return r->history[then % KEPT];
}

/* Largest voltage that differs between two ticks (V). */
static double moved(const pzs_real *before, const pzs_real *now)
{
    double most = 0;
    for (int k = 0; k < N; k++)
        most = fmax(most, fabs((double)(now[k] - before[k])));
    return most;
}

/* Run to the end after a target step. Returns the largest change of a voltage in the last 20 ticks
 * (V). Every 7th tick is missed where the loop is told of it. */
static double swing(rig *r, int age, bool misses)
{
    double most = 0;
    for (int i = 0; i < M; i++)
        r->wanted[i] = i < N ? PZS_R(4e-5) : 0;
    for (int tick = 0; tick < TICKS; tick++) {
        pzs_real before[N];
        memcpy(before, r->loop.info.voltage, sizeof before);
        const pzs_real *readings = readings_of(r, age);
        if (misses && tick % 7 == 6) {
            assert_int_equal(pzs_loop_skip(&r->loop, 1), PZS_OK);
            continue;
        }
        assert_false(PZS_IS_ERROR(pzs_loop_tick(&r->loop, r->wanted, readings)));
        if (tick >= TICKS - 20)
            most = fmax(most, moved(before, r->loop.info.voltage));
    }
    return most;
}

/*
 * Readings of any age: on the model's own plant the corrected loop comes to rest, also when it
 * misses ticks and is told of them; without the correction it swings without end. At rest voltages
 * follow the noise of readings of 1e-7 of the range, or the rounding of float.
 */
static void test_corrected(void **state)
{
    const double rest = 1e-3 + 2000 * (double)PZS_EPSILON;
    (void)state;
    for (int is_few = 0; is_few < 2; is_few++)
        for (int delay = 1; delay <= 4; delay++) {
            rig r;
            open_rig(&r, delay, is_few, true);
            assert_true(swing(&r, delay, false) < rest);
            close_rig(&r);
            open_rig(&r, delay, is_few, true);
            assert_true(swing(&r, delay, true) < rest);
            close_rig(&r);
            open_rig(&r, delay, false, false);
            assert_true(swing(&r, delay, false) > 1);
            close_rig(&r);
        }
}

/* A reading one tick older than the tables say makes a loop without a damper swing: its voltages
 * repeat with the period of 6 ticks of z^2 - z + 1 = 0. */
static void test_too_old(void **state)
{
    rig r;
    (void)state;
    open_rig(&r, 0, false, false);
    assert_true(swing(&r, 1, false) > 1);
    pzs_real before[N];
    memcpy(before, r.loop.info.voltage, sizeof before);
    for (int i = 0; i < 6; i++)
        (void)pzs_loop_tick(&r.loop, r.wanted, readings_of(&r, 1));
    assert_true(moved(before, r.loop.info.voltage) < 1e-2 + 2000 * (double)PZS_EPSILON);
    close_rig(&r);
}

/* A missing late reading is missing, and a stuck one is noticed although the voltages move. */
static void test_bad_readings(void **state)
{
    rig r;
    int warned = 0;
    (void)state;
    open_rig(&r, 2, false, true);
    for (int tick = 0; tick < 40; tick++) {
        pzs_real readings[M];
        memcpy(readings, readings_of(&r, 2), sizeof readings);
        for (int i = 0; i < N; i++)
            r.wanted[i] = (pzs_real)((tick / 2) % 2 ? 2e-5 : -2e-5);
        if (tick == 5)
            readings[3] = (pzs_real)NAN;
        if (tick >= 10)
            readings[1] = PZS_R(1e-6);
        const pzs_status status = pzs_loop_tick(&r.loop, r.wanted, readings);
        if (tick == 5)
            assert_int_equal(status, PZS_W_SENSOR);
        if (tick > 5 && tick < 10)
            assert_int_equal(status, PZS_OK);
        warned += tick >= 10 && status == PZS_W_SENSOR && r.loop.info.where == 1;
    }
    assert_in_range(warned, 40 - 10 - 20, 40 - 10 - 7);
    close_rig(&r);
}

/* Wrong tables are refused by name. */
static void test_wrong_tables(void **state)
{
    static const pzs_status expected[] = {PZS_E_FORMAT,   PZS_E_FORMAT,    PZS_E_CRC,
                                          PZS_E_ARGUMENT, PZS_E_ARGUMENT,  PZS_E_ARGUMENT,
                                          PZS_E_ARGUMENT, PZS_E_NONFINITE, PZS_OK};
    rig r;
    (void)state;
    for (int kind = 0; kind < 9; kind++) {
        pzs_real direct[K * N];
        open_rig(&r, 2, true, true);
        memcpy(direct, r.direct, sizeof direct);
        direct[3] = kind == 7 ? (pzs_real)NAN : direct[3];
        r.late.direct = kind == 6 ? NULL : direct;
        r.late.scene += kind == 1;
        r.late.sensors = (uint16_t)(r.late.sensors - (kind == 3));
        r.late.delay = kind == 4 ? PZS_DELAY_LIMIT + 1 : r.late.delay;
        r.late.inputs = (uint16_t)(r.late.inputs - (kind == 5));
        assert_int_equal(pzs_reading_delay_seal(&r.late), PZS_OK);
        r.late.format += kind == 0;
        r.late.crc ^= kind == 2;
        assert_int_equal(start(&r), expected[kind]);
        if (kind < 8)
            assert_ptr_equal(r.loop.info.block, &pzs_reading_delay_block);
        close_rig(&r);
    }
    assert_int_equal(pzs_reading_delay_seal(NULL), PZS_E_ARGUMENT);
    r.late.inputs = 0;
    assert_int_equal(pzs_reading_delay_seal(&r.late), PZS_E_ARGUMENT);
}

/* Missed ticks count as ticks without a frame for the time-out, and only once. */
static void test_skip(void **state)
{
    rig r;
    (void)state;
    memset(&r, 0, sizeof r);
    assert_int_equal(pzs_loop_skip(NULL, 1), PZS_E_ARGUMENT);
    assert_int_equal(pzs_loop_skip(&r.loop, 1), PZS_E_STAGE);
    for (int missed = 0; missed <= 5; missed++) {
        open_rig(&r, 0, false, false);
        append(&r, &pzs_supervisor_block, &r.supervision);
        assert_int_equal(start(&r), PZS_OK);
        for (int tick = 0; tick < 10; tick++)
            (void)pzs_loop_tick(&r.loop, r.wanted, readings_of(&r, 0));
        assert_int_equal(pzs_loop_skip(&r.loop, (uint32_t)missed), PZS_OK);
        const pzs_status status = pzs_loop_tick(&r.loop, r.wanted, NULL);
        assert_int_equal(status == PZS_W_RAMP, missed >= 4); /* time-out after 5 ticks */
        close_rig(&r);
    }
    open_rig(&r, 0, false, false);
    for (int i = 0; i < 3; i++)
        assert_int_equal(pzs_loop_skip(&r.loop, UINT32_MAX), PZS_OK);
    assert_int_equal(r.loop.state.missed, PZS_MISSED_LIMIT);
    (void)pzs_loop_tick(&r.loop, r.wanted, NULL);
    assert_int_equal(r.loop.state.missed, 0);
    close_rig(&r);
}

/* Damaged tables of late readings and of the supervisor are found while the loop runs; the
 * supervisor then parks the voltages. */
static void test_scrub(void **state)
{
    rig r;
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        pzs_real direct[K * N];
        int tick = 0, damaged = 0;
        open_rig(&r, 2, true, true);
        memcpy(direct, r.direct, sizeof direct);
        r.late.direct = direct;
        r.supervision.alarm_ticks = UINT16_MAX;
        assert_int_equal(pzs_supervision_seal(&r.supervision), PZS_OK);
        append(&r, &pzs_supervisor_block, &r.supervision);
        assert_int_equal(start(&r), PZS_OK);
        for (; tick < 300 && !damaged; tick++) {
            direct[3] += tick == 40 && kind == 1 ? PZS_R(0.125) : 0;
            r.park[2] += tick == 40 && kind == 2 ? PZS_R(0.125) : 0;
            damaged = pzs_loop_tick(&r.loop, r.wanted, readings_of(&r, 2)) == PZS_W_RAMP;
        }
        assert_int_equal(damaged, kind > 0);
        assert_true(damaged == 0 || tick > 40);
        close_rig(&r);
    }
}

/* The tables set the limit of the optimiser's work; 0 is the default of the library. */
static void test_work_limit(void **state)
{
    rig r;
    (void)state;
    for (int i = 0; i < 2; i++) {
        const uint64_t limit = i ? 2 * PZS_WORK_LEAST(N) : 0;
        open_rig(&r, 0, false, false);
        assert_true(r.loop.info.control->settings.work_limit == PZS_WORK_LIMIT(N));
        r.problem.tables.work_limit = limit;
        assert_int_equal(start(&r), limit > 0 ? PZS_E_CRC : PZS_OK);
        problem_seal(&r.problem);
        assert_int_equal(start(&r), PZS_OK);
        assert_true(r.loop.info.control->settings.work_limit ==
                    (limit > 0 ? limit : PZS_WORK_LIMIT(N)));
        close_rig(&r);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_corrected),    cmocka_unit_test(test_too_old),
        cmocka_unit_test(test_bad_readings), cmocka_unit_test(test_wrong_tables),
        cmocka_unit_test(test_skip),         cmocka_unit_test(test_scrub),
        cmocka_unit_test(test_work_limit)};
    return cmocka_run_group_tests_name("late", tests, NULL, NULL);
}
