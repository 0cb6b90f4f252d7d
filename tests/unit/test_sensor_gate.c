/*
 * Sensor gate: a healthy loop keeps its bits, wrong sensors are named and replaced by what the
 * others say, silent ones too; contradictions that few sensors do not explain gate none. With a
 * file name random readings and what the gate made of them are written to it, for the same laws in
 * numpy (tests/oracle/sensor_gate.py).
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

enum {
    N = 6,
    M = 40,
    RELATIONS = 24,
    QUICK = 10,
    MOST = 4,
    PATIENCE = 20,
    CASES = 400,
    LOGGED = 8
};
enum { MOST_INPUTS = N, MOST_OUTPUTS = M };

#include "../rigs/problem_rig.h"

static FILE *dump;

/* A static plant that is the model, read at each output, and its loop with a sensor gate. */
typedef struct rig {
    problem_rig problem;
    pzs_sensor_gate gate;
    pzs_real range[M], parity[M * M], scale[M], threshold[M];
    double error[M]; /* what is added to each reading (m) */
    pzs_real wanted[M], readings[M];
    pzs_block block[2];
    pzs_loop loop;
    void *work;
    unsigned seed;
} rig;

/* Sizes in m: readings under voltages up to 50 V, thresholds, noise of the readings. */
static const double reach = 1e-4, threshold = 2e-5, noise = 1e-7;
static const double weight = 1e6; /* of each reading (1/m) */

/* ---- tables --------------------------------------------------------------- */

/* Orthonormalise the columns of a matrix [M][N + RELATIONS], each against those before. */
static void orthonormalise(double q[M][N + RELATIONS])
{
    for (int k = 0; k < N + RELATIONS; k++) {
        double square = 0;
        for (int other = 0; other < 2 * k; other++) {
            double part = 0;
            for (int i = 0; i < M; i++)
                part += q[i][other % k] * q[i][k];
            for (int i = 0; i < M; i++)
                q[i][k] -= part * q[i][other % k];
        }
        for (int i = 0; i < M; i++)
            square += q[i][k] * q[i][k];
        for (int i = 0; i < M; i++)
            q[i][k] /= sqrt(square);
    }
}

/* Sum of the squares of the first `count` entries of a row of the parity table. */
static double square_of_row(const rig *r, int sensor, int count)
{
    double square = 0;
    for (int k = 0; k < count; k++)
        square += pow((double)r->parity[sensor * RELATIONS + k], 2);
    return square;
}

/* Draw parity relations: random columns without their parts along those of the influence matrix. */
static void make_parity(rig *r)
{
    static double q[M][N + RELATIONS];
    for (int i = 0; i < M; i++)
        for (int k = 0; k < N + RELATIONS; k++)
            q[i][k] = k < N ? (double)r->problem.influence[i * N + k] : uniform(&r->seed, -1, 1);
    orthonormalise(q);
    double quiet = HUGE_VAL;
    for (int i = 0; i < M; i++) {
        for (int k = 0; k < RELATIONS; k++)
            r->parity[i * RELATIONS + k] = (pzs_real)(weight * q[i][N + k]);
        r->scale[i] = (pzs_real)(1 / sqrt(square_of_row(r, i, RELATIONS)));
        quiet = fmin(quiet, threshold * sqrt(square_of_row(r, i, QUICK)));
    }
    r->gate.quiet = (pzs_real)(quiet * (1 - 1e-5));
}

