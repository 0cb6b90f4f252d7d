/*
 * The supervisor: every transition; ramps that are straight, inside limits and step limits and as
 * long as announced; arming; the divergence monitor on healthy and on unstable plants; random
 * faults.
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

#ifndef LONG_TICKS
#define LONG_TICKS 20000
#endif

enum { N = 6, M = 20, MODES = 2, TIMEOUT = 25, RAMP = 10, ALARM = 20, LATEST = 250, FREE = 2 };
enum { MOST_INPUTS = N, MOST_OUTPUTS = M };

#include "../rigs/problem_rig.h"

/* Modes in which the loop may be on the way; used as a set of bits. */
#define LIMIT 100
#define STEP 7

/* ---- plants ---------------------------------------------------------------- */

/*
 * A plant of two vibration modes and a static rest: y = C q + R v + load. A mode turns by `angle` a
 * tick about its static coordinate g v; angle 0 makes it follow at once.
 */
typedef struct plant {
    double shape[M][MODES], rest[M][N], modal[MODES][N];
    double angle[MODES], damping;
    double position[MODES], velocity[MODES]; /* velocity over angular frequency */
    double gain, load[M];
} plant;

/* Influence of the plant at rest, output i of input j. */
static double influence_of(const plant *p, int i, int j)
{
    double sum = p->rest[i][j];
    for (int k = 0; k < MODES; k++)
        sum += p->shape[i][k] * p->modal[k][j];
    return sum;
}

/* Let the plant go on for one tick under voltages. */
static void turn(plant *p, const pzs_real *voltage)
{
    for (int k = 0; k < MODES; k++) {
        double at = 0;
        for (int j = 0; j < N; j++)
            at += p->gain * p->modal[k][j] * (double)voltage[j];
        const double fade = exp(-p->damping * p->angle[k]), c = fade * cos(p->angle[k]),
                     s = fade * sin(p->angle[k]), away = p->position[k] - at;
        if (p->angle[k] > 0) {
            p->position[k] = at + c * away + s * p->velocity[k];
            p->velocity[k] = c * p->velocity[k] - s * away;
        } else {
            p->position[k] = at;
        }
    }
}

static void measure(const plant *p, const pzs_real *voltage, pzs_real *measured)
{
    for (int i = 0; i < M; i++) {
        double sum = p->load[i];
        for (int k = 0; k < MODES; k++)
            sum += p->shape[i][k] * p->position[k];
        for (int j = 0; j < N; j++)
            sum += p->gain * p->rest[i][j] * (double)voltage[j];
        measured[i] = (pzs_real)sum;
    }
}

/* ---- rig ------------------------------------------------------------------- */

/* A block that fails when told to, and tells a deviation as a model of the vibration does. */
typedef struct failure {
    pzs_status status;
    pzs_real deviation;
} failure;

static pzs_status fail_tick(void *self, pzs_loop_signals *signals)
{
    const failure *told = signals->tables;
    (void)self;
    signals->deviation = told->deviation;
    return told->status;
}

static const pzs_block_type failing_block = {"failing", PZS_PHASE_READINGS, no_bytes,
                                             no_init,   fail_tick,          NULL};

typedef struct rig {
    unsigned seed;
    plant plant;
    failure failure;
    problem_rig problem;
    pzs_supervision supervision;
    pzs_real park[N];
    pzs_real target[M], wanted[M], measured[M], given[N];
    pzs_real free_value[FREE * M];
    pzs_free_functions free_functions;
    pzs_block block[4];
    size_t blocks;
    pzs_loop loop;
    pzs_supervisor *supervisor;
    double work[4000];
    double noise;
} rig;

static pzs_status init(rig *r)
{
    const pzs_status status =
        pzs_loop_init(&r->loop, r->block, r->blocks, NULL, r->work, sizeof r->work);
    r->supervisor = pzs_loop_find(&r->loop, &pzs_supervisor_block);
    if (status == PZS_OK)
        memcpy(r->given, r->loop.info.voltage, sizeof r->given);
    return status;
}

static void make_plant(rig *r)
{
    plant *p = &r->plant;
    p->gain = 1;
    p->damping = 0.005;
    for (int i = 0; i < M; i++) {
        for (int k = 0; k < MODES; k++)
            p->shape[i][k] = cos(3.14159265358979 * (k + 1) * i / (M - 1));
        for (int j = 0; j < N; j++)
            p->rest[i][j] = uniform(&r->seed, -2e-7, 2e-7);
    }
    for (int k = 0; k < MODES; k++)
        for (int j = 0; j < N; j++)
            p->modal[k][j] = uniform(&r->seed, -1e-6, 1e-6);
}

static double rms(const pzs_real *x)
{
    double sum = 0;
    for (int i = 0; i < M; i++)
        sum += (double)x[i] * (double)x[i] / M;
    return sqrt(sum);
}

