/*
 * The heartbeat of the control loop, with which a program kicks a hardware watchdog: one for each
 * tick in order, none for each failure, with and without a supervisor.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <cmocka.h>

enum { N = 4, M = 9, TIMEOUT = 5, RAMP = 6, ALARM = 20 };
enum { MOST_INPUTS = N, MOST_OUTPUTS = M };

#include "../rigs/problem_rig.h"

/* A block that looks for a heartbeat in the middle of a tick, and fails in the ways of its tables.
 */
typedef struct failure {
    pzs_loop *loop;
    pzs_status status; /* status that the block returns */
    bool damages;      /* whether the block damages a voltage */
    int looks_left;    /* number of ticks in which the block takes a heartbeat */
    int found;         /* number of heartbeats that the block has taken */
} failure;

/* The block type has const tables, so that they name the failure by its address. */
static pzs_status fail_tick(void *self, pzs_loop_signals *signals)
{
    failure *told = *(failure *const *)signals->tables;
    (void)self;
    if (told->looks_left > 0) {
        told->looks_left--;
        told->found += pzs_loop_take_heartbeat(told->loop);
    }
    if (told->damages)
        signals->control->state.voltage[1] = (pzs_real)NAN;
    return told->status;
}

static const pzs_block_type failing_block = {"failing", PZS_PHASE_VOLTAGE, no_bytes,
                                             no_init,   fail_tick,         NULL};

typedef struct rig {
    unsigned seed;
    failure failure, *failure_address;
    problem_rig problem;
    pzs_supervision supervision;
    pzs_real park[N], target[M], measured[M];
    pzs_block block[3];
    size_t blocks;
    pzs_loop loop;
    double work[2000];
} rig;

static pzs_status init(rig *r)
{
    return pzs_loop_init(&r->loop, r->block, r->blocks, NULL, r->work, sizeof r->work);
}

/* A loop parked at 0 V, with or without a supervisor. */
static void open_rig(rig *r, bool is_supervised)
{
    memset(r, 0, sizeof *r);
    r->seed = 7;
    problem_open(&r->problem, N, M, -100, 100, 20);
    fill_random(&r->seed, r->problem.influence, N * M, 1e-6);
    for (int i = 0; i < M; i++)
        for (int j = 0; j < N; j++)
            r->target[i] += r->problem.influence[i * N + j] * (pzs_real)(j % 2 ? 50 : -50);
    problem_seal(&r->problem);
    r->supervision = (pzs_supervision){.scene = SCENE,
                                       .inputs = N,
                                       .timeout = TIMEOUT,
                                       .ramp_ticks = RAMP,
                                       .alarm_ticks = ALARM,
                                       .polarity_ticks = ALARM,
                                       .park = r->park,
                                       .fading = PZS_R(0.98),
                                       .load = PZS_R(1e-3)};
    assert_int_equal(pzs_supervision_seal(&r->supervision), PZS_OK);
    r->failure.loop = &r->loop;
    r->failure_address = &r->failure;
    r->block[0] = (pzs_block){&pzs_step_block, &r->problem.tables};
    r->block[1] = (pzs_block){&failing_block, &r->failure_address};
    r->block[2] = (pzs_block){&pzs_supervisor_block, &r->supervision};
    r->blocks = is_supervised ? 3 : 2;
    assert_int_equal(init(r), PZS_OK);
}

/* One tick with noisy readings of a plant that is the model. */
static pzs_status tick(rig *r)
{
    for (int i = 0; i < M; i++) {
        double sum = uniform(&r->seed, -1e-9, 1e-9);
        for (int j = 0; j < N; j++)
            sum += (double)r->problem.influence[i * N + j] * (double)r->loop.info.voltage[j];
        r->measured[i] = (pzs_real)sum;
    }
    return pzs_loop_tick(&r->loop, r->target, r->measured);
}

static pzs_status tick_without(rig *r, const pzs_real *readings)
{
    return pzs_loop_tick(&r->loop, r->target, readings);
}

/* Take the heartbeat of the last tick, which may be one only. */
static bool is_alive(rig *r)
{
    const bool was_alive = pzs_loop_take_heartbeat(&r->loop);
    assert_false(pzs_loop_take_heartbeat(&r->loop));
    return was_alive;
}

