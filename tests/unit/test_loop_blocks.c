/*
 * The control loop as a list of blocks: the bits of the calls made by hand, whatever options are in
 * the list; lists that are refused, by name; blocks that fail; a block of this test's own.
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

enum { N = 7, M = 30, K = 5, LOADS = 3, DELAY = 0, LATE = 2, TICKS = 120, AMPLITUDE = 3 };
enum { MOST_INPUTS = N, MOST_OUTPUTS = M };
enum { FEEDS = 1, ESTIMATES = 2, QUANTISES = 4, DETECTS = 8, OPTIONS = 16 };

#include "../rigs/problem_rig.h"

/* Tables of every block, and a plant that is weaker than they say. */
typedef struct rig {
    problem_rig problem;
    pzs_estimator estimator;
    pzs_feed_forward_table on_shape, on_readings;
    pzs_known_loads known;
    pzs_amplifier amplifier;
    pzs_fault_detection detection;
    pzs_real direct[K * N], gain[M * K], by_load[M * LOADS], seen[K * LOADS];
    pzs_real wanted[M], measured[M], sensed[K], now[LOADS], next[LOADS];
    pzs_block block[PZS_BLOCK_LIMIT];
    size_t count;
    pzs_loop loop;
    void *work;
    unsigned seed;
} rig;

static void make_tables(rig *r)
{
    fill_random(&r->seed, r->problem.influence, M * N, 1e-6);
    fill_random(&r->seed, r->direct, K * N, 1);
    fill_random(&r->seed, r->gain, M * K, 1e-6);
    fill_random(&r->seed, r->by_load, M * LOADS, 1e-5);
    fill_random(&r->seed, r->seen, K * LOADS, 1);
    problem_open(&r->problem, N, M, -100, 100, 15);
    r->estimator = (pzs_estimator){0, SCENE, 0, N, M, K, r->direct, r->gain};
    r->on_shape = (pzs_feed_forward_table){0, SCENE, 0, LOADS, M, r->by_load};
    r->on_readings = (pzs_feed_forward_table){0, SCENE, 0, LOADS, K, r->seen};
    problem_seal(&r->problem);
    assert_int_equal(pzs_estimator_seal(&r->estimator), PZS_OK);
    assert_int_equal(pzs_feed_forward_seal(&r->on_shape), PZS_OK);
    assert_int_equal(pzs_feed_forward_seal(&r->on_readings), PZS_OK);
    r->amplifier = (pzs_amplifier){PZS_R(0.5), PZS_R(0.75)};
    r->detection = (pzs_fault_detection){DELAY, AMPLITUDE};
}

static void append(rig *r, const pzs_block_type *type, const void *tables)
{
    r->block[r->count++] = (pzs_block){type, tables};
}

/* The blocks of a set of options. */
static void list(rig *r, int options)
{
    r->count = 0;
    r->known.shape = &r->on_shape;
    r->known.readings = options & ESTIMATES ? &r->on_readings : NULL;
    if (options & FEEDS)
        append(r, &pzs_feed_forward_block, &r->known);
    if (options & ESTIMATES)
        append(r, &pzs_estimator_block, &r->estimator);
    append(r, &pzs_step_block, &r->problem.tables);
    if (options & QUANTISES)
        append(r, &pzs_amplifier_block, &r->amplifier);
    if (options & DETECTS)
        append(r, &pzs_fault_detector_block, &r->detection);
}

static void rig_open(rig *r, unsigned seed)
{
    memset(r, 0, sizeof *r);
    r->seed = seed;
    make_tables(r);
    list(r, 0);
}

static void rig_close(rig *r)
{
    free(r->work);
}

/* The bytes that the macros say, for the list of options. */
static size_t bytes_of(int options, int delay)
{
    const int readings = options & ESTIMATES ? K : M;
    const int blocks = 1 + !!(options & FEEDS) + !!(options & ESTIMATES) + !!(options & QUANTISES) +
                       !!(options & DETECTS);
    return PZS_LOOP_BYTES(blocks, N) + PZS_STEP_BLOCK_BYTES(N, M) +
           (options & FEEDS ? PZS_FEED_FORWARD_BLOCK_BYTES(readings, M) : 0) +
           (options & ESTIMATES ? PZS_ESTIMATOR_BLOCK_BYTES(K, M) : 0) +
           (options & QUANTISES ? PZS_AMPLIFIER_BLOCK_BYTES(N) : 0) +
           (options & DETECTS ? PZS_FAULT_DETECTOR_BLOCK_BYTES(N, M, delay) : 0);
}

