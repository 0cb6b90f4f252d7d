/*
 * The last gate of a loop: voltages that were damaged after they had been chosen, limits and tables
 * that were damaged in flash, frames that a reader takes at any time.
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
#include "../rigs/damage_block.h"
#include "../../lib/control/scrub.h"
#include "../../lib/core/guard.h"

enum { N = 5, M = 12 };
enum { MOST_INPUTS = N, MOST_OUTPUTS = M };

#include "../rigs/problem_rig.h"

#define LIMIT 100
#define STEP 8

/* What a block of this test does to the voltages after they have been chosen. */
typedef struct damage {
    bool is_due;
    int input;
    pzs_real voltage;
} damage;

typedef struct rig {
    unsigned seed;
    damage damage;
    problem_rig problem;
    pzs_real wanted[M], given[N];
    pzs_block block[2];
    pzs_loop loop;
    double work[2000];
} rig;

static pzs_status do_damage(void *self, pzs_loop_signals *signals)
{
    const damage *d = signals->tables;
    (void)self;
    if (d->is_due)
        signals->control->state.voltage[d->input] = d->voltage;
    return PZS_OK;
}

static const pzs_block_type damage_block = {"damage",    PZS_PHASE_VOLTAGE, damage_bytes,
                                            damage_init, do_damage,         NULL};

static void open_rig(rig *r, unsigned seed)
{
    memset(r, 0, sizeof *r);
    r->seed = seed;
    problem_open(&r->problem, N, M, -LIMIT, LIMIT, STEP);
    for (int i = 0; i < M; i++) {
        for (int j = 0; j < N; j++) {
            r->problem.influence[i * N + j] = (pzs_real)uniform(&r->seed, -1e-6, 1e-6);
            r->wanted[i] += r->problem.influence[i * N + j] * (pzs_real)(j % 2 ? 50 : -70);
        }
    }
    problem_seal(&r->problem);
    r->block[0] = (pzs_block){&pzs_step_block, &r->problem.tables};
    r->block[1] = (pzs_block){&damage_block, &r->damage};
    assert_int_equal(pzs_loop_init(&r->loop, r->block, 2, NULL, r->work, sizeof r->work), PZS_OK);
}

/* One tick; the voltages must keep limits and step limits but for input `exempt`. */
static pzs_status tick(rig *r, int exempt)
{
    const pzs_status status = pzs_loop_tick(&r->loop, r->wanted, NULL);
    const pzs_real *voltage = r->loop.info.voltage;
    for (int j = 0; j < N; j++) {
        const pzs_real v = voltage[j];
        assert_true(isfinite(v) && v >= r->problem.lower[j] && v <= r->problem.upper[j]);
        assert_true(j == exempt || (v < r->given[j] ? r->given[j] - v : v - r->given[j]) <= STEP);
        r->given[j] = v;
    }
    return status;
}

/* Law: a voltage that is not finite becomes the last one; one beyond a limit or step limit is cut
 * to it, the others stay as they are. The tick says where, and the loop then reaches its target all
 * the same.
 */
static void test_damaged_voltage(void **state)
{
    enum { CHANGES = 2 }; /* the last ones are changes of the voltage, inside the limits */
    static const double bad[] = {NAN,        HUGE_VAL,  -HUGE_VAL,   1e30,
                                 -LIMIT - 1, LIMIT + 1, 1.01 * STEP, -1.01 * STEP};
    const size_t count = sizeof bad / sizeof *bad;
    (void)state;
    for (size_t k = 0; k < count; k++) {
        static rig r;
        open_rig(&r, 1);
        for (int t = 0; t < 5; t++)
            assert_int_equal(tick(&r, -1), PZS_OK);
        const pzs_real before = r.given[3];
        const double damaged = k + CHANGES < count ? bad[k] : (double)before + bad[k];
        r.damage = (damage){true, 3, (pzs_real)damaged};
        assert_int_equal(tick(&r, -1), PZS_W_OUTPUT);
        assert_int_equal(r.loop.info.where, 3);
        const double moved = (double)(r.given[3] - before);
        const double expected = isfinite(bad[k]) ? copysign(STEP, bad[k]) : 0;
        assert_true(fabs(moved - expected) <= 2 * LIMIT * (double)PZS_EPSILON);
        r.damage.is_due = false;
        for (int t = 0; t < 40; t++)
            assert_int_equal(tick(&r, -1), PZS_OK);
        for (int j = 0; j < N; j++)
            assert_true(fabs((double)r.given[j] - (j % 2 ? 50 : -70)) <
                        LIMIT * (PZS_REAL_BITS == 32 ? 1e-3 : 1e-9));
    }
}