/* Ticks in order, until the loop is in control. */
static void run_in_order(rig *r)
{
    for (int k = 0; k < 30; k++) {
        const pzs_status status = tick(r);
        assert_true(status == PZS_OK || (status == PZS_W_PARKED && r->blocks == 3 && k < 3));
        assert_true(is_alive(r));
    }
}

/* Law: a tick in order makes one heartbeat, which waits for the program; two ticks make one. */
static void test_one_for_each_tick(void **state)
{
    static rig r;
    (void)state;
    for (int supervised = 0; supervised < 2; supervised++) {
        open_rig(&r, supervised);
        assert_false(is_alive(&r));
        run_in_order(&r);
        (void)tick(&r);
        (void)tick(&r);
        assert_true(is_alive(&r));
        (void)tick(&r);
        assert_int_equal(init(&r), PZS_OK);
        assert_false(is_alive(&r));
    }
    assert_false(pzs_loop_take_heartbeat(NULL));
}

/* Law: a tick that has begun and not ended leaves no heartbeat, not even the last tick's. */
static void test_hang(void **state)
{
    static rig r;
    (void)state;
    open_rig(&r, false);
    run_in_order(&r);
    r.failure.looks_left = 10;
    for (int k = 0; k < 10; k++)
        assert_int_equal(tick(&r), PZS_OK);
    assert_int_equal(r.failure.looks_left, 0);
    assert_int_equal(r.failure.found, 0);
    assert_true(is_alive(&r));
}

/* Law: neither a loop that is not initialised nor a refused tick makes a heartbeat. */
static void test_refused(void **state)
{
    static rig r;
    (void)state;
    open_rig(&r, false);
    assert_int_equal(pzs_loop_tick(&r.loop, NULL, NULL), PZS_E_ARGUMENT);
    assert_false(is_alive(&r));
    (void)tick(&r);
    assert_int_equal(pzs_loop_init(&r.loop, r.block, 2, NULL, r.work, 8), PZS_E_WORKSPACE);
    assert_false(is_alive(&r));
    assert_int_equal(tick_without(&r, NULL), PZS_E_STAGE);
    assert_false(is_alive(&r));
}

/* Law: no heartbeat of a tick with an error or with a voltage that the last gate had to correct. */
static void test_failing_ticks(void **state)
{
    static rig r;
    (void)state;
    open_rig(&r, false);
    run_in_order(&r);
    r.failure.status = PZS_E_CONDITION;
    assert_int_equal(tick(&r), PZS_E_CONDITION);
    assert_false(is_alive(&r));
    r.failure = (failure){.loop = &r.loop, .damages = true};
    assert_int_equal(tick(&r), PZS_W_OUTPUT);
    assert_false(is_alive(&r));
    r.failure.damages = false;
    assert_int_equal(tick(&r), PZS_OK);
    assert_true(is_alive(&r));
}

/*
 * Law: without a supervisor no heartbeat while no reading is usable or the target is not finite,
 * also where another warning hides PZS_W_HELD; one without readings, in a loop without sensors.
 */
static void test_held(void **state)
{
    static rig r;
    pzs_real nothing[M];
    (void)state;
    fill_reals(nothing, M, (double)NAN);
    open_rig(&r, false);
    run_in_order(&r);
    assert_int_equal(tick_without(&r, NULL), PZS_OK);
    assert_true(is_alive(&r));
    assert_int_equal(tick_without(&r, nothing), PZS_W_HELD);
    assert_false(is_alive(&r));
    r.failure.status = PZS_W_HELD; /* stands for an estimator; the step returns PZS_W_SENSOR */
    nothing[1] = 0;
    assert_int_equal(tick_without(&r, nothing), PZS_W_SENSOR);
    assert_false(is_alive(&r));
    r.failure.status = PZS_OK;
    assert_int_equal(tick_without(&r, nothing), PZS_W_SENSOR);
    assert_true(is_alive(&r));
    r.target[0] = (pzs_real)NAN;
    assert_int_equal(tick(&r), PZS_W_HELD);
    assert_false(is_alive(&r));
}