/* Tables of a random smooth problem. */
static void make_tables(rig *r, unsigned seed)
{
    memset(r, 0, sizeof *r);
    r->seed = seed;
    problem_open(&r->problem, N, M, -50, 50, HUGE_VAL);
    for (int k = 0; k < N; k++) {
        const double shift = uniform(&r->seed, 0, 1);
        for (int i = 0; i < M; i++)
            r->problem.influence[i * N + k] =
                (pzs_real)(1e-6 * cos((k + 1) * 3.1 * i / (M - 1) + shift));
    }
    problem_seal(&r->problem);
    fill_reals(r->range, M, 0.01);
    fill_reals(r->threshold, M, threshold);
    r->gate = (pzs_sensor_gate){.scene = SCENE,
                                .sensors = M,
                                .relations = RELATIONS,
                                .quick = QUICK,
                                .most = MOST,
                                .patience = PATIENCE,
                                .replaces = 1,
                                .range = r->range,
                                .parity = r->parity,
                                .scale = r->scale,
                                .threshold = r->threshold,
                                .ratio = 7};
    make_parity(r);
    for (int i = 0; i < M; i++)
        r->wanted[i] = (pzs_real)uniform(&r->seed, -reach, reach);
}

static pzs_status start(rig *r)
{
    assert_int_equal(pzs_sensor_gate_seal(&r->gate), PZS_OK);
    r->block[0] = (pzs_block){&pzs_sensor_gate_block, &r->gate};
    r->block[1] = (pzs_block){&pzs_step_block, &r->problem.tables};
    return start_loop(&r->loop, r->block, 2, &r->work);
}

static rig *open_rig(unsigned seed)
{
    rig *r = calloc(1, sizeof *r);
    assert_non_null(r);
    make_tables(r, seed);
    assert_int_equal(start(r), PZS_OK);
    return r;
}

static void close_rig(rig *r)
{
    free(r->work);
    free(r);
}

/* ---- ticks ------------------------------------------------------------------ */

static double exact(const rig *r, int i)
{
    double sum = 0;
    for (int k = 0; k < N; k++)
        sum += (double)r->problem.influence[i * N + k] * (double)r->loop.info.voltage[k];
    return sum;
}

static void read_sensors(rig *r, double of_noise)
{
    for (int i = 0; i < M; i++)
        r->readings[i] =
            (pzs_real)(exact(r, i) + r->error[i] + uniform(&r->seed, -1, 1) * of_noise);
}

static pzs_status tick(rig *r)
{
    read_sensors(r, noise);
    return pzs_loop_tick(&r->loop, r->wanted, r->readings);
}

static const pzs_sensor_gate_state *state_of(const rig *r)
{
    return pzs_loop_find(&r->loop, &pzs_sensor_gate_block);
}

static int reading_state(const rig *r, int sensor)
{
    return state_of(r)->info.reading[sensor];
}

/* Whether the gate distrusts exactly the sensors with an error. */
static bool is_named(const rig *r)
{
    for (int i = 0; i < M; i++)
        if ((fabs(r->error[i]) > 0) != (reading_state(r, i) != PZS_READING_USED))
            return false;
    return true;
}

static void new_target(rig *r)
{
    for (int i = 0; i < M; i++)
        r->wanted[i] = (pzs_real)uniform(&r->seed, -reach, reach);
}

/* Give `count` random sensors errors between a quarter of `size` and `size`, of both signs. */
static void set_errors(rig *r, int count, double size)
{
    memset(r->error, 0, sizeof r->error);
    while (count > 0) {
        const int i = (int)uniform(&r->seed, 0, M);
        if (fabs(r->error[i]) > 0)
            continue;
        r->error[i] = uniform(&r->seed, size / 4, size) * (uniform(&r->seed, -1, 1) > 0 ? 1 : -1);
        count--;
    }
}

/* ---- tests ------------------------------------------------------------------- */

/* Without a wrong sensor the voltages have the bits of a loop without the gate. */
static void healthy_loops_keep_their_bits(void **state)
{
    rig *r = open_rig(3), *plain = open_rig(3);
    (void)state;
    assert_int_equal(start_loop(&plain->loop, plain->block + 1, 1, &plain->work), PZS_OK);
    for (int t = 0; t < 2000; t++) {
        if (t % 7 == 0) {
            new_target(r);
            memcpy(plain->wanted, r->wanted, sizeof r->wanted);
        }
        assert_int_equal(tick(r), PZS_OK);
        memcpy(plain->readings, r->readings, sizeof r->readings);
        assert_int_equal(pzs_loop_tick(&plain->loop, plain->wanted, plain->readings), PZS_OK);
        assert_memory_equal(r->loop.info.voltage, plain->loop.info.voltage, N * sizeof(pzs_real));
        assert_int_equal(state_of(r)->info.count, 0);
        assert_false(state_of(r)->info.is_unexplained);
    }
    close_rig(plain);
    close_rig(r);
}