/* A rig with a target of half the range, parked at voltages that are not 0. */
static void open_rig(rig *r, unsigned seed, bool waits)
{
    memset(r, 0, sizeof *r);
    r->seed = seed;
    make_plant(r);
    problem_open(&r->problem, N, M, -LIMIT, LIMIT, STEP);
    for (int j = 0; j < N; j++) {
        r->problem.reference_voltage[j] = (pzs_real)(3 - j);
        r->park[j] = (pzs_real)(10 * j - 20);
    }
    for (int i = 0; i < M; i++) {
        for (int j = 0; j < N; j++)
            r->problem.influence[i * N + j] = (pzs_real)influence_of(&r->plant, i, j);
        for (int j = 0; j < N; j++)
            r->target[i] +=
                r->problem.influence[i * N + j] * (pzs_real)(j % 2 ? LIMIT / 2 : -LIMIT / 2);
    }
    r->supervision = (pzs_supervision){.scene = SCENE,
                                       .inputs = N,
                                       .timeout = TIMEOUT,
                                       .ramp_ticks = RAMP,
                                       .alarm_ticks = ALARM,
                                       .polarity_ticks = ALARM,
                                       .waits = waits,
                                       .park = r->park,
                                       .fading = PZS_R(0.98),
                                       .noise = PZS_R(1e-8),
                                       .load = (pzs_real)(0.3 * rms(r->target))};
    r->noise = 1e-8;
    r->failure.deviation = -1;
    problem_seal(&r->problem);
    assert_int_equal(pzs_supervision_seal(&r->supervision), PZS_OK);
    r->block[0] = (pzs_block){&failing_block, &r->failure};
    r->block[1] = (pzs_block){&pzs_step_block, &r->problem.tables};
    r->block[2] = (pzs_block){&pzs_supervisor_block, &r->supervision};
    r->blocks = 3;
    assert_int_equal(init(r), PZS_OK);
}

/* Rounding of a difference of two voltages. */
#define ROUNDING (4 * LIMIT * (double)PZS_EPSILON)

/* Take the voltages as amplifiers do, which checks them. */
static void take(rig *r)
{
    const pzs_real *voltage = r->loop.info.voltage;
    for (int j = 0; j < N; j++) {
        const pzs_real v = voltage[j];
        assert_true(isfinite(v) && v >= r->problem.lower[j] && v <= r->problem.upper[j]);
        assert_true((v < r->given[j] ? r->given[j] - v : v - r->given[j]) <= STEP);
        r->given[j] = v;
    }
    turn(&r->plant, r->given);
}

/* One tick with a factor of the target; has_frame: there are readings. */
static pzs_status tick(rig *r, double factor, bool has_frame)
{
    measure(&r->plant, r->given, r->measured);
    for (int i = 0; i < M; i++) {
        r->wanted[i] = (pzs_real)factor * r->target[i];
        r->measured[i] += (pzs_real)uniform(&r->seed, -r->noise, r->noise);
    }
    const pzs_status status = pzs_loop_tick(&r->loop, r->wanted, has_frame ? r->measured : NULL);
    take(r);
    return status;
}

static pzs_supervisor_mode mode_of(const rig *r)
{
    return r->supervisor->info.mode;
}

/* Tick until the loop is in control. */
static void bring_to_control(rig *r)
{
    int ticks = 0;
    while (mode_of(r) != PZS_MODE_RUNNING && ticks++ < 100)
        (void)tick(r, 1, true);
    assert_int_equal(mode_of(r), PZS_MODE_RUNNING);
    for (int k = 0; k < 60; k++)
        assert_int_equal(tick(r, 1, true), PZS_OK);
}

/*
 * Tick along a ramp that has `ticks` ticks to go, the next one being its first: it is straight from
 * the voltages given now to `to`, ends there in time, and has this status until its last tick.
 */
static void follow_ramp(rig *r, const pzs_real *to, uint32_t ticks, pzs_status on_way,
                        pzs_status at_end)
{
    pzs_real from[N];
    memcpy(from, r->given, sizeof from);
    for (uint32_t k = 1; k <= ticks; k++) {
        assert_int_equal(tick(r, 1, true), k < ticks ? on_way : at_end);
        for (int j = 0; j < N; j++) {
            const double line = (double)from[j] + (double)(to[j] - from[j]) * k / ticks;
            assert_true(fabs((double)r->given[j] - line) <= ticks * ROUNDING);
        }
    }
    assert_memory_equal(r->given, to, sizeof from);
}

/* ---- transitions ------------------------------------------------------------- */