static pzs_status start(rig *r)
{
    return start_loop(&r->loop, r->block, r->count, &r->work);
}

/*
 * Target, loads and readings of a tick under voltages. Readings get lost from tick 30 to 39, one of
 * them or all; electrode 2 is dead from tick 40 on; noise, or every sensor would stand still.
 */
static void act(rig *r, const pzs_real *voltage, int tick)
{
    for (int l = 0; l < LOADS; l++) {
        r->now[l] = (pzs_real)(tick > 20 + 5 * l);
        r->next[l] = (pzs_real)(tick > 19 + 5 * l);
    }
    for (int i = 0; i < M; i++) {
        r->wanted[i] = (pzs_real)((i - 10) * 1e-6 * ((tick % 24) / 12 == 0 ? 2 : -2));
        r->measured[i] = (pzs_real)uniform(&r->seed, -1e-8, 1e-8);
        for (int k = 0; k < N; k++)
            if (k != 2 || tick < 40)
                r->measured[i] += PZS_R(0.8) * r->problem.influence[i * N + k] * voltage[k];
        for (int l = 0; l < LOADS; l++)
            r->measured[i] += r->by_load[i * LOADS + l] * r->now[l];
    }
    for (int s = 0; s < K; s++) {
        r->sensed[s] = (pzs_real)uniform(&r->seed, -1e-3, 1e-3);
        for (int k = 0; k < N; k++)
            if (k != 2 || tick < 40)
                r->sensed[s] += PZS_R(0.8) * r->direct[s * N + k] * voltage[k];
        for (int l = 0; l < LOADS; l++)
            r->sensed[s] += r->seen[s * LOADS + l] * r->now[l];
        if (tick >= 30 && tick < 40 && (s == 0 || tick >= 35))
            r->sensed[s] = (pzs_real)NAN;
    }
    for (int i = 0; i < M && tick >= 30 && tick < 40; i++)
        if (i == 0 || tick >= 35)
            r->measured[i] = (pzs_real)NAN;
}

/* ---- the calls made by hand ------------------------------------------- */

typedef struct hand {
    pzs_control control;
    pzs_estimate estimate;
    pzs_fault_detector detector;
    pzs_real given[N], shape[M], wanted[M], readings[M];
    void *control_work, *estimate_work, *detector_work;
} hand;

static void hand_open(hand *h, const rig *r)
{
    memset(h, 0, sizeof *h);
    h->control_work = malloc(PZS_CONTROL_BYTES(N, M));
    h->estimate_work = malloc(PZS_ESTIMATE_BYTES(K));
    h->detector_work = malloc(PZS_FAULT_DETECTOR_BYTES(N, M, DELAY));
    assert_int_equal(pzs_control_init(&h->control, &r->problem.tables, NULL, h->control_work,
                                      PZS_CONTROL_BYTES(N, M)),
                     PZS_OK);
    assert_int_equal(pzs_estimate_init(&h->estimate, &h->control, &r->estimator, h->estimate_work,
                                       PZS_ESTIMATE_BYTES(K)),
                     PZS_OK);
    assert_int_equal(pzs_fault_detector_init(&h->detector, &h->control, DELAY, h->detector_work,
                                             PZS_FAULT_DETECTOR_BYTES(N, M, DELAY)),
                     PZS_OK);
    memcpy(h->given, h->control.info.voltage, sizeof h->given);
    for (int k = 0; k < N; k++)
        h->detector.settings.amplitude[k] = AMPLITUDE;
}

static void hand_close(hand *h)
{
    free(h->control_work);
    free(h->estimate_work);
    free(h->detector_work);
}

