/*
 * Damaged working memory of loops with a supervisor that damp vibration: with the sensor gate,
 * while sensors are wrong; with the fault detector, while it finds a dead electrode by test pulses;
 * and while the supervisor tests the polarity of a healthy and of a reversed structure. Whatever
 * bit flips, no voltage leaves its limits in flash, its step limit or the finite numbers, no tick
 * hangs, and the loop is soon where a loop without damage is, or says by a status what has
 * happened. Half of the flips hit what gate, detector and supervisor keep from tick to tick.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <cmocka.h>
#include "../rigs/flip_rig.h"
#include "gated_plate.h"
#include "watched_plate.h"

#ifdef __SANITIZE_ADDRESS__
#define SHORT 1000
#else
#define SHORT 10000
#endif
#ifndef FLIPS
#define FLIPS SHORT /* flips that are followed by two or three ticks, for each loop */
#endif
#ifndef WINDOWS
#define WINDOWS                                                                                    \
    (SHORT / 500) /* flips that are followed until the loop is compared with one without damage */
#endif

enum { PERIOD = 400, RENEWED = 200 };

/* 1 or -1. */
static pzs_real wave(long tick)
{
    return tick % PERIOD < PERIOD / 2 ? 1 : -1;
}

/* The target jumps in tick 150. */
static pzs_real jump(long tick)
{
    return tick < 150 ? 1 : PZS_R(-0.5);
}

static pzs_real none(long tick)
{
    (void)tick;
    return 0;
}

static pzs_real half(long tick)
{
    (void)tick;
    return PZS_R(0.5);
}

/* A loop, what happens to it, and the window in which bits flip. */
typedef struct loop_case {
    const char *name;
    const pzs_block *blocks;
    size_t count;
    flip_plant plant;
    flip_window window;
} loop_case;

#define GATED_PLANT .problem = &gated_problem, .target = gated_target, .vibration = &gated_vibration
#define WATCHED_PLANT                                                                              \
    .problem = &watched_problem, .target = watched_target, .vibration = &watched_vibration

static const loop_case gated = {"wrong sensors",
                                gated_blocks,
                                GATED_BLOCKS,
                                {GATED_PLANT, .bad_sensors = 2},
                                {.first = 30, .moving = 300, .ticks = 900, .wave = jump}};
static const loop_case healthy = {"healthy electrodes",
                                  watched_blocks,
                                  WATCHED_BLOCKS,
                                  {WATCHED_PLANT},
                                  {.moving = 300, .ticks = 900, .wave = jump}};
static const loop_case dead = {"dead electrode",
                               watched_blocks,
                               WATCHED_BLOCKS,
                               {WATCHED_PLANT, .dead_inputs = 1},
                               {.first = 140, .moving = 600, .ticks = 1400, .wave = jump}};
/*
 * Structures whose shape stays opposite to the prediction: under a load that grows slowly, and with
 * amplifiers of the wrong polarity where the supervisor tolerates sudden loads that are half as
 * large as the effect of the voltages.
 */
static const loop_case loaded = {"polarity test under a load",
                                 watched_blocks,
                                 WATCHED_BLOCKS,
                                 {WATCHED_PLANT, .push = -20, .push_ticks = 1500},
                                 {.first = 370, .moving = 800, .ticks = 1500, .wave = none}};
static pzs_supervision tolerant;
static pzs_block tolerant_blocks[WATCHED_BLOCKS];
static const loop_case reversed = {"polarity test of a reversed structure",
                                   tolerant_blocks,
                                   WATCHED_BLOCKS,
                                   {WATCHED_PLANT, .is_reversed = true},
                                   {.first = 230, .moving = 1180, .ticks = 1500, .wave = half}};

/* Let the supervisor of the reversed loop tolerate large loads. */
static void make_tolerant(void)
{
    tolerant = watched_supervision;
    tolerant.load = tolerant.slack;
    assert_int_equal(pzs_supervision_seal(&tolerant), PZS_OK);
    for (size_t k = 0; k < WATCHED_BLOCKS; k++) {
        const bool is_supervisor = watched_blocks[k].type == &pzs_supervisor_block;
        tolerant_blocks[k] = watched_blocks[k];
        if (is_supervisor)
            tolerant_blocks[k].tables = &tolerant;
    }
}

/* Open a loop; half of the flips hit what gate, detector and supervisor keep from tick to tick. */
static void open_loop(flip_rig *rig, const loop_case *loop)
{
    flip_rig_open(rig, &loop->plant, loop->blocks, loop->count);
    flip_rig_aim(rig, &pzs_supervisor_block, sizeof(pzs_supervisor));
    if (loop->blocks == gated_blocks) {
        flip_rig_aim(rig, &pzs_sensor_gate_block, sizeof(pzs_sensor_gate_state));
        return;
    }
    flip_rig_aim(rig, &pzs_pulse_detector_block, sizeof(pzs_pulse_detector));
    flip_rig_aim(rig, &pzs_pulse_detector_block,
                 PZS_PULSE_DETECTOR_BLOCK_BYTES(WATCHED_INPUTS, WATCHED_READINGS, WATCHED_OUTPUTS));
}