/* Every transition that there is; any other event leaves the mode as it is. */
static const struct {
    pzs_supervisor_mode from;
    pzs_supervisor_event event;
    pzs_supervisor_mode to;
} known[] = {
    {PZS_MODE_INITIALISE, PZS_EVENT_ARM, PZS_MODE_ARMED},
    {PZS_MODE_INITIALISE, PZS_EVENT_PARK, PZS_MODE_PARKING},
    {PZS_MODE_INITIALISE, PZS_EVENT_STOP, PZS_MODE_STOPPING},
    {PZS_MODE_INITIALISE, PZS_EVENT_ERROR, PZS_MODE_STOPPING},
    {PZS_MODE_ARMED, PZS_EVENT_FRAME, PZS_MODE_RUNNING},
    {PZS_MODE_ARMED, PZS_EVENT_PARK, PZS_MODE_PARKING},
    {PZS_MODE_ARMED, PZS_EVENT_STOP, PZS_MODE_STOPPING},
    {PZS_MODE_ARMED, PZS_EVENT_ERROR, PZS_MODE_STOPPING},
    {PZS_MODE_RUNNING, PZS_EVENT_NO_FRAME, PZS_MODE_HOLDING},
    {PZS_MODE_RUNNING, PZS_EVENT_PARK, PZS_MODE_PARKING},
    {PZS_MODE_RUNNING, PZS_EVENT_STOP, PZS_MODE_STOPPING},
    {PZS_MODE_RUNNING, PZS_EVENT_TIMEOUT, PZS_MODE_STOPPING},
    {PZS_MODE_RUNNING, PZS_EVENT_ALARM, PZS_MODE_STOPPING},
    {PZS_MODE_RUNNING, PZS_EVENT_ERROR, PZS_MODE_STOPPING},
    {PZS_MODE_HOLDING, PZS_EVENT_FRAME, PZS_MODE_RUNNING},
    {PZS_MODE_HOLDING, PZS_EVENT_PARK, PZS_MODE_PARKING},
    {PZS_MODE_HOLDING, PZS_EVENT_STOP, PZS_MODE_STOPPING},
    {PZS_MODE_HOLDING, PZS_EVENT_TIMEOUT, PZS_MODE_STOPPING},
    {PZS_MODE_HOLDING, PZS_EVENT_ALARM, PZS_MODE_STOPPING},
    {PZS_MODE_HOLDING, PZS_EVENT_ERROR, PZS_MODE_STOPPING},
    {PZS_MODE_PARKING, PZS_EVENT_RESUME, PZS_MODE_ARMED},
    {PZS_MODE_PARKING, PZS_EVENT_STOP, PZS_MODE_STOPPING},
    {PZS_MODE_PARKING, PZS_EVENT_ERROR, PZS_MODE_STOPPING},
    {PZS_MODE_PARKING, PZS_EVENT_ARRIVED, PZS_MODE_PARKED},
    {PZS_MODE_PARKED, PZS_EVENT_PARK, PZS_MODE_PARKING},
    {PZS_MODE_PARKED, PZS_EVENT_RESUME, PZS_MODE_ARMED},
    {PZS_MODE_PARKED, PZS_EVENT_STOP, PZS_MODE_STOPPING},
    {PZS_MODE_PARKED, PZS_EVENT_ERROR, PZS_MODE_STOPPING},
    {PZS_MODE_STOPPING, PZS_EVENT_ARRIVED, PZS_MODE_LATCHED},
    {PZS_MODE_TESTING, PZS_EVENT_PARK, PZS_MODE_PARKING},
    {PZS_MODE_TESTING, PZS_EVENT_STOP, PZS_MODE_STOPPING},
    {PZS_MODE_TESTING, PZS_EVENT_TIMEOUT, PZS_MODE_STOPPING},
    {PZS_MODE_TESTING, PZS_EVENT_ALARM, PZS_MODE_STOPPING},
    {PZS_MODE_TESTING, PZS_EVENT_ERROR, PZS_MODE_STOPPING},
};

/* Law: each mode reacts to each event as the list says, 90 pairs; a damaged mode or event to none.
 */
static void test_transitions(void **state)
{
    (void)state;
    for (int mode = 0; mode < PZS_SUPERVISOR_MODES; mode++)
        for (int event = 0; event < PZS_EVENTS; event++) {
            int expected = mode;
            for (size_t k = 0; k < sizeof known / sizeof *known; k++)
                if ((int)known[k].from == mode && (int)known[k].event == event)
                    expected = known[k].to;
            assert_int_equal(
                pzs_supervisor_next((pzs_supervisor_mode)mode, (pzs_supervisor_event)event),
                expected);
        }
    assert_int_equal(pzs_supervisor_next(PZS_SUPERVISOR_MODES, PZS_EVENT_ARM),
                     PZS_SUPERVISOR_MODES);
    assert_int_equal(pzs_supervisor_next(PZS_MODE_RUNNING, PZS_EVENTS), PZS_MODE_RUNNING);
}

/* ---- commands and ramps --------------------------------------------------------- */

static void give(rig *r, pzs_supervisor_command command)
{
    assert_int_equal(pzs_supervisor_give(r->supervisor, command), PZS_OK);
}