/*
 * Largest error of the replaced reading of a sensor: noise in the relations, at most that of all
 * readings, over the smallest own part of its row (the root of 0.05), and rounding of the weighted
 * readings.
 */
static double replaced_error(const rig *r, int sensor)
{
    const double part = weight * (double)r->scale[sensor] / sqrt(0.05);
    return part * (noise * sqrt(RELATIONS) + 64 * (double)PZS_EPSILON * (reach + 0.005));
}

/*
 * Up to `most` sensors that are wrong by 1.5 to 250 thresholds are named within a few ticks, a
 * single one in the first, and replaced by what the others say.
 */
static void wrong_sensors_are_named_and_replaced(void **state)
{
    rig *r = open_rig(5);
    int named = 0, at_once = 0;
    (void)state;
    for (int c = 0; c < CASES; c++) {
        const int count = 1 + c % MOST;
        assert_int_equal(start(r), PZS_OK);
        memset(r->error, 0, sizeof r->error);
        new_target(r);
        for (int t = 0; t < 3; t++)
            assert_int_equal(tick(r), PZS_OK);
        set_errors(r, count, c % 2 ? 6 * threshold : 250 * threshold);
        for (int t = 0; t < 3 * MOST; t++) {
            double right[M];
            for (int i = 0; i < M; i++)
                right[i] = exact(r, i);
            const pzs_status status = tick(r);
            at_once += t == 0 && count == 1 && status == PZS_W_GATED && is_named(r);
            assert_true(status == PZS_W_GATED || status == PZS_W_CONTRADICTION);
            assert_true(fabs(r->error[r->loop.info.where]) > 0 || status != PZS_W_GATED);
            assert_ptr_equal(r->loop.info.block, &pzs_sensor_gate_block);
            for (int i = 0; i < M && is_named(r); i++)
                assert_true(fabs((double)state_of(r)->gated[i] - right[i]) <=
                            noise + 4 * (double)PZS_EPSILON * reach +
                                (fabs(r->error[i]) > 0 ? replaced_error(r, i) : 0));
        }
        named += is_named(r);
    }
    print_message("# %d of %d named, %d of %d single ones at once\n", named, CASES, at_once,
                  CASES / MOST);
    assert_true(named >= 0.98 * CASES && at_once == CASES / MOST);
    close_rig(r);
}

/* A silent sensor is replaced, too, and announced; more than `most` of them stay missing. */
static void silent_sensors_are_replaced(void **state)
{
    rig *r = open_rig(7);
    (void)state;
    for (int count = 1; count <= MOST + 2; count++) {
        assert_int_equal(start(r), PZS_OK);
        assert_int_equal(tick(r), PZS_OK);
        double right[M];
        for (int i = 0; i < M; i++)
            right[i] = exact(r, i);
        read_sensors(r, noise);
        for (int i = 0; i < count; i++)
            r->readings[3 + 5 * i] = (pzs_real)NAN;
        assert_int_equal(pzs_loop_tick(&r->loop, r->wanted, r->readings), PZS_W_SENSOR);
        assert_int_equal(r->loop.info.where, 3);
        assert_int_equal(state_of(r)->info.count, 0);
        for (int i = 0; i < count; i++) {
            const double value = (double)state_of(r)->gated[3 + 5 * i];
            assert_int_equal(reading_state(r, 3 + 5 * i), PZS_READING_MISSING);
            if (count <= MOST)
                assert_true(fabs(value - right[3 + 5 * i]) <= replaced_error(r, 3 + 5 * i));
            else
                assert_true(isnan(value));
        }
    }
    close_rig(r);
}