/* Law: after each flip, two ticks whose voltages are finite and inside limits and step limits. */
static void test_limits(void **state)
{
    const loop_case *const cases[] = {&gated, &healthy};
    (void)state;
    for (int k = 0; k < 2; k++) {
        static flip_rig rig;
        open_loop(&rig, cases[k]);
        assert_int_equal(flip_rig_limits(&rig, FLIPS, wave, RENEWED).beyond, 0);
        flip_rig_close(&rig);
    }
}

/*
 * Laws of bits that flip in a window: no voltage leaves its limits, and a loop with a flipped bit
 * ends where a loop without one ends, or a status has told of the damage. In a loop that runs on,
 * the same electrodes are held as faulty, at once or after further motions of the target.
 */
static void try_window(flip_rig *rig, const loop_case *loop)
{
    printf("# %s\n", loop->name);
    const flip_count states = flip_rig_states(rig, FLIPS, &loop->window);
    const flip_count count = flip_rig_harmless(rig, WINDOWS, &loop->window);
    assert_int_equal(states.beyond, 0);
    assert_int_equal(count.beyond + count.silent + count.lost, 0);
}

static void test_gate(void **state)
{
    static flip_rig rig;
    pzs_status status = PZS_OK;
    (void)state;
    open_loop(&rig, &gated);
    for (long t = 0; t <= gated.window.first; t++) {
        status = flip_rig_tick(&rig, jump(t));
        (void)flip_rig_take(&rig);
    }
    assert_int_equal(status, PZS_W_GATED);
    try_window(&rig, &gated);
    flip_rig_close(&rig);
}

static void test_healthy(void **state)
{
    static flip_rig rig;
    (void)state;
    open_loop(&rig, &healthy);
    try_window(&rig, &healthy);
    flip_rig_close(&rig);
}

/* Return the first tick of a window in which an electrode is in a state, or -1. */
static long first_tick(flip_rig *rig, const flip_window *window, pzs_electrode_state state)
{
    flip_rig_begin(rig);
    for (long t = 0; t < window->ticks; t++) {
        (void)flip_rig_tick(rig, flip_rig_factor(window, t));
        (void)flip_rig_take(rig);
        for (size_t j = 0; j < rig->plant->problem->inputs; j++)
            if (rig->loop.info.electrode[j] == (uint8_t)state)
                return t;
    }
    return -1;
}

/* Bits flip while the detector searches for a dead electrode, and in its test pulse. */
static void test_detector(void **state)
{
    static flip_rig rig;
    (void)state;
    open_loop(&rig, &dead);
    const long tested = first_tick(&rig, &dead.window, PZS_ELECTRODE_TESTED);
    const long held = first_tick(&rig, &dead.window, PZS_ELECTRODE_HELD);
    printf("# first test pulse in tick %ld, electrode held in tick %ld\n", tested, held);
    assert_true(tested > dead.window.first && held > tested && held < dead.window.moving);
    try_window(&rig, &dead);
    flip_rig_close(&rig);
}

/* Assert that the polarity test of a loop is inside the ticks of its window in which bits flip. */
static void check_test(flip_rig *rig, const flip_window *window, pzs_supervisor_mode end)
{
    const pzs_supervisor *supervisor = pzs_loop_find(&rig->loop, &pzs_supervisor_block);
    long from = -1, to = -1;
    flip_rig_begin(rig);
    for (long t = 0; t < window->ticks; t++) {
        (void)flip_rig_tick(rig, flip_rig_factor(window, t));
        (void)flip_rig_take(rig);
        const bool is_testing = supervisor->info.mode == PZS_MODE_TESTING;
        from = is_testing && from < 0 ? t : from;
        to = is_testing ? t : to;
    }
    printf("# polarity test in ticks %ld to %ld\n", from, to);
    assert_int_equal(supervisor->info.mode, end);
    assert_true(from >= window->first && to > from && to < window->moving);
}

static void try_polarity(const loop_case *loop, pzs_supervisor_mode end)
{
    static flip_rig rig;
    open_loop(&rig, loop);
    check_test(&rig, &loop->window, end);
    try_window(&rig, loop);
    flip_rig_close(&rig);
}

/* Bits flip in a polarity test of the supervisor, which a healthy structure passes. */
static void test_polarity(void **state)
{
    (void)state;
    try_polarity(&loaded, PZS_MODE_RUNNING);
}

/* Bits flip in a polarity test, and in the ramp to the park voltages that follows. */
static void test_reversed(void **state)
{
    (void)state;
    make_tolerant();
    try_polarity(&reversed, PZS_MODE_LATCHED);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_limits),   cmocka_unit_test(test_gate),
        cmocka_unit_test(test_healthy),  cmocka_unit_test(test_detector),
        cmocka_unit_test(test_polarity), cmocka_unit_test(test_reversed)};
    return cmocka_run_group_tests_name("watched_flips", tests, NULL, NULL);
}
