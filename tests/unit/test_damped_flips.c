/*
 * Damaged working memory of loops that damp vibration, with governor, compensation of hysteresis
 * and supervisor, on a plate that vibrates, with readings of the present tick and of two ticks ago:
 * whatever bit flips, no voltage leaves its limits in flash, its step limit or the finite numbers,
 * no tick hangs, and the loop is soon where a loop without damage is, or says by a status what has
 * happened. Large errors in what controller, damper and governor keep from tick to tick do not move
 * the shape.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>
#include "../rigs/flip_rig.h"
#include "damped_plate.h"
#include "late_plate.h"

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
    (SHORT / 200) /* flips that are followed until the loop is compared with one without damage */
#endif

enum {
    N = PLATE_INPUTS,
    M = PLATE_OUTPUTS,
    WIDTH = (PLATE_MODES + 3) / 4 * 4,
    PERIOD = 400, /* ticks of a rectangular target */
    PHASE = 300,  /* ticks in which the loop settles, and in which damage is followed */
    RENEWED = 200 /* flips after which the loop starts anew */
};

static const flip_plant plant = {
    .problem = &plate_problem, .target = plate_target, .vibration = &plate_vibration};
static const flip_plant late_plant = {
    .problem = &late_problem, .target = late_target, .vibration = &late_vibration};

/* Open the loop with readings of the present tick, or that with late readings. */
static void open_plate(flip_rig *rig, bool is_late)
{
    if (is_late)
        flip_rig_open(rig, &late_plant, late_blocks, LATE_BLOCKS);
    else
        flip_rig_open(rig, &plant, plate_blocks, PLATE_BLOCKS);
}

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

/* Law: after each flip, two ticks whose voltages are finite and inside limits and step limits. */
static void test_limits(void **state)
{
    (void)state;
    for (int is_late = 0; is_late < 2; is_late++) {
        static flip_rig rig;
        open_plate(&rig, is_late != 0);
        assert_int_equal(flip_rig_limits(&rig, FLIPS, wave, RENEWED).beyond, 0);
        flip_rig_close(&rig);
    }
}

/*
 * Law: a loop with a flipped bit ends where a loop without one ends, or a status has told of the
 * damage; on the way the shape differs by less than the target.
 */
static void test_harmless(void **state)
{
    static const flip_window window = {.moving = 300, .ticks = 900, .wave = jump};
    (void)state;
    for (int is_late = 0; is_late < 2; is_late++) {
        static flip_rig rig;
        open_plate(&rig, is_late != 0);
        const flip_count count = flip_rig_harmless(&rig, WINDOWS, &window);
        assert_int_equal(count.beyond + count.silent, 0);
        assert_true(count.largest < 1);
        flip_rig_close(&rig);
    }
}

/*
 * Number `which` of those that controller, damper and governor keep from tick to tick: voltages,
 * gradients, predicted shapes, states of modes, ring buffers, low-passed readings, voltages of the
 * governor.
 */
static pzs_real *kept_number(const flip_rig *rig, int which)
{
    pzs_damper *damper = pzs_loop_find(&rig->loop, &pzs_vibration_block);
    pzs_governor_state *governor = pzs_loop_find(&rig->loop, &pzs_governor_block);
    pzs_control_state *control = &rig->loop.info.control->state;
    pzs_real *const kept[] = {control->predicted + M / 2,
                              control->voltage + N / 2,
                              control->optimiser.base + N / 2,
                              control->optimiser.regularisation_gradient + N / 2,
                              control->optimiser.model_gradient + N / 2,
                              damper->state.late,
                              damper->state.late + WIDTH,
                              damper->state.late + 2 * WIDTH,
                              damper->state.now + WIDTH,
                              damper->state.residual_modes,
                              damper->state.equilibrium,
                              damper->state.expected + M / 2,
                              damper->state.residual + M / 2,
                              governor->reference + N / 2,
                              governor->optimal + N / 2,
                              governor->optimum.state.predicted + M / 2,
                              governor->optimum.state.optimiser.regularisation_gradient + N / 2,
                              governor->optimum.state.optimiser.model_gradient + N / 2,
                              governor->optimum.state.voltage + N / 2};
    return which < (int)(sizeof kept / sizeof *kept) ? kept[which] : NULL;
}