/* Readings beyond their range, NaN and infinity are missing, whatever their size. */
static void ranges_are_kept(void **state)
{
    const double bad[] = {0.0101, -0.0101, 1, -1e30, HUGE_VAL, -HUGE_VAL, (double)NAN};
    rig *r = open_rig(9);
    (void)state;
    for (size_t c = 0; c < sizeof bad / sizeof *bad; c++) {
        const bool is_finite = bad[c] - bad[c] <= 0;
        assert_int_equal(start(r), PZS_OK);
        assert_int_equal(tick(r), PZS_OK);
        read_sensors(r, noise);
        r->readings[M - 1] = (pzs_real)bad[c];
        assert_int_equal(pzs_loop_tick(&r->loop, r->wanted, r->readings),
                         is_finite ? PZS_W_GATED : PZS_W_SENSOR);
        assert_int_equal(r->loop.info.where, M - 1);
        assert_int_equal(reading_state(r, M - 1),
                         is_finite ? PZS_READING_RANGE : PZS_READING_MISSING);
        assert_int_equal(tick(r), PZS_OK);
    }
    for (int i = 0; i < M; i++)
        r->readings[i] = 1;
    assert_int_equal(pzs_loop_tick(&r->loop, r->wanted, r->readings), PZS_W_HELD);
    close_rig(r);
}

/*
 * Without redundancy the gate has ranges only; the arrays of the basis are absent. The step, which
 * then gets NaN, announces the sensor itself.
 */
static void a_gate_may_have_ranges_only(void **state)
{
    rig *r = calloc(1, sizeof *r);
    (void)state;
    make_tables(r, 11);
    r->gate = (pzs_sensor_gate){.scene = SCENE, .sensors = M, .range = r->range};
    assert_int_equal(start(r), PZS_OK);
    r->error[4] = 0.005;
    assert_int_equal(tick(r), PZS_OK);
    r->error[4] = 0.02;
    assert_int_equal(tick(r), PZS_W_SENSOR);
    assert_int_equal(r->loop.info.where, 4);
    assert_int_equal(reading_state(r, 4), PZS_READING_RANGE);
    assert_true(isnan((double)state_of(r)->gated[4]));
    close_rig(r);
}

/* With `replaces` 0 a gated sensor counts as silent. */
static void gated_readings_may_be_missing(void **state)
{
    rig *r = calloc(1, sizeof *r);
    (void)state;
    make_tables(r, 11);
    r->gate.replaces = 0;
    assert_int_equal(start(r), PZS_OK);
    r->error[4] = 0.005;
    assert_int_equal(tick(r), PZS_W_SENSOR);
    assert_int_equal(reading_state(r, 4), PZS_READING_CONTRADICTED);
    assert_true(isnan((double)state_of(r)->gated[4]) && is_named(r));
    close_rig(r);
}

/* A gated sensor is trusted after it has agreed for `patience` ticks in succession. */
static void repaired_sensors_are_trusted_again(void **state)
{
    rig *r = open_rig(13);
    (void)state;
    r->error[8] = 0.001;
    assert_int_equal(tick(r), PZS_W_GATED);
    r->error[8] = 0;
    for (int t = 0; t < PATIENCE - 1; t++)
        assert_int_equal(tick(r), PZS_W_GATED);
    r->error[8] = 0.9 * threshold; /* too large to be trusted, too small to be found */
    assert_int_equal(tick(r), PZS_W_GATED);
    r->error[8] = 0;
    for (int t = 0; t < PATIENCE - 1; t++)
        assert_int_equal(tick(r), PZS_W_GATED);
    assert_int_equal(tick(r), PZS_OK);
    assert_int_equal(tick(r), PZS_OK);
    close_rig(r);
}