/* Law: the output stays parked until the command ARM and a whole frame have come. */
static void test_arming(void **state)
{
    static rig r;
    (void)state;
    open_rig(&r, 1, true);
    const uint32_t ticks = pzs_supervisor_ramp(&r.supervision, &r.problem.tables, r.given, r.park);
    follow_ramp(&r, r.park, ticks, PZS_W_PARKED, PZS_W_PARKED);
    assert_int_equal(mode_of(&r), PZS_MODE_INITIALISE);
    give(&r, PZS_COMMAND_RESUME); /* not known in this mode */
    assert_int_equal(tick(&r, 1, true), PZS_W_PARKED);
    assert_int_equal(mode_of(&r), PZS_MODE_INITIALISE);
    give(&r, PZS_COMMAND_ARM);
    for (int k = 0; k < 2 * TIMEOUT; k++)
        assert_int_equal(tick(&r, 1, false), PZS_W_PARKED);
    assert_int_equal(mode_of(&r), PZS_MODE_ARMED);
    measure(&r.plant, r.given, r.measured);
    r.measured[3] = (pzs_real)NAN; /* a frame that is not whole */
    assert_int_equal(pzs_loop_tick(&r.loop, r.wanted, r.measured), PZS_W_PARKED);
    assert_memory_equal(r.loop.info.voltage, r.park, sizeof r.park);
    assert_int_equal(mode_of(&r), PZS_MODE_ARMED);
    (void)tick(&r, 1, true);
    assert_int_equal(mode_of(&r), PZS_MODE_RUNNING);
    bring_to_control(&r);
    assert_true(fabs((double)(r.given[0] - r.park[0])) > 1);
    assert_int_equal(pzs_supervisor_give(NULL, PZS_COMMAND_ARM), PZS_E_ARGUMENT);
    assert_int_equal(pzs_supervisor_give(r.supervisor, (pzs_supervisor_command)9), PZS_E_ARGUMENT);
}

/* Law: a loop whose voltages start at the park voltages is in control from the second frame on. */
static void test_start_at_park(void **state)
{
    static rig r;
    (void)state;
    open_rig(&r, 1, false);
    for (int j = 0; j < N; j++)
        r.park[j] = r.given[j];
    assert_int_equal(pzs_supervision_seal(&r.supervision), PZS_OK);
    assert_int_equal(init(&r), PZS_OK);
    assert_int_equal(tick(&r, 1, true), PZS_W_PARKED);
    assert_int_equal(tick(&r, 1, true), PZS_OK);
    assert_int_equal(mode_of(&r), PZS_MODE_RUNNING);
}

/* Law: PARK and FLAT ramp to their voltages in the announced number of ticks, RESUME brings control
 * back without a jump, and then control ends where it was. */
static void test_park_and_resume(void **state)
{
    static rig r;
    pzs_real before[N];
    (void)state;
    open_rig(&r, 2, false);
    bring_to_control(&r);
    memcpy(before, r.given, sizeof before);
    give(&r, PZS_COMMAND_PARK);
    uint32_t ticks = pzs_supervisor_ramp(&r.supervision, &r.problem.tables, r.given, r.park);
    assert_true(ticks > RAMP);
    assert_true(ticks <= pzs_supervisor_longest_ramp(&r.supervision, &r.problem.tables));
    follow_ramp(&r, r.park, ticks, PZS_W_PARKED, PZS_W_PARKED);
    assert_int_equal(mode_of(&r), PZS_MODE_PARKED);
    give(&r, PZS_COMMAND_FLAT);
    ticks = pzs_supervisor_ramp(&r.supervision, &r.problem.tables, r.given,
                                r.problem.reference_voltage);
    follow_ramp(&r, r.problem.reference_voltage, ticks, PZS_W_PARKED, PZS_W_PARKED);
    give(&r, PZS_COMMAND_RESUME);
    assert_int_equal(tick(&r, 1, true), PZS_W_PARKED);
    bring_to_control(&r);
    for (int j = 0; j < N; j++)
        assert_true(fabs((double)(r.given[j] - before[j])) < 1e-2 * LIMIT);
}

/* Law: STOP, a time-out and an error of a block end in LATCHED at the park voltages, after a
 * straight ramp of the announced length; no command and no frame changes that, only an init. */