/* One tick by hand. Returns the status by the loop's precedence. frame: there are readings. */
static pzs_status hand_tick(hand *h, const rig *r, int options, int frame)
{
    const pzs_real *readings = options & ESTIMATES ? r->sensed : r->measured;
    const size_t count = options & ESTIMATES ? K : M;
    pzs_status seen = PZS_OK, found = PZS_OK;
    memcpy(h->wanted, r->wanted, sizeof h->wanted);
    memcpy(h->readings, readings, count * sizeof *readings);
    const pzs_real *measured = frame ? h->readings : NULL;
    if (options & FEEDS) {
        const pzs_feed_forward_table *table = options & ESTIMATES ? &r->on_readings : &r->on_shape;
        assert_int_equal(pzs_feed_forward(table, r->now, h->readings), PZS_OK);
        assert_int_equal(pzs_feed_forward(&r->on_shape, r->next, h->wanted), PZS_OK);
    }
    if (frame && options & ESTIMATES) {
        seen = pzs_estimate_tick(&h->estimate, h->readings, h->shape);
        measured = h->shape;
    }
    const pzs_status stepped = pzs_tick(&h->control, h->wanted, measured);
    if (options & QUANTISES)
        assert_int_equal(
            pzs_quantise(&h->control, h->given, r->amplifier.step, r->amplifier.dead_band), PZS_OK);
    if (options & DETECTS)
        found = pzs_fault_detector_tick(&h->detector, measured);
    if (stepped != PZS_OK)
        return stepped;
    return seen != PZS_OK ? seen : found;
}

/* Law: a list of any options gives the bits of the calls made by hand in every tick: voltages,
 * status, shape, states of electrodes; with the step alone those of pzs_tick. */
static void test_same_bits(void **state)
{
    (void)state;
    for (int options = 0; options < OPTIONS; options++) {
        static rig r;
        static hand h;
        int found = 0, warned = 0;
        rig_open(&r, 3);
        list(&r, options);
        hand_open(&h, &r);
        assert_int_equal(start(&r), PZS_OK);
        assert_memory_equal(r.loop.info.voltage, h.control.info.voltage, N * sizeof(pzs_real));
        if (options & FEEDS)
            assert_int_equal(pzs_loop_know(&r.loop, r.now, r.next), PZS_OK);
        for (int tick = 0; tick < TICKS; tick++) {
            const int frame = tick % 11 != 7;
            act(&r, h.control.info.voltage, tick);
            const pzs_real *readings = options & ESTIMATES ? r.sensed : r.measured;
            const pzs_status by_hand = hand_tick(&h, &r, options, frame);
            const pzs_status status = pzs_loop_tick(&r.loop, r.wanted, frame ? readings : NULL);
            assert_int_equal(status, by_hand);
            assert_memory_equal(r.loop.info.voltage, h.control.info.voltage, N * sizeof(pzs_real));
            assert_true((status == PZS_OK) == (r.loop.info.block == NULL));
            if (options & DETECTS)
                assert_memory_equal(r.loop.info.electrode, h.detector.info.electrode, N);
            if (frame && options & ESTIMATES)
                assert_memory_equal(r.loop.info.measured, h.shape, sizeof h.shape);
            warned += status == PZS_W_HELD || status == PZS_W_SENSOR;
        }
        for (int k = 0; k < N; k++)
            found += options & DETECTS && r.loop.info.electrode[k] == PZS_ELECTRODE_HELD;
        assert_in_range(warned, 5, 10); /* a lost frame counts for none of the ten lost readings */
        assert_true(!(options & DETECTS) == (r.loop.info.electrode == NULL));
        if (options == (FEEDS | DETECTS))
            assert_int_equal(found, 1); /* electrode 2, from the shape measured at all outputs */
        hand_close(&h);
        rig_close(&r);
    }
}

/* ---- lists that are refused -------------------------------------------- */

static void refused(rig *r, pzs_status status, const char *name, int32_t where)
{
    assert_int_equal(start(r), status);
    if (name == NULL)
        assert_null(r->loop.info.block);
    else
        assert_string_equal(r->loop.info.block->name, name);
    assert_int_equal(r->loop.info.where, where);
    assert_int_equal(pzs_loop_tick(&r->loop, r->wanted, r->measured), PZS_E_STAGE);
    assert_null(pzs_loop_find(&r->loop, &pzs_step_block));
}