/* More wrong sensors than `most`, or all, are not gated away: the contradiction is announced. */
static void too_many_wrong_sensors_gate_none(void **state)
{
    rig *r = open_rig(15);
    int gated = 0;
    (void)state;
    for (int c = 0; c < 200; c++) {
        assert_int_equal(start(r), PZS_OK);
        set_errors(r, c % 2 ? M : MOST + 3, 50 * threshold);
        for (int t = 0; t < 20; t++) {
            const pzs_status status = tick(r);
            const bool is_told = status == PZS_W_CONTRADICTION;
            assert_true(is_told || status == PZS_W_GATED);
            assert_true(state_of(r)->info.is_unexplained == is_told);
            if (is_told) /* the loop then does what it does without the gate */
                assert_memory_equal(state_of(r)->gated, r->readings, sizeof r->readings);
        }
        gated += state_of(r)->info.count > 0;
    }
    print_message("# %d of 200 gated a sensor\n", gated);
    assert_true(gated <= 2);
    close_rig(r);
}

/*
 * Sensors that fail one after the other are all named, also those that fail while others are gated
 * or silent; those that recover are trusted again.
 */
static void sensors_fail_one_after_the_other(void **state)
{
    rig *r = open_rig(29);
    const int order[] = {3, 19, 34, 11};
    (void)state;
    for (int k = 0; k < MOST; k++) {
        r->error[order[k]] = k == 1 ? (double)NAN : 30 * threshold;
        for (int t = 0; t < 3; t++)
            assert_int_equal(tick(r), PZS_W_GATED);
        for (int i = 0; i < M; i++) {
            bool is_wrong = false;
            for (int m = 0; m <= k; m++)
                is_wrong = is_wrong || order[m] == i;
            assert_int_equal(reading_state(r, i) != PZS_READING_USED, is_wrong);
        }
    }
    memset(r->error, 0, sizeof r->error);
    for (int t = 0; t < PATIENCE + 1; t++)
        (void)tick(r);
    assert_int_equal(tick(r), PZS_OK);
    close_rig(r);
}

/*
 * A drift is found when it reaches the threshold and what remains of it has moved no reading by
 * more than that; a sensor with noise of many thresholds stays gated.
 */
static void drifting_and_noisy_sensors_are_found(void **state)
{
    rig *r = open_rig(31);
    int since = 0;
    (void)state;
    for (int t = 0; t < 400; t++) {
        r->error[21] = 0.01 * threshold * t;
        const pzs_status status = tick(r);
        since = status == PZS_W_GATED && since == 0 ? t : since;
        assert_true(status == PZS_OK || (status == PZS_W_GATED && r->loop.info.where == 21));
        assert_true(since == 0 || status == PZS_W_GATED);
    }
    assert_in_range(since, 90, 110);
    r->error[21] = 0;
    int gated = 0;
    for (int t = 0; t < 1000; t++) {
        r->error[8] = uniform(&r->seed, -20, 20) * threshold;
        gated += tick(r) == PZS_W_GATED && reading_state(r, 8) == PZS_READING_CONTRADICTED;
    }
    assert_true(gated >= 995);
    close_rig(r);
}

/* Whether a tick has used all readings, whether or not it announces a contradiction. */
static bool gates_nothing(const rig *r, pzs_status status)
{
    return (status == PZS_OK || status == PZS_W_CONTRADICTION) && state_of(r)->info.count == 0;
}

/*
 * A load that the tables do not know moves the neighbours of each sensor, too: nothing is gated,
 * and a sensor that is gated while the load is there is trusted again after its repair.
 */
static void unknown_loads_gate_nothing(void **state)
{
    rig *r = open_rig(17);
    (void)state;
    for (int centre = 0; centre < M; centre++)
        for (double size = threshold; size < 100 * threshold; size *= 3) {
            assert_int_equal(start(r), PZS_OK);
            for (int i = 0; i < M; i++)
                r->error[i] = size * exp(-0.05 * (i - centre) * (i - centre));
            for (int t = 0; t < 3 * MOST; t++)
                assert_true(gates_nothing(r, tick(r)));
        }
    assert_int_equal(start(r), PZS_OK);
    for (int i = 0; i < M; i++)
        r->error[i] = 3 * threshold * exp(-0.05 * (i - 20) * (i - 20));
    r->error[7] += 0.002;
    assert_int_equal(tick(r), PZS_W_GATED);
    assert_int_equal(r->loop.info.where, 7);
    r->error[7] -= 0.002;
    pzs_status status = PZS_W_GATED;
    for (int t = 0; t < PATIENCE; t++)
        status = tick(r);
    assert_true(gates_nothing(r, status));
    close_rig(r);
}