static void test_stop(void **state)
{
    static rig r;
    (void)state;
    for (int way = 0; way < 3; way++) {
        open_rig(&r, 3, false);
        bring_to_control(&r);
        if (way == 0)
            give(&r, PZS_COMMAND_STOP);
        give(&r, PZS_COMMAND_PARK); /* does not replace STOP */
        if (way > 0)
            give(&r, PZS_COMMAND_NONE);
        for (int k = 1; way == 1 && k < TIMEOUT; k++)
            assert_int_equal(tick(&r, 1, false), PZS_OK);
        assert_int_equal(mode_of(&r), way == 1 ? PZS_MODE_HOLDING : PZS_MODE_RUNNING);
        const uint32_t ticks =
            pzs_supervisor_ramp(&r.supervision, &r.problem.tables, r.given, r.park);
        r.failure.status = way == 2 ? PZS_E_NONFINITE : PZS_OK;
        if (way == 1)
            r.noise = (double)NAN; /* no reading is usable */
        follow_ramp(&r, r.park, ticks, PZS_W_RAMP, PZS_E_LATCHED);
        static const pzs_supervisor_event cause[3] = {PZS_EVENT_STOP, PZS_EVENT_TIMEOUT,
                                                      PZS_EVENT_ERROR};
        assert_int_equal(r.supervisor->info.cause, cause[way]);
        r.noise = 0;
        r.failure.status = PZS_OK;
        for (int command = PZS_COMMAND_ARM; command <= PZS_COMMAND_STOP; command++) {
            give(&r, (pzs_supervisor_command)command);
            assert_int_equal(tick(&r, 1, true), PZS_E_LATCHED);
            assert_memory_equal(r.given, r.park, sizeof r.park);
        }
        assert_int_equal(init(&r), PZS_OK);
        assert_int_equal(tick(&r, 1, true), PZS_W_PARKED);
    }
}

/* Law: the loop of the README, which ends at the first error, ends with parked amplifiers. */
static void test_loop_of_the_readme(void **state)
{
    static rig r;
    int ticks = 0;
    (void)state;
    open_rig(&r, 4, false);
    pzs_status status = PZS_OK;
    while (!PZS_IS_ERROR(status) && ticks < 1000) {
        r.failure.status = ticks == 300 ? PZS_E_CONDITION : PZS_OK;
        status = tick(&r, 1, true);
        ticks++;
    }
    assert_int_equal(status, PZS_E_LATCHED);
    assert_true(ticks > 300 && (uint32_t)ticks <= 301 + pzs_supervisor_longest_ramp(
                                                            &r.supervision, &r.problem.tables));
    assert_memory_equal(r.given, r.park, sizeof r.park);
}

/* Law: damaged, foreign or impossible tables are refused. */
static void test_tables(void **state)
{
    static rig r;
    (void)state;
    open_rig(&r, 5, false);
    r.park[2] += 1;
    assert_int_equal(init(&r), PZS_E_CRC);
    r.park[2] = (pzs_real)NAN;
    assert_int_equal(pzs_supervision_seal(&r.supervision), PZS_OK);
    assert_int_equal(init(&r), PZS_E_NONFINITE);
    assert_int_equal(r.loop.info.where, 2);
    for (int side = -1; side <= 1; side += 2) {
        r.park[2] = (pzs_real)side * LIMIT * (1 + PZS_EPSILON);
        assert_int_equal(pzs_supervision_seal(&r.supervision), PZS_OK);
        assert_int_equal(init(&r), PZS_E_LIMITS);
        assert_int_equal(r.loop.info.where, 2);
        r.park[2] = (pzs_real)side * LIMIT;
        assert_int_equal(pzs_supervision_seal(&r.supervision), PZS_OK);
        assert_int_equal(init(&r), PZS_OK);
    }
    r.park[2] = 0;
    r.supervision.fading = 1;
    assert_int_equal(pzs_supervision_seal(&r.supervision), PZS_OK);
    assert_int_equal(init(&r), PZS_E_ARGUMENT);
    r.supervision.fading = PZS_R(0.98);
    r.supervision.scene++;
    assert_int_equal(pzs_supervision_seal(&r.supervision), PZS_OK);
    assert_int_equal(init(&r), PZS_E_FORMAT);
    r.supervision.scene--;
    r.supervision.park = NULL;
    assert_int_equal(pzs_supervision_seal(&r.supervision), PZS_E_ARGUMENT);
    assert_int_equal(pzs_supervision_seal(NULL), PZS_E_ARGUMENT);
    assert_int_equal(init(&r), PZS_E_ARGUMENT);
}

/* Law: an input without a step limit bounds no ramp; one that cannot move does not count. */
static void test_ramp_lengths(void **state)
{
    static rig r;
    (void)state;
    open_rig(&r, 6, false);
    for (int j = 0; j < N; j++)
        r.problem.step_limit[j] = j == 0 ? 0 : (pzs_real)HUGE_VAL;
    assert_int_equal(pzs_supervisor_longest_ramp(&r.supervision, &r.problem.tables), RAMP);
    r.problem.step_limit[1] = 1;
    const uint32_t longest = pzs_supervisor_longest_ramp(&r.supervision, &r.problem.tables);
    assert_in_range(longest, LIMIT + 10, LIMIT + 12); /* from 100 V to -10 V */
    r.problem.upper[1] = (pzs_real)HUGE_VAL;
    assert_true(pzs_supervisor_longest_ramp(&r.supervision, &r.problem.tables) == UINT32_MAX);
}

/* ---- divergence monitor ----------------------------------------------------------- */

/* Law: on a quasi-static plant, a third stronger or weaker than the tables, with noise, steps of
 * the target and of loads, no alarm comes. */