static void swap(rig *r, size_t a, size_t b)
{
    const pzs_block kept = r->block[a];
    r->block[a] = r->block[b];
    r->block[b] = kept;
}

/* Law: a block in the wrong place, twice, incomplete, missing, or too many of them are refused with
 * the name and the place of the block. */
static void test_wrong_lists(void **state)
{
    rig r;
    (void)state;
    rig_open(&r, 1);
    list(&r, FEEDS | ESTIMATES | QUANTISES | DETECTS);
    swap(&r, 0, 1);
    refused(&r, PZS_E_STAGE, "feed_forward", 1);
    list(&r, QUANTISES | DETECTS);
    swap(&r, 0, 1);
    refused(&r, PZS_E_STAGE, "step", 1);
    list(&r, QUANTISES);
    append(&r, &pzs_amplifier_block, &r.amplifier);
    refused(&r, PZS_E_ARGUMENT, "amplifier", 2);
    list(&r, 0);
    append(&r, &pzs_step_block, &r.problem.tables);
    refused(&r, PZS_E_ARGUMENT, "step", 1);
    list(&r, DETECTS);
    r.block[1].tables = NULL;
    refused(&r, PZS_E_ARGUMENT, "fault_detector", 1);
    r.block[1].type = NULL;
    refused(&r, PZS_E_ARGUMENT, NULL, 1);
    list(&r, ESTIMATES);
    r.count = 1;
    refused(&r, PZS_E_ARGUMENT, NULL, 1);
    r.count = 0;
    refused(&r, PZS_E_ARGUMENT, NULL, -1);
    r.count = PZS_BLOCK_LIMIT + 1;
    refused(&r, PZS_E_ARGUMENT, NULL, -1);
    assert_int_equal(pzs_loop_init(NULL, r.block, 1, NULL, &r, sizeof r), PZS_E_ARGUMENT);
    assert_int_equal(pzs_loop_init(&r.loop, NULL, 1, NULL, &r, sizeof r), PZS_E_ARGUMENT);
    list(&r, 0);
    assert_int_equal(pzs_loop_init(&r.loop, r.block, 1, NULL, NULL, sizeof r), PZS_E_ARGUMENT);
    rig_close(&r);
}

/* Law: tables of another scene, other counts, damaged or out of range are refused with the name of
 * their block. */
static void test_wrong_tables(void **state)
{
    static rig r;
    (void)state;
    rig_open(&r, 2);
    list(&r, FEEDS | ESTIMATES | QUANTISES | DETECTS);
    r.estimator.scene++;
    refused(&r, PZS_E_FORMAT, "estimator", -1);
    r.estimator.scene--;
    r.on_readings.scene++;
    refused(&r, PZS_E_FORMAT, "feed_forward", -1);
    r.on_readings.scene--;
    r.known.readings = &r.on_shape; /* of M rows for K sensors */
    refused(&r, PZS_E_ARGUMENT, "feed_forward", -1);
    r.known.shape = NULL;
    refused(&r, PZS_E_ARGUMENT, "feed_forward", -1);
    list(&r, FEEDS | ESTIMATES | QUANTISES | DETECTS);
    r.by_load[4] += 1;
    refused(&r, PZS_E_CRC, "feed_forward", -1);
    assert_int_equal(pzs_feed_forward_seal(&r.on_shape), PZS_OK);
    r.problem.influence[3] += 1;
    refused(&r, PZS_E_CRC, "step", -1);
    problem_seal(&r.problem);
    const pzs_real bad[] = {-1, (pzs_real)NAN, -(pzs_real)HUGE_VAL};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        r.amplifier.step = bad[i];
        refused(&r, PZS_E_ARGUMENT, "amplifier", -1);
        r.amplifier = (pzs_amplifier){0, bad[i]};
        refused(&r, PZS_E_ARGUMENT, "amplifier", -1);
        r.amplifier = (pzs_amplifier){0, 0};
        r.detection.amplitude = bad[i];
        refused(&r, PZS_E_ARGUMENT, "fault_detector", -1);
        r.detection.amplitude = 0;
    }
    r.detection.delay = PZS_DELAY_LIMIT + 1;
    refused(&r, PZS_E_ARGUMENT, "fault_detector", -1);
    r.detection.delay = 0;
    assert_int_equal(start(&r), PZS_OK);
    rig_close(&r);
}