/* Law: a held input goes to its held voltage at once, and only there; released, it moves by steps.
 */
static void test_held(void **state)
{
    static rig r;
    (void)state;
    open_rig(&r, 2);
    for (int t = 0; t < 20; t++)
        assert_int_equal(tick(&r, -1), PZS_OK);
    assert_int_equal(pzs_hold(r.loop.info.control, 2, 1000), PZS_OK);
    (void)tick(&r, 2);
    assert_true(r.given[2] >= LIMIT && r.given[2] <= LIMIT);
    r.damage = (damage){true, 2, 0}; /* held elsewhere: cut to one step */
    assert_int_equal(tick(&r, -1), PZS_W_OUTPUT);
    assert_true(fabs((double)r.given[2] - (LIMIT - STEP)) <= 2 * LIMIT * (double)PZS_EPSILON);
    r.damage.is_due = false;
    (void)tick(&r, 2);
    assert_true(r.given[2] >= LIMIT);
    assert_int_equal(pzs_release(r.loop.info.control, 2), PZS_OK);
    for (int t = 0; t < 40; t++)
        assert_int_equal(tick(&r, -1), PZS_OK);
    assert_true(fabs((double)r.given[2] + 70) < LIMIT * 1e-3);
}

/* Law: a damaged limit ends the tick at once with CRC, at the voltages of the tick before. */
static void test_damaged_limits(void **state)
{
    static rig r;
    (void)state;
    for (int k = 0; k < 3; k++) {
        open_rig(&r, 3);
        assert_int_equal(tick(&r, -1), PZS_OK);
        pzs_real *const table[3] = {r.problem.lower, r.problem.upper, r.problem.step_limit};
        const uint32_t frames = r.loop.info.frames;
        table[k][1] *= 2;
        assert_int_equal(pzs_loop_tick(&r.loop, r.wanted, NULL), PZS_E_CRC);
        assert_memory_equal(r.loop.info.voltage, r.given, sizeof r.given);
        assert_int_equal(r.loop.info.frames, frames);
        table[k][1] /= 2;
        assert_int_equal(tick(&r, -1), PZS_OK);
    }
}

/* Law: any other damaged table is found after at most three rounds of the scrub. */
static void test_damaged_tables(void **state)
{
    (void)state;
    for (int k = 0; k < 3; k++) {
        static rig r;
        open_rig(&r, 4);
        pzs_real *const table[3] = {r.problem.influence, r.problem.weight,
                                    r.problem.reference_voltage};
        const int bytes = (M * N + M + 4 * N + 1) * (int)sizeof(pzs_real) + 4;
        const int round = bytes / (int)SCRUB_BYTES + 1;
        for (int t = 0; t < 3 * round; t++)
            assert_int_equal(tick(&r, -1), PZS_OK);
        table[k][2] += PZS_R(1e-3);
        int ticks = 0;
        while (pzs_loop_tick(&r.loop, r.wanted, NULL) != PZS_E_CRC && ticks <= 3 * round)
            ticks++;
        assert_in_range(ticks, round, 3 * round);
    }
}

/* Law: an influence matrix that was computed on the device is scrubbed as well. */
static void test_damaged_device_influence(void **state)
{
    static rig r;
    pzs_real own[M * N];
    (void)state;
    open_rig(&r, 5);
    memcpy(own, r.problem.influence, sizeof own);
    assert_int_equal(pzs_loop_init(&r.loop, r.block, 2, own, r.work, sizeof r.work), PZS_OK);
    for (int t = 0; t < 100; t++)
        assert_int_equal(tick(&r, -1), PZS_OK);
    own[7] += PZS_R(1e-3);
    int ticks = 0;
    while (pzs_loop_tick(&r.loop, r.wanted, NULL) != PZS_E_CRC && ticks < 100)
        ticks++;
    assert_true(ticks < 100);
}

/* Law: the frame of a tick stays as it is during the next tick, and pzs_loop_voltages copies the
 * newest one. */