static void test_no_false_alarm(void **state)
{
    (void)state;
    static const double gains[] = {1, 0.75, 1.33};
    for (int gain = 0; gain < 3; gain++) {
        static rig r;
        open_rig(&r, 7, false);
        r.plant.gain = gains[gain];
        double factor = 1;
        for (int t = 0; t < LONG_TICKS / 2; t++) {
            if (t % 97 == 0)
                factor = uniform(&r.seed, -1, 1);
            if (t % 131 == 0) {
                const double size = uniform(&r.seed, -1, 1) * (double)r.supervision.load / 2;
                for (int i = 0; i < M; i++)
                    r.plant.load[i] = size * cos(0.3 * i);
            }
            const pzs_status status = tick(&r, factor, t % 53 != 7);
            assert_false(PZS_IS_ERROR(status) || status == PZS_W_RAMP);
        }
    }
}

/* Law: control that is lost is taken away within LATEST ticks, by a straight ramp of the announced
 * length, and stays away. */
static void loses_control(rig *r)
{
    uint32_t ticks = 0;
    while (mode_of(r) != PZS_MODE_STOPPING && ticks < LATEST) {
        (void)tick(r, 1, true);
        ticks++;
    }
    assert_int_equal(mode_of(r), PZS_MODE_STOPPING);
    assert_int_equal(r->supervisor->info.cause, PZS_EVENT_ALARM);
    const uint32_t rest = r->supervisor->info.remaining;
    assert_true(rest < pzs_supervisor_longest_ramp(&r->supervision, &r->problem.tables));
    follow_ramp(r, r->park, rest, PZS_W_RAMP, PZS_E_LATCHED);
    printf("# alarm after %u ticks, ramp of %u\n", ticks, rest + 1);
}

/* Bring a loop to control whose block tells deviations, and let the envelope fade, by 0.98 a tick.
 * Returns the threshold of the deviation. */
static pzs_real open_deviating(rig *r)
{
    open_rig(r, 11, false);
    r->failure.deviation = 0;
    bring_to_control(r);
    for (int t = 0; t < 1000; t++)
        assert_int_equal(tick(r, 1, true), PZS_OK);
    return r->supervision.load + 6 * r->supervision.noise;
}

/* Law: a deviation that a block tells raises the alarm after two periods (2 alarm_ticks) above the
 * threshold, load + 6 noise once the changes of the target have faded, and never below it. */
static void test_deviation(void **state)
{
    static rig r;
    (void)state;
    const pzs_real threshold = open_deviating(&r);
    r.failure.deviation = PZS_R(0.99) * threshold;
    for (int t = 0; t < 100; t++)
        assert_int_equal(tick(&r, 1, true), PZS_OK);
    r.failure.deviation = PZS_R(1.01) * threshold;
    for (int t = 0; t < 2 * ALARM; t++)
        assert_int_equal(tick(&r, 1, true), PZS_OK);
    assert_int_equal(tick(&r, 1, true), PZS_W_RAMP);
    assert_int_equal(r.supervisor->info.cause, PZS_EVENT_ALARM);
    assert_false(r.supervisor->info.is_opposed);
}

/*
 * Law: vibration far above the threshold is no alarm while its peaks fall by more than a tenth in
 * each half period (0.95 for each of its 10 ticks is 0.6); if they fall by less (0.995, which is
 * 0.95), the alarm comes after two periods.
 */
static void test_falling_vibration(void **state)
{
    static const double factor[] = {0.95, 0.995};
    (void)state;
    for (int slow = 0; slow < 2; slow++) {
        static rig r;
        int ticks = 0;
        const pzs_real threshold = open_deviating(&r);
        r.failure.deviation = 1000 * threshold;
        while (mode_of(&r) == PZS_MODE_RUNNING && r.failure.deviation > threshold) {
            (void)tick(&r, 1, true);
            r.failure.deviation *= (pzs_real)factor[slow];
            ticks++;
        }
        assert_int_equal(mode_of(&r), slow ? PZS_MODE_STOPPING : PZS_MODE_RUNNING);
        assert_in_range(ticks, slow ? 2 * ALARM + 1 : 100, slow ? 2 * ALARM + 1 : 200);
    }
}

/* Law: amplifiers of the wrong polarity, from the start or all at once. */
static void test_wrong_polarity(void **state)
{
    (void)state;
    for (int late = 0; late < 2; late++) {
        static rig r;
        open_rig(&r, 8, false);
        if (late)
            bring_to_control(&r);
        r.plant.gain = -1;
        if (!late)
            while (mode_of(&r) != PZS_MODE_RUNNING)
                (void)tick(&r, 1, true);
        else
            for (int t = 0; t < 3; t++)
                (void)tick(&r, t % 2 ? 1 : 0.9, true);
        loses_control(&r);
    }
}