/* Law: the macros give the bytes that a list needs; one byte less is refused with that number, and
 * an address that is aligned for pzs_real alone will do. */
static void test_workspace(void **state)
{
    static rig r;
    (void)state;
    rig_open(&r, 1);
    for (int options = 0; options < OPTIONS; options++) {
        r.detection.delay = options & FEEDS ? LATE : DELAY;
        const size_t need = bytes_of(options, r.detection.delay);
        pzs_real *work = malloc(need + sizeof *work);
        assert_non_null(work);
        list(&r, options);
        assert_int_equal(pzs_loop_init(&r.loop, r.block, r.count, NULL, work, need - 1),
                         PZS_E_WORKSPACE);
        assert_int_equal(r.loop.info.where, need);
        assert_int_equal(pzs_loop_init(&r.loop, r.block, r.count, NULL, work, need), PZS_OK);
        assert_int_equal(pzs_loop_init(&r.loop, r.block, r.count, NULL, work + 1, need), PZS_OK);
        assert_int_equal((uintptr_t)pzs_loop_find(&r.loop, &pzs_step_block) % 8, 0);
        act(&r, r.loop.info.voltage, 0);
        assert_int_equal(
            pzs_loop_tick(&r.loop, r.wanted, options & ESTIMATES ? r.sensed : r.measured), PZS_OK);
        assert_int_equal(pzs_loop_init(&r.loop, r.block, r.count, NULL, (char *)work + 1, need),
                         PZS_E_WORKSPACE);
        free(work);
    }
    rig_close(&r);
}

/* ---- a block of this test's own ---------------------------------------- */

/* Adds to the readings or to the voltages, or ends with a status, and counts its ticks. */
typedef struct probe_tables {
    pzs_real add;
    pzs_status status;
    int32_t where;
} probe_tables;

typedef struct probe {
    const probe_tables *tables;
    pzs_real shifted[M];
    int ticks;
    uint32_t sensors; /* number of readings of the loop, as the block is told at its start */
} probe;

static size_t probe_bytes(const void *tables, const pzs_problem *problem)
{
    (void)tables;
    assert_int_equal(problem->outputs, M);
    return sizeof(probe);
}

static pzs_status probe_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    probe *p = self;
    assert_int_equal((uintptr_t)self % 8, 0);
    assert_non_null(signals->control);
    memset(p, 0, sizeof *p);
    p->tables = tables;
    p->sensors = signals->sensors;
    return PZS_OK;
}

static pzs_status shift_readings(void *self, pzs_loop_signals *signals)
{
    probe *p = self;
    p->ticks++;
    for (int i = 0; i < M; i++)
        p->shifted[i] = signals->readings[i] + p->tables->add;
    signals->readings = signals->measured = p->shifted;
    signals->where = p->tables->where;
    return p->tables->status;
}

static pzs_status fail_tick(void *self, pzs_loop_signals *signals)
{
    probe *p = self;
    p->ticks++;
    signals->where = p->tables->where;
    return p->tables->status;
}

static const pzs_block_type shift_block = {"shift",    PZS_PHASE_READINGS, probe_bytes,
                                           probe_init, shift_readings,     NULL};
static const pzs_block_type late_block = {"late",     PZS_PHASE_OBSERVE, probe_bytes,
                                          probe_init, fail_tick,         NULL};
static const pzs_block_type early_block = {"early",    PZS_PHASE_READINGS, probe_bytes,
                                           probe_init, fail_tick,          NULL};

/* Law: a block that is not the library's takes part in the tick: readings that it shifts have the
 * effect of readings that are shifted. */