/* The target jumps when the damage has been followed. */
static pzs_real late_jump(long tick)
{
    return tick < 2 * PHASE ? 1 : PZS_R(0.3);
}

static const flip_window kept_window = {.moving = 2 * PHASE, .ticks = 4 * PHASE, .wave = late_jump};

/*
 * Largest difference between a loop without damage and one of which number `which` is wrong by
 * `error`: while the target stands still, and at the end, after it has jumped. On the way after the
 * jump even rounding errors make a difference, because the optimiser stops before the exact
 * optimum.
 */
static double largest_difference(flip_rig *rig, const flip_run *healthy, int which, pzs_real error)
{
    double most = 0;
    flip_rig_begin(rig);
    for (int t = 0; t < kept_window.ticks; t++) {
        if (t == PHASE)
            *kept_number(rig, which) += error;
        assert_int_equal(flip_rig_tick(rig, late_jump(t)), healthy->status[t]);
        assert_int_equal(flip_rig_take(rig), 0);
        if (t < 2 * PHASE || t == kept_window.ticks - 1)
            most = fmax(most, flip_rig_difference(rig->plant, rig->given, healthy->given + t * N));
    }
    return most;
}

/*
 * Law: an error of 1 m (or 1 V) to 1e30 m in one number that controller, damper or governor keep
 * changes the shape by less than a thousandth of the target, also after a later jump of the target.
 * Before these numbers were checked, 1e15 m in one low-passed reading kept the voltages at their
 * limits for thousands of ticks.
 */
static void test_kept_numbers(void **state)
{
    static const pzs_real error[] = {1, PZS_R(1e6), PZS_R(1e15), PZS_R(1e30), (pzs_real)NAN};
    (void)state;
    for (int is_late = 0; is_late < 2; is_late++) {
        static flip_rig rig;
        double worst = 0;
        int which = 0;
        open_plate(&rig, is_late != 0);
        const flip_run healthy = flip_rig_run(&rig, &kept_window);
        for (; kept_number(&rig, which) != NULL; which++)
            for (size_t k = 0; k < sizeof error / sizeof *error; k++)
                worst = fmax(worst, largest_difference(&rig, &healthy, which, error[k]));
        printf("# %d kept numbers: shape moved by %.1e of the target at most\n", which, worst);
        assert_true(worst < 1e-3);
        flip_rig_close(&rig);
        flip_run_close(&healthy);
    }
}

/*
 * Law: the iterations of a tick are bounded by the number of inputs, and its work by the work limit
 * of the tables, also where damage has raised the work limit and changes the optimiser. An entry of
 * the free set between 0 and 1 once made the iterations endless.
 */
static void test_work(void **state)
{
    static flip_rig rig;
    uint32_t most = 0;
    (void)state;
    open_plate(&rig, false);
    for (long k = 0; k < 5L * FLIPS; k++) {
        pzs_control *control = rig.loop.info.control;
        control->settings.work_limit = UINT64_C(1) << 26;
        flip(control->state.work, (size_t)(flip_rig_draw(&rig) % (8 * PZS_CONTROL_BYTES(N, M))));
        const pzs_status status = flip_rig_tick(&rig, wave(k));
        assert_int_equal(flip_rig_take(&rig), 0);
        assert_true(control->info.work <= PZS_WORK_LIMIT(N));
        const uint32_t iterations = control->state.optimiser.iterations;
        most = iterations > most ? iterations : most;
        if (PZS_IS_ERROR(status) || k % RENEWED == RENEWED - 1)
            flip_rig_restart(&rig);
    }
    printf("# %u iterations in a tick at most\n", (unsigned)most);
    assert_true(most <= 8 * (4 * N + 16));
    flip_rig_close(&rig);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_limits), cmocka_unit_test(test_harmless),
        cmocka_unit_test(test_kept_numbers), cmocka_unit_test(test_work)};
    return cmocka_run_group_tests_name("damped_flips", tests, NULL, NULL);
}