/* Ticks from a failure to the end: each has a heartbeat until the last, which is latched. */
static void follow_to_latched(rig *r, const pzs_real *readings)
{
    const uint32_t longest =
        TIMEOUT + pzs_supervisor_longest_ramp(&r->supervision, &r->problem.tables);
    uint32_t ticks = 0;
    pzs_status status = PZS_OK;
    while (status != PZS_E_LATCHED && ticks++ <= longest) {
        status = tick_without(r, readings);
        assert_true(is_alive(r) == (status != PZS_E_LATCHED));
    }
    assert_int_equal(status, PZS_E_LATCHED);
    for (int k = 0; k < 20; k++) {
        assert_int_equal(tick(r), PZS_E_LATCHED);
        assert_false(is_alive(r));
    }
}

/*
 * Law: with a supervisor NaN beyond the time-out, the command STOP and an error of a block keep the
 * heartbeat on the ramp to the park voltages, which is bounded, and end it there.
 */
static void test_latched(void **state)
{
    static rig r;
    pzs_real nothing[M];
    (void)state;
    fill_reals(nothing, M, (double)NAN);
    for (int way = 0; way < 3; way++) {
        open_rig(&r, true);
        run_in_order(&r);
        pzs_supervisor *supervisor = pzs_loop_find(&r.loop, &pzs_supervisor_block);
        if (way == 1)
            assert_int_equal(pzs_supervisor_give(supervisor, PZS_COMMAND_STOP), PZS_OK);
        r.failure.status = way == 2 ? PZS_E_NONFINITE : PZS_OK;
        follow_to_latched(&r, way == 0 ? nothing : r.measured);
    }
}

/* Law: parked voltages keep the heartbeat, for as long as the program wants. */
static void test_parked(void **state)
{
    static rig r;
    (void)state;
    open_rig(&r, true);
    run_in_order(&r);
    pzs_supervisor *supervisor = pzs_loop_find(&r.loop, &pzs_supervisor_block);
    assert_int_equal(pzs_supervisor_give(supervisor, PZS_COMMAND_PARK), PZS_OK);
    for (int k = 0; k < 100; k++) {
        assert_int_equal(tick(&r), PZS_W_PARKED);
        assert_true(is_alive(&r));
    }
}

/*
 * Law: damaged tables end the heartbeat within three readings of the tables, with and without a
 * supervisor, for good: also where the tables are whole again, and only pzs_loop_init changes that.
 */
static void test_damaged_tables(void **state)
{
    enum { LATEST = 3 * (sizeof(pzs_real) * (M * N + M + 4 * N) / 64 + 2) };
    static rig r;
    (void)state;
    for (int way = 0; way < 4; way++) {
        open_rig(&r, way % 2 == 1);
        run_in_order(&r);
        pzs_real *number = way < 2 ? &r.problem.weight[3] : &r.problem.upper[2];
        const pzs_real before = *number;
        int ticks = 0;
        *number += 1;
        do
            (void)tick(&r);
        while (is_alive(&r) && ticks++ < LATEST);
        assert_true(ticks < LATEST);
        for (int k = 0; k < LATEST; k++) {
            (void)tick(&r);
            *number = way < 2 && k > LATEST / 2 ? before : *number;
            assert_false(is_alive(&r));
        }
        *number = before;
        assert_int_equal(init(&r), PZS_OK);
        run_in_order(&r);
    }
}

/* Law: no flipped bit of the word that holds the heartbeat makes one that was not there. */
static void test_flipped_bits(void **state)
{
    static rig r;
    (void)state;
    for (int bit = 0; bit < 32; bit++) {
        open_rig(&r, false);
        run_in_order(&r);
        r.loop.state.heartbeat ^= 1u << bit;
        assert_false(is_alive(&r));
        (void)tick(&r);
        assert_false(is_alive(&r));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_one_for_each_tick),
                                       cmocka_unit_test(test_hang),
                                       cmocka_unit_test(test_refused),
                                       cmocka_unit_test(test_failing_ticks),
                                       cmocka_unit_test(test_held),
                                       cmocka_unit_test(test_latched),
                                       cmocka_unit_test(test_parked),
                                       cmocka_unit_test(test_damaged_tables),
                                       cmocka_unit_test(test_flipped_bits)};
    return cmocka_run_group_tests_name("heartbeat", tests, NULL, NULL);
}