/* A million ticks of noise alone, a third of the threshold at most, gate nothing. */
static void noise_gates_nothing(void **state)
{
    rig *r = open_rig(19);
    const long ticks = 1000000;
    (void)state;
    for (long t = 0; t < ticks; t++) {
        read_sensors(r, threshold / 3);
        assert_true(gates_nothing(r, pzs_loop_tick(&r->loop, r->wanted, r->readings)));
    }
    close_rig(r);
}

/* Damage of the gate's memory costs no bad access, no voltage that is not finite, and heals. */
static void damaged_memory_heals(void **state)
{
    rig *r = open_rig(21);
    (void)state;
    for (int c = 0; c < 300; c++) {
        unsigned char *memory = (unsigned char *)pzs_loop_find(&r->loop, &pzs_sensor_gate_block);
        const size_t bytes = PZS_SENSOR_GATE_BLOCK_BYTES(M, RELATIONS, MOST);
        for (size_t i = 0; i < bytes; i++)
            memory[i] = (unsigned char)uniform(&r->seed, 0, 256);
        for (int t = 0; t < 2; t++) {
            assert_false(PZS_IS_ERROR(tick(r)));
            for (int k = 0; k < N; k++)
                assert_true(fabs((double)r->loop.info.voltage[k]) <= 50);
        }
    }
    close_rig(r);
}

/* ---- wrong tables --------------------------------------------------------------- */

static void expect(rig *r, pzs_status expected, int where)
{
    assert_int_equal(start(r), expected);
    assert_int_equal(r->loop.info.where, where);
    assert_ptr_equal(r->loop.info.block, &pzs_sensor_gate_block);
    free(r->work);
    make_tables(r, 23);
}

static void wrong_tables_are_refused(void **state)
{
    rig *r = calloc(1, sizeof *r);
    (void)state;
    make_tables(r, 23);
    r->gate.scene = SCENE + 1;
    expect(r, PZS_E_FORMAT, -1);
    r->gate.sensors = M - 1;
    expect(r, PZS_E_ARGUMENT, -1);
    r->gate.relations = M;
    expect(r, PZS_E_ARGUMENT, -1);
    r->gate.quick = 0;
    expect(r, PZS_E_ARGUMENT, -1);
    r->gate.quick = RELATIONS + 1;
    expect(r, PZS_E_ARGUMENT, -1);
    r->gate.quiet = (pzs_real)NAN;
    expect(r, PZS_E_ARGUMENT, -1);
    r->gate.most = 0;
    expect(r, PZS_E_ARGUMENT, -1);
    r->gate.most = PZS_SENSOR_GATE_LIMIT + 1;
    expect(r, PZS_E_ARGUMENT, -1);
    r->gate.patience = 0;
    expect(r, PZS_E_ARGUMENT, -1);
    r->gate.ratio = (pzs_real)NAN;
    expect(r, PZS_E_ARGUMENT, -1);
    r->range[5] = 0;
    expect(r, PZS_E_ARGUMENT, 5);
    r->range[6] = (pzs_real)NAN;
    expect(r, PZS_E_ARGUMENT, 6);
    r->scale[7] = -1;
    expect(r, PZS_E_ARGUMENT, 7);
    r->threshold[8] = 0;
    expect(r, PZS_E_ARGUMENT, 8);
    r->parity[9] = (pzs_real)NAN;
    expect(r, PZS_E_NONFINITE, -1);
    assert_int_equal(start(r), PZS_OK);
    r->scale[2] *= PZS_R(1.1);
    assert_int_equal(start_loop(&r->loop, r->block, 2, &r->work), PZS_E_CRC);
    r->gate.parity = NULL;
    assert_int_equal(pzs_sensor_gate_seal(&r->gate), PZS_E_ARGUMENT);
    assert_int_equal(pzs_sensor_gate_seal(NULL), PZS_E_ARGUMENT);
    close_rig(r);
}