/* Law: a structure that vibrates under a loop without a model of it, at every pair of angles. */
static void test_unstable(void **state)
{
    static const double angle[][MODES] = {
        {0.1, 0.3}, {0.05, 0.6}, {0.3, 1.5}, {0.02, 0.05}, {1, 2}};
    (void)state;
    for (size_t k = 0; k < sizeof angle / sizeof *angle; k++) {
        static rig r;
        open_rig(&r, 9, false);
        memcpy(r.plant.angle, angle[k], sizeof angle[k]);
        while (mode_of(&r) != PZS_MODE_RUNNING)
            (void)tick(&r, 1, true);
        loses_control(&r);
    }
}

/* ---- free functions of the target --------------------------------------------------- */

/* Take the free functions out of a shape whose entries are `stride` apart. */
static void take_free(const rig *r, pzs_real *shape, size_t stride)
{
    for (int k = 0; k < FREE; k++) {
        const pzs_real *value = r->free_value + k * M;
        double product = 0;
        for (size_t i = 0; i < M; i++)
            product += (double)value[i] * (double)shape[i * stride];
        for (size_t i = 0; i < M; i++)
            shape[i * stride] -= (pzs_real)product * value[i];
    }
}

/*
 * A rig whose plant also moves as a whole and tilts, by thirty times its other displacements, which
 * are free functions of the target: the influence matrix of the tables lacks them.
 *   has_block in  whether the loop has the block of free functions
 */
static void open_free(rig *r, unsigned seed, bool has_block)
{
    open_rig(r, seed, false);
    for (int i = 0; i < M; i++) {
        const double x = (2.0 * i - (M - 1)) / (M - 1);
        r->free_value[i] = (pzs_real)sqrt(1.0 / M);
        r->free_value[M + i] = (pzs_real)(x * sqrt(3.0 * (M - 1) / (M * (M + 1.0))));
    }
    for (int j = 0; j < N; j++) {
        const double rise = uniform(&r->seed, 0, 3e-5), tilt = uniform(&r->seed, -3e-5, 3e-5);
        for (int i = 0; i < M; i++)
            r->plant.rest[i][j] += rise + tilt * (2.0 * i - (M - 1)) / (M - 1);
        take_free(r, r->problem.influence + j, N);
    }
    take_free(r, r->target, 1);
    r->supervision.load = (pzs_real)(0.3 * rms(r->target));
    r->free_functions =
        (pzs_free_functions){.scene = SCENE, .outputs = M, .count = FREE, .value = r->free_value};
    problem_seal(&r->problem);
    assert_int_equal(pzs_supervision_seal(&r->supervision), PZS_OK);
    assert_int_equal(pzs_free_functions_seal(&r->free_functions), PZS_OK);
    if (has_block) {
        memmove(r->block + 2, r->block + 1, 2 * sizeof *r->block);
        r->block[1] = (pzs_block){&pzs_free_functions_block, &r->free_functions};
        r->blocks = 4;
    }
    assert_int_equal(init(r), PZS_OK);
}

/* Jumps of the target, and loads of which half are free functions. Returns the tick of an alarm. */
static int run_free(rig *r, int ticks)
{
    double factor = 1;
    for (int t = 0; t < ticks; t++) {
        if (t % 97 == 0)
            factor = uniform(&r->seed, -1, 1);
        if (t % 131 == 0) {
            const double size = uniform(&r->seed, -1, 1) * (double)r->supervision.load / 2,
                         rise = uniform(&r->seed, -1, 1) * 100 * (double)r->supervision.load;
            for (int i = 0; i < M; i++)
                r->plant.load[i] = size * cos(0.3 * i) + rise;
        }
        const pzs_status status = tick(r, factor, t % 53 != 7);
        if (PZS_IS_ERROR(status) || status == PZS_W_RAMP)
            return t;
    }
    return ticks;
}

/*
 * Law: with the block of free functions no motion along them is an alarm, which it is without the
 * block; reversed amplifiers raise the alarm as without free functions.
 */
static void test_free_functions(void **state)
{
    static const double gains[] = {1, 0.75, 1.33};
    static rig r;
    (void)state;
    for (int gain = 0; gain < 3; gain++) {
        open_free(&r, 12, true);
        r.plant.gain = gains[gain];
        assert_int_equal(run_free(&r, LONG_TICKS / 2), LONG_TICKS / 2);
        open_free(&r, 12, false);
        r.plant.gain = gains[gain];
        assert_true(run_free(&r, LONG_TICKS / 2) < LONG_TICKS / 2);
    }
    open_free(&r, 12, true);
    bring_to_control(&r);
    r.plant.gain = -1;
    for (int t = 0; t < 3; t++)
        (void)tick(&r, t % 2 ? 1 : 0.9, true);
    loses_control(&r);
}