static void test_own_block(void **state)
{
    static rig r, other;
    const probe_tables shift = {PZS_R(2e-6), PZS_OK, -1};
    (void)state;
    rig_open(&r, 4);
    rig_open(&other, 4);
    assert_int_equal(start(&other), PZS_OK);
    r.count = 0;
    append(&r, &shift_block, &shift);
    append(&r, &pzs_step_block, &r.problem.tables);
    assert_int_equal(start(&r), PZS_OK);
    for (int tick = 0; tick < 20; tick++) {
        act(&r, r.loop.info.voltage, tick);
        assert_int_equal(pzs_loop_tick(&r.loop, r.wanted, r.measured), PZS_OK);
        for (int i = 0; i < M; i++)
            other.measured[i] = r.measured[i] + shift.add;
        assert_int_equal(pzs_loop_tick(&other.loop, r.wanted, other.measured), PZS_OK);
        assert_memory_equal(r.loop.info.voltage, other.loop.info.voltage, N * sizeof(pzs_real));
    }
    const probe *p = pzs_loop_find(&r.loop, &shift_block);
    assert_int_equal(p->ticks, 20);
    assert_ptr_equal(pzs_loop_find(&r.loop, &pzs_step_block), r.loop.info.control);
    assert_null(pzs_loop_find(&r.loop, &pzs_estimator_block));
    rig_close(&r);
    rig_close(&other);
}

/*
 * Law: a block that observes the loop starts with the number of readings of the loop: that of the
 * estimator's sensors, or of the outputs where every output is measured.
 */
static void test_observer_of_few(void **state)
{
    (void)state;
    for (int estimates = 0; estimates < 2; estimates++) {
        static rig r;
        const probe_tables tables = {0, PZS_OK, -1};
        rig_open(&r, 6);
        list(&r, estimates ? ESTIMATES : 0);
        append(&r, &late_block, &tables);
        assert_int_equal(start(&r), PZS_OK);
        const probe *p = pzs_loop_find(&r.loop, &late_block);
        assert_int_equal(p->sensors, estimates ? K : M);
        rig_close(&r);
    }
}

/* Law: a block that fails before or after the step leaves the voltages of the tick before, for the
 * program and for the controller, is named, and ends the tick; the next tick goes on from there. */
static void test_failing_block(void **state)
{
    static const pzs_block_type *const type[] = {&early_block, &late_block};
    (void)state;
    for (int i = 0; i < 2; i++) {
        static rig r;
        probe_tables tables = {0, PZS_OK, 5};
        pzs_real before[N];
        rig_open(&r, 5);
        r.count = 0;
        if (i == 0)
            append(&r, type[i], &tables);
        append(&r, &pzs_step_block, &r.problem.tables);
        append(&r, &pzs_amplifier_block, &r.amplifier);
        if (i == 1)
            append(&r, type[i], &tables);
        assert_int_equal(start(&r), PZS_OK);
        for (int tick = 0; tick < 20; tick++) {
            act(&r, r.loop.info.voltage, tick);
            memcpy(before, r.loop.info.voltage, sizeof before);
            tables.status = tick % 5 == 1 ? PZS_E_CONDITION : PZS_OK;
            assert_int_equal(pzs_loop_tick(&r.loop, r.wanted, r.measured), tables.status);
            if (tables.status == PZS_OK) {
                for (int k = 0; k < N; k++)
                    assert_true(fabs((double)(r.loop.info.voltage[k] - before[k])) <=
                                15 * (1 + 2 * (double)PZS_EPSILON));
                continue;
            }
            assert_memory_equal(r.loop.info.voltage, before, sizeof before);
            assert_memory_equal(r.loop.info.control->info.voltage, before, sizeof before);
            assert_ptr_equal(r.loop.info.block, type[i]);
            assert_int_equal(r.loop.info.where, 5);
        }
        assert_true(fabs((double)r.loop.info.voltage[0]) > 0);
        rig_close(&r);
    }
}