static void test_frames(void **state)
{
    static rig r;
    pzs_real copy[N];
    (void)state;
    open_rig(&r, 6);
    for (uint32_t t = 1; t < 10; t++) {
        const pzs_real *before = r.loop.info.voltage;
        memcpy(copy, before, sizeof copy);
        assert_int_equal(tick(&r, -1), PZS_OK);
        assert_memory_equal(before, copy, sizeof copy);
        assert_true(r.loop.info.voltage != before);
        assert_int_equal(r.loop.info.frames, t + 1);
        assert_int_equal(pzs_loop_voltages(&r.loop, copy), PZS_OK);
        assert_memory_equal(copy, r.loop.info.voltage, sizeof copy);
    }
    assert_int_equal(pzs_loop_voltages(NULL, copy), PZS_E_ARGUMENT);
    assert_int_equal(pzs_loop_voltages(&r.loop, NULL), PZS_E_ARGUMENT);
    static const pzs_loop none;
    assert_int_equal(pzs_loop_voltages(&none, copy), PZS_E_STAGE);
}

/* Law: two of three copies outvote the third, whichever bit of it has flipped. */
static void test_vote(void **state)
{
    uint32_t copy[3][2] = {{0x12345678u, 0xFFFF0000u}, {0, 0}, {0, 0}};
    const uint32_t right[2] = {copy[0][0], copy[0][1]};
    (void)state;
    for (int bit = 0; bit < 64; bit++)
        for (int k = 0; k < 3; k++) {
            for (int i = 0; i < 3; i++)
                memcpy(copy[i], right, sizeof right);
            copy[k][bit / 32] ^= 1u << bit % 32;
            pzs_guard_vote(copy[0], copy[1], copy[2], sizeof right);
            for (int i = 0; i < 3; i++)
                assert_memory_equal(copy[i], right, sizeof right);
        }
}

/*
 * Law: tables whose numbers of entries are beyond what their structure allows are refused before a
 * checksum reads them: a seal cannot make them valid, and no init accepts them by a checksum that
 * was not computed.
 */
static void test_damaged_lengths(void **state)
{
    static const uint32_t good[2] = {0, 1}, bad[2] = {0, 1000000};
    static const uint16_t index[1] = {0};
    static const uint8_t open[1] = {0};
    static const pzs_real value[1] = {1};
    pzs_structure structure = {.nodes = 4, .elements = 1, .types = 1, .dof_per_node = 7};
    structure.free_dof = 4;
    structure.input = (pzs_rows){1, good, index, value};
    (void)state;
    assert_int_equal(pzs_structure_seal(&structure), PZS_OK);
    structure.output = (pzs_rows){1, bad, index, value};
    assert_int_equal(pzs_structure_seal(&structure), PZS_E_ARGUMENT);
    structure.output = (pzs_rows){0, NULL, NULL, NULL};
    pzs_electrodes electrodes = {.count = 1, .input = index, .open = open};
    electrodes.direct = (pzs_rows){1, good, index, value};
    assert_int_equal(pzs_electrodes_seal(&electrodes, &structure), PZS_OK);
    electrodes.direct.start = bad;
    assert_int_equal(pzs_electrodes_seal(&electrodes, &structure), PZS_E_ARGUMENT);
    pzs_nonlinear nonlinear = {.prescribed = {.count = 0}};
    assert_int_equal(pzs_nonlinear_seal(&nonlinear, &structure), PZS_OK);
    nonlinear.prescribed.count = 5; /* of four free dof */
    assert_int_equal(pzs_nonlinear_seal(&nonlinear, &structure), PZS_E_ARGUMENT);
    nonlinear.prescribed.count = 0;
    nonlinear.resultants.start = bad;
    assert_int_equal(pzs_nonlinear_seal(&nonlinear, &structure), PZS_E_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_damaged_voltage),
                                       cmocka_unit_test(test_held),
                                       cmocka_unit_test(test_damaged_limits),
                                       cmocka_unit_test(test_damaged_tables),
                                       cmocka_unit_test(test_damaged_device_influence),
                                       cmocka_unit_test(test_frames),
                                       cmocka_unit_test(test_vote),
                                       cmocka_unit_test(test_damaged_lengths)};
    return cmocka_run_group_tests_name("output_gate", tests, NULL, NULL);
}