/* Law: tables of free functions that are damaged, foreign or of another size are refused. */
static void test_free_tables(void **state)
{
    static rig r;
    (void)state;
    open_free(&r, 13, true);
    r.free_value[3] += 1;
    assert_int_equal(init(&r), PZS_E_CRC);
    r.free_value[3] = (pzs_real)NAN;
    assert_int_equal(pzs_free_functions_seal(&r.free_functions), PZS_OK);
    assert_int_equal(init(&r), PZS_E_NONFINITE);
    r.free_value[3] = r.free_value[2];
    r.free_functions.outputs--;
    assert_int_equal(pzs_free_functions_seal(&r.free_functions), PZS_OK);
    assert_int_equal(init(&r), PZS_E_ARGUMENT);
    r.free_functions.outputs++;
    r.free_functions.scene++;
    assert_int_equal(pzs_free_functions_seal(&r.free_functions), PZS_OK);
    assert_int_equal(init(&r), PZS_E_FORMAT);
    r.free_functions.count = 0;
    assert_int_equal(pzs_free_functions_seal(&r.free_functions), PZS_E_ARGUMENT);
    assert_int_equal(pzs_free_functions_seal(NULL), PZS_E_ARGUMENT);
}

/* ---- random faults ---------------------------------------------------------------- */

/* Damage a frame: nothing, some NaN, all NaN, stuck, huge, or no frame at all (false). */
static bool damage_frame(rig *r, const pzs_real *stuck, int fault)
{
    for (int i = 0; i < M; i++) {
        if (fault == 1 && uniform(&r->seed, 0, 1) < 0.3)
            r->measured[i] = (pzs_real)NAN;
        if (fault == 2)
            r->measured[i] = (pzs_real)HUGE_VAL;
        if (fault == 3)
            r->measured[i] = stuck[i];
        if (fault == 4)
            r->measured[i] *= 100;
    }
    return fault != 5;
}

/* Law: whatever readings, targets, commands, polarity and vibration do, voltages are finite and
 * inside limits and step limits, and control that was lost ends at the park voltages in the
 * announced number of ticks. */
static void test_random_faults(void **state)
{
    static rig r;
    pzs_real stuck[M] = {0};
    uint32_t lost = 0, way = 0;
    int fault = 0, until = 0;
    (void)state;
    open_rig(&r, 10, false);
    for (int t = 0; t < LONG_TICKS; t++) {
        if (t >= until) {
            fault = uniform(&r.seed, 0, 1) < 0.5 ? 0 : (int)uniform(&r.seed, 1, 8);
            until = t + (int)uniform(&r.seed, 1, 60);
            r.plant.gain = fault == 6 ? -1 : 1;
            r.plant.angle[0] = fault == 7 ? 0.1 : 0;
            r.plant.angle[1] = fault == 7 ? 0.3 : 0;
            memcpy(stuck, r.measured, sizeof stuck);
        }
        if (uniform(&r.seed, 0, 1) < 0.003)
            give(&r, (pzs_supervisor_command)(int)uniform(&r.seed, 0, 6));
        measure(&r.plant, r.given, r.measured);
        for (int i = 0; i < M; i++)
            r.wanted[i] = (pzs_real)(fault == 0 && t % 500 < 3 ? (double)NAN : 1) * r.target[i];
        const bool has_frame = damage_frame(&r, stuck, fault);
        const pzs_status status = pzs_loop_tick(&r.loop, r.wanted, has_frame ? r.measured : NULL);
        take(&r);
        way = status == PZS_W_RAMP ? way + 1 : 0;
        assert_true(way <= pzs_supervisor_longest_ramp(&r.supervision, &r.problem.tables));
        if (!PZS_IS_ERROR(status))
            continue;
        assert_int_equal(status, PZS_E_LATCHED);
        assert_memory_equal(r.given, r.park, sizeof r.park);
        const pzs_real from[N] = {r.given[0], r.given[1], r.given[2],
                                  r.given[3], r.given[4], r.given[5]};
        assert_int_equal(init(&r), PZS_OK);
        assert_int_equal(pzs_loop_start(&r.loop, from), PZS_OK);
        memcpy(r.given, from, sizeof from);
        lost++;
    }
    printf("# %d ticks, control lost %u times\n", LONG_TICKS, lost);
    assert_true(lost > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_transitions),
                                       cmocka_unit_test(test_arming),
                                       cmocka_unit_test(test_start_at_park),
                                       cmocka_unit_test(test_park_and_resume),
                                       cmocka_unit_test(test_stop),
                                       cmocka_unit_test(test_loop_of_the_readme),
                                       cmocka_unit_test(test_tables),
                                       cmocka_unit_test(test_ramp_lengths),
                                       cmocka_unit_test(test_no_false_alarm),
                                       cmocka_unit_test(test_deviation),
                                       cmocka_unit_test(test_falling_vibration),
                                       cmocka_unit_test(test_wrong_polarity),
                                       cmocka_unit_test(test_unstable),
                                       cmocka_unit_test(test_free_functions),
                                       cmocka_unit_test(test_free_tables),
                                       cmocka_unit_test(test_random_faults)};
    return cmocka_run_group_tests_name("supervisor", tests, NULL, NULL);
}