/* Law: a known load that is not finite ends the tick with its index, the voltages stay. */
static void test_bad_known_load(void **state)
{
    static rig r;
    pzs_real before[N];
    (void)state;
    rig_open(&r, 6);
    list(&r, FEEDS);
    assert_int_equal(start(&r), PZS_OK);
    act(&r, r.loop.info.voltage, 0);
    assert_int_equal(pzs_loop_tick(&r.loop, r.wanted, r.measured), PZS_OK);
    memcpy(before, r.loop.info.voltage, sizeof before);
    assert_int_equal(pzs_loop_know(&r.loop, r.now, r.next), PZS_OK);
    for (int i = 0; i < 2; i++) {
        act(&r, before, 1);
        (i == 0 ? r.now : r.next)[i + 1] = i == 0 ? (pzs_real)NAN : (pzs_real)HUGE_VAL;
        assert_int_equal(pzs_loop_tick(&r.loop, r.wanted, r.measured), PZS_E_NONFINITE);
        assert_ptr_equal(r.loop.info.block, &pzs_feed_forward_block);
        assert_int_equal(r.loop.info.where, i + 1);
        assert_memory_equal(r.loop.info.voltage, before, sizeof before);
    }
    rig_close(&r);
}

/* Law: the warning of the step counts most, then the first one of the list. */
static void test_precedence(void **state)
{
    static rig r;
    const probe_tables first = {0, PZS_W_SENSOR, 1}, last = {0, PZS_W_ELECTRODE, 2};
    (void)state;
    rig_open(&r, 7);
    r.count = 0;
    append(&r, &early_block, &first);
    append(&r, &pzs_step_block, &r.problem.tables);
    append(&r, &late_block, &last);
    assert_int_equal(start(&r), PZS_OK);
    act(&r, r.loop.info.voltage, 0);
    assert_int_equal(pzs_loop_tick(&r.loop, r.wanted, r.measured), PZS_W_SENSOR);
    assert_ptr_equal(r.loop.info.block, &early_block);
    assert_int_equal(r.loop.info.where, 1);
    r.wanted[3] = (pzs_real)NAN;
    assert_int_equal(pzs_loop_tick(&r.loop, r.wanted, r.measured), PZS_W_HELD);
    assert_ptr_equal(r.loop.info.block, &pzs_step_block);
    rig_close(&r);
}

/* ---- start, hold ------------------------------------------------------- */

/* Law: a loop started from the voltages of another goes on as that one, whose readings of before do
 * not matter; the amplifiers too start from there, and a NaN changes nothing. */
static void test_start(void **state)
{
    static rig r, other;
    pzs_real voltage[N];
    (void)state;
    rig_open(&r, 8);
    rig_open(&other, 8);
    list(&r, QUANTISES);
    list(&other, QUANTISES);
    assert_int_equal(pzs_loop_start(&r.loop, voltage), PZS_E_STAGE);
    assert_int_equal(start(&r), PZS_OK);
    assert_int_equal(start(&other), PZS_OK);
    for (int tick = 0; tick < 6; tick++) {
        act(&r, r.loop.info.voltage, tick);
        assert_int_equal(pzs_loop_tick(&r.loop, r.wanted, r.measured), PZS_OK);
    }
    memcpy(voltage, r.loop.info.voltage, sizeof voltage);
    assert_int_equal(pzs_hold(other.loop.info.control, 3, 1), PZS_OK);
    assert_int_equal(pzs_loop_start(&other.loop, voltage), PZS_OK);
    assert_true(other.loop.info.control->info.upper[3] >= other.problem.upper[3]); /* released */
    assert_memory_equal(other.loop.info.voltage, voltage, sizeof voltage);
    assert_int_equal(pzs_loop_start(&r.loop, voltage), PZS_OK);
    for (int tick = 6; tick < 20; tick++) {
        act(&r, r.loop.info.voltage, tick);
        assert_int_equal(pzs_loop_tick(&r.loop, r.wanted, r.measured), PZS_OK);
        assert_int_equal(pzs_loop_tick(&other.loop, r.wanted, r.measured), PZS_OK);
        for (int k = 0; k < N; k++)
            assert_true(fabs((double)(r.loop.info.voltage[k] - other.loop.info.voltage[k])) <=
                        (double)r.amplifier.step * (1 + 2 * (double)PZS_EPSILON));
    }
    memcpy(voltage, r.loop.info.voltage, sizeof voltage);
    voltage[4] = (pzs_real)NAN;
    assert_int_equal(pzs_loop_start(&r.loop, voltage), PZS_E_NONFINITE);
    assert_int_equal(r.loop.info.where, 4);
    voltage[4] = r.loop.info.voltage[4];
    assert_memory_equal(r.loop.info.voltage, voltage, sizeof voltage);
    assert_int_equal(pzs_loop_start(NULL, voltage), PZS_E_ARGUMENT);
    assert_int_equal(pzs_loop_start(&r.loop, NULL), PZS_E_ARGUMENT);
    assert_int_equal(pzs_loop_tick(NULL, r.wanted, NULL), PZS_E_ARGUMENT);
    assert_int_equal(pzs_loop_tick(&r.loop, NULL, NULL), PZS_E_ARGUMENT);
    rig_close(&r);
    rig_close(&other);
}

