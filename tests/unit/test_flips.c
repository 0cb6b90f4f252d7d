/*
 * Flipped bits of the working memory of a loop on the demonstration's plate: whatever bit of the
 * loop or of its workspace flips, between two ticks or inside one, no voltage leaves its limits in
 * flash, its step limit or the finite numbers, and the loop is soon where a loop without damage is,
 * or says by a status what has happened.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include "../rigs/flip_rig.h"
#include "gate_plate.h"

#ifdef __SANITIZE_ADDRESS__
#define SHORT 2000
#else
#define SHORT 10000
#endif
#ifndef FLIPS
#define FLIPS SHORT /* flips that are followed by two ticks */
#endif
#ifndef WINDOWS
#define WINDOWS                                                                                    \
    (SHORT / 100) /* flips that are followed until the loop is compared with one without damage */
#endif

enum { BLOCKS = 6, PERIOD = 60 };

static const pzs_known_loads known_loads = {&plate_shape_feed_forward, &plate_reading_feed_forward};
static const pzs_amplifier amplifier = {0, 0};
static const pzs_fault_detection detection = {0, 0};
static pzs_supervision supervision = {.inputs = PLATE_INPUTS,
                                      .ramp_ticks = 1,
                                      .alarm_ticks = 20,
                                      .polarity_ticks = 20,
                                      .park = plate_reference_voltage,
                                      .fading = PZS_R(0.98),
                                      .noise = PZS_R(1e-7),
                                      .load = PZS_R(1e-4)};
static const pzs_block blocks[BLOCKS] = {
    {&pzs_feed_forward_block, &known_loads}, {&pzs_estimator_block, &plate_estimator},
    {&pzs_step_block, &plate_problem},       {&pzs_amplifier_block, &amplifier},
    {&pzs_fault_detector_block, &detection}, {&pzs_supervisor_block, &supervision}};
static const flip_plant plant = {.problem = &plate_problem,
                                 .target = plate_target,
                                 .load = plate_shape_per_load,
                                 .first_sensor = PLATE_OUTPUTS - PLATE_SENSORS};

/* 1 to -1 and back. */
static pzs_real wave(long tick)
{
    const long phase = tick % PERIOD;
    return (pzs_real)(phase < PERIOD / 2 ? PERIOD / 4 - phase : phase - PERIOD * 3 / 4) /
           (PERIOD / 4);
}

static void open_plate(flip_rig *rig)
{
    supervision.scene = plate_problem.scene;
    assert_int_equal(pzs_supervision_seal(&supervision), PZS_OK);
    flip_rig_open(rig, &plant, blocks, BLOCKS);
}

/* Law: after each flip, two ticks whose voltages are finite and inside limits and step limits. */
static void test_limits(void **state)
{
    static flip_rig rig;
    (void)state;
    open_plate(&rig);
    assert_int_equal(flip_rig_limits(&rig, FLIPS, wave, 0).beyond, 0);
    flip_rig_close(&rig);
}

/*
 * Law: a loop with a flipped bit ends where a loop without one ends, or a status has told of the
 * damage. The window has two rounds of the slowest scrub that repairs, and the way back.
 */
static void test_harmless(void **state)
{
    static const flip_window window = {.moving = 50, .ticks = 160, .wave = wave};
    static flip_rig rig;
    (void)state;
    open_plate(&rig);
    const flip_count count = flip_rig_harmless(&rig, WINDOWS, &window);
    assert_int_equal(count.beyond + count.silent, 0);
    flip_rig_close(&rig);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_limits),
                                       cmocka_unit_test(test_harmless)};
    return cmocka_run_group_tests_name("flips", tests, NULL, NULL);
}