/* A table that is damaged while the loop runs is found by the checksum of its arrays. */
static void damaged_tables_are_found(void **state)
{
    rig *r = open_rig(25);
    pzs_status status = PZS_OK;
    (void)state;
    r->range[2] += PZS_R(0.25);
    for (int t = 0; t < 2000 && status != PZS_E_CRC; t++)
        status = tick(r);
    assert_int_equal(status, PZS_E_CRC);
    assert_ptr_equal(r->loop.info.block, &pzs_sensor_gate_block);
    close_rig(r);
}

/* ---- for numpy -------------------------------------------------------------------- */

static void write_doubles(const pzs_real *value, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const double written = (double)value[i];
        (void)fwrite(&written, sizeof written, 1, dump);
    }
}

/* Write readings, their states and what the gate passes on. */
static void write_tick(const rig *r)
{
    for (int i = 0; i < M && dump; i++) {
        const double states = reading_state(r, i);
        write_doubles(&r->readings[i], 1);
        (void)fwrite(&states, sizeof states, 1, dump);
        write_doubles(&state_of(r)->gated[i], 1);
    }
}

/* Write the tables, then for each tick the readings, the states and what the gate passes on. */
static void random_readings(void **state)
{
    rig *r = open_rig(27);
    const double counts[] = {M, N, RELATIONS, QUICK, MOST, 7, (double)PZS_EPSILON, CASES};
    (void)state;
    if (dump) {
        (void)fwrite(counts, sizeof counts, 1, dump);
        write_doubles(r->problem.influence, M * N);
        write_doubles(r->parity, M * RELATIONS);
        write_doubles(r->threshold, M);
    }
    for (int c = 0; c < CASES; c++) {
        assert_int_equal(start(r), PZS_OK);
        set_errors(r, c % (MOST + 3), pow(10, uniform(&r->seed, 0, 2.5)) * threshold);
        for (int i = 0; i < M && c % 5 == 0; i++)
            r->error[i] += 2 * threshold * exp(-0.02 * pow(i - c % M, 2));
        for (int t = 0; t < LOGGED; t++) {
            read_sensors(r, noise);
            if (c % 3 == 0)
                r->readings[c % M] = (pzs_real)NAN;
            (void)pzs_loop_tick(&r->loop, r->wanted, r->readings);
            write_tick(r);
        }
    }
    close_rig(r);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(healthy_loops_keep_their_bits),
        cmocka_unit_test(wrong_sensors_are_named_and_replaced),
        cmocka_unit_test(silent_sensors_are_replaced),
        cmocka_unit_test(ranges_are_kept),
        cmocka_unit_test(a_gate_may_have_ranges_only),
        cmocka_unit_test(gated_readings_may_be_missing),
        cmocka_unit_test(repaired_sensors_are_trusted_again),
        cmocka_unit_test(too_many_wrong_sensors_gate_none),
        cmocka_unit_test(sensors_fail_one_after_the_other),
        cmocka_unit_test(drifting_and_noisy_sensors_are_found),
        cmocka_unit_test(unknown_loads_gate_nothing),
        cmocka_unit_test(noise_gates_nothing),
        cmocka_unit_test(damaged_memory_heals),
        cmocka_unit_test(wrong_tables_are_refused),
        cmocka_unit_test(damaged_tables_are_found),
        cmocka_unit_test(random_readings),
    };
    cmocka_set_message_output(CM_OUTPUT_TAP);
    dump = argc > 1 ? fopen(argv[1], "wb") : NULL;
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    if (dump)
        (void)fclose(dump);
    return failed;
}