/* Law: an amplitude of the tables is that of the test signals, cut to just below half the step
 * limit. */
static void test_amplitude(void **state)
{
    static rig r;
    (void)state;
    rig_open(&r, 9);
    list(&r, DETECTS);
    for (int i = 0; i < 2; i++) {
        r.detection.amplitude = i == 0 ? 2 : 1000;
        assert_int_equal(start(&r), PZS_OK);
        const pzs_fault_detector *d = pzs_loop_find(&r.loop, &pzs_fault_detector_block);
        assert_true(d->settings.amplitude[3] >= r.detection.amplitude || i == 1);
        assert_true(2 * d->settings.amplitude[3] <= (i == 0 ? 4 : r.problem.step_limit[3]));
        assert_true(d->settings.amplitude[3] > 0);
    }
    rig_close(&r);
}

/*
 * Law: a damaged table of a block is found while the loop runs, by its block, after at most three
 * rounds of the scrub over all tables; undamaged tables are never reported.
 */
static void test_scrub(void **state)
{
    static rig r;
    (void)state;
    rig_open(&r, 12);
    list(&r, FEEDS | ESTIMATES);
    const size_t bytes = sizeof r.problem.influence + sizeof r.direct + sizeof r.gain +
                         sizeof r.by_load + sizeof r.seen + 4 * sizeof r.problem.lower +
                         sizeof r.problem.weight;
    const int round = (int)(bytes / 64) + 30;
    pzs_real *const damaged[] = {NULL,          &r.direct[K * N - 1], &r.gain[0],
                                 &r.by_load[7], &r.seen[3],           &r.problem.influence[11]};
    const pzs_block_type *const blame[] = {NULL,
                                           &pzs_estimator_block,
                                           &pzs_estimator_block,
                                           &pzs_feed_forward_block,
                                           &pzs_feed_forward_block,
                                           NULL};
    for (int kind = 0; kind < 6; kind++) {
        pzs_status status = PZS_OK;
        int tick = 0;
        assert_int_equal(start(&r), PZS_OK);
        for (; tick < 100 + 3 * round && !PZS_IS_ERROR(status); tick++) {
            act(&r, r.loop.info.voltage, 0);
            if (tick == 100 && kind > 0)
                *damaged[kind] += PZS_R(1e-3) * *damaged[kind];
            status = pzs_loop_tick(&r.loop, r.wanted, r.sensed);
        }
        assert_int_equal(status, kind == 0 ? PZS_OK : PZS_E_CRC);
        if (kind > 0)
            assert_ptr_equal(r.loop.info.block, blame[kind]);
        rig_close(&r);
        rig_open(&r, 12);
        list(&r, FEEDS | ESTIMATES);
    }
    rig_close(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_bits),     cmocka_unit_test(test_wrong_lists),
        cmocka_unit_test(test_wrong_tables),  cmocka_unit_test(test_workspace),
        cmocka_unit_test(test_own_block),     cmocka_unit_test(test_observer_of_few),
        cmocka_unit_test(test_failing_block), cmocka_unit_test(test_bad_known_load),
        cmocka_unit_test(test_precedence),    cmocka_unit_test(test_start),
        cmocka_unit_test(test_amplitude),     cmocka_unit_test(test_scrub)};
    return cmocka_run_group_tests_name("loop_blocks", tests, NULL, NULL);
}
