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
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../rigs/damage_block.h"
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

enum {
    N = PLATE_INPUTS,
    M = PLATE_OUTPUTS,
    S = PLATE_SENSORS,
    FIRST_SENSOR = M - S,
    BLOCKS = 7,
    PERIOD = 60,
    WINDOW = 160, /* ticks: two rounds of the slowest scrub that repairs, and the way back */
    SETTLED = 100 /* ticks of a window after which the target stands still */
};

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

static uint64_t seed = 1;

static uint64_t draw(void)
{
    uint64_t z = seed += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* ---- rig ----------------------------------------------------------------- */

typedef struct rig {
    flip_damage damage;
    pzs_block block[BLOCKS];
    pzs_loop loop;
    void *work;
    size_t bytes;
    pzs_real given[N]; /* what the amplifiers received last (V) */
    pzs_real load;
} rig;

static void init(rig *r)
{
    r->damage = (flip_damage){.bytes = PZS_CONTROL_BYTES(N, M)};
    assert_int_equal(pzs_loop_init(&r->loop, r->block, BLOCKS, NULL, r->work, r->bytes), PZS_OK);
    assert_int_equal(pzs_loop_know(&r->loop, &r->load, &r->load), PZS_OK);
}

static void open_rig(rig *r)
{
    pzs_real none;
    memset(r, 0, sizeof *r);
    r->block[0] = (pzs_block){&pzs_feed_forward_block, &known_loads};
    r->block[1] = (pzs_block){&pzs_estimator_block, &plate_estimator};
    r->block[2] = (pzs_block){&pzs_step_block, &plate_problem};
    r->block[3] = (pzs_block){&pzs_amplifier_block, &amplifier};
    r->block[4] = (pzs_block){&flip_block, &r->damage};
    r->block[5] = (pzs_block){&pzs_fault_detector_block, &detection};
    r->block[6] = (pzs_block){&pzs_supervisor_block, &supervision};
    supervision.scene = plate_problem.scene;
    assert_int_equal(pzs_supervision_seal(&supervision), PZS_OK);
    assert_int_equal(pzs_loop_init(&r->loop, r->block, BLOCKS, NULL, &none, 0), PZS_E_WORKSPACE);
    r->bytes = (size_t)r->loop.info.where;
    r->work = malloc(r->bytes);
    assert_non_null(r->work);
    init(r);
    memcpy(r->given, r->loop.info.voltage, sizeof r->given);
}

/* Start anew from the voltages that the amplifiers give. */
static void restart(rig *r)
{
    init(r);
    assert_int_equal(pzs_loop_start(&r->loop, r->given), PZS_OK);
}

static void close_rig(rig *r)
{
    free(r->work);
}

/* 1 to -1 and back. */
static pzs_real wave(int tick)
{
    const int phase = tick % PERIOD;
    return (pzs_real)(phase < PERIOD / 2 ? PERIOD / 4 - phase : phase - PERIOD * 3 / 4) /
           (PERIOD / 4);
}

/* One tick with a plant that is weaker than the tables say. */
static pzs_status tick(rig *r, pzs_real factor)
{
    pzs_real wanted[M], sensed[S];
    r->load = factor > 0 ? 1 : 0;
    for (int i = 0; i < M; i++)
        wanted[i] = factor * plate_target[i];
    for (int s = 0; s < S; s++) {
        const int i = FIRST_SENSOR + s;
        sensed[s] = r->load * plate_shape_per_load[i];
        for (int j = 0; j < N; j++)
            sensed[s] += PZS_R(0.9) * plate_influence[i * N + j] * r->given[j];
    }
    return pzs_loop_tick(&r->loop, wanted, sensed);
}

/*
 * Take the voltages as an amplifier does. Returns how many are not finite, beyond their limits or
 * beyond their step limit; a held input may go to its held voltage.
 */
static int take(rig *r)
{
    int bad = 0;
    const pzs_real *voltage = r->loop.info.voltage;
    pzs_real *const *held = r->loop.info.control->state.held;
    for (int j = 0; j < N; j++) {
        const pzs_real v = voltage[j], change = v < r->given[j] ? r->given[j] - v : v - r->given[j];
        const bool is_held = v >= held[0][j] && v <= held[0][j];
        bad += !isfinite(v) || !(v >= plate_lower[j] && v <= plate_upper[j]);
        bad += !(change <= plate_step_limit[j]) && !is_held;
        r->given[j] = v;
    }
    return bad;
}

/* Flip one bit of the loop or its workspace, now or inside the next tick. */
static void damage(rig *r)
{
    const size_t bytes = sizeof r->loop + r->bytes, bit = (size_t)(draw() % (8 * bytes));
    r->damage.is_due = draw() % 4 == 0;
    r->damage.bit = bit;
    if (r->damage.is_due)
        return;
    if (bit < 8 * sizeof r->loop)
        flip(&r->loop, bit);
    else
        flip(r->work, bit - 8 * sizeof r->loop);
}

/* ---- tests ----------------------------------------------------------------- */

/* Law: after each flip, two ticks whose voltages are finite and inside limits and step limits. */
static void test_limits(void **state)
{
    static rig r;
    long bad = 0, warned = 0, failed = 0;
    (void)state;
    open_rig(&r);
    for (long k = 0; k < FLIPS; k++) {
        damage(&r);
        for (int after = 0; after < 2; after++) {
            const pzs_status status = tick(&r, wave((int)(2 * k + after)));
            r.damage.is_due = false;
            bad += take(&r);
            warned += status == PZS_W_OUTPUT;
            failed += PZS_IS_ERROR(status);
            if (PZS_IS_ERROR(status))
                restart(&r);
        }
    }
    printf(
        "# %ld flips: %ld voltages beyond a limit, %ld ticks corrected by the gate, %ld errors\n",
        (long)FLIPS, bad, warned, failed);
    assert_int_equal(bad, 0);
    close_rig(&r);
}

/* Relative difference of the shapes that two sets of voltages make. */
static double difference(const pzs_real *one, const pzs_real *other)
{
    double square = 0, all = 0;
    for (int i = 0; i < M; i++) {
        double sum = 0;
        for (int j = 0; j < N; j++)
            sum += (double)(plate_influence[i * N + j] * (one[j] - other[j]));
        square += sum * sum;
        all += (double)plate_target[i] * (double)plate_target[i];
    }
    return sqrt(square / all);
}

/*
 * Law: a loop with a flipped bit ends where a loop without one ends, within a thousandth of the
 * target, or a status has told of the damage.
 */
static void test_harmless(void **state)
{
    static rig r, healthy;
    long told = 0, silent = 0;
    double worst = 0;
    (void)state;
    open_rig(&healthy);
    open_rig(&r);
    for (long k = 0; k < WINDOWS; k++) {
        bool is_told = false;
        init(&r);
        init(&healthy);
        memcpy(r.given, r.loop.info.voltage, sizeof r.given);
        memcpy(healthy.given, healthy.loop.info.voltage, sizeof healthy.given);
        const long at = (long)(draw() % (SETTLED / 2));
        for (int t = 0; t < WINDOW; t++) {
            if (t == at)
                damage(&r);
            const pzs_real factor = wave(t < SETTLED ? t : SETTLED);
            const pzs_status status = tick(&r, factor), expected = tick(&healthy, factor);
            r.damage.is_due = false;
            is_told |= status != expected;
            assert_int_equal(take(&r) + take(&healthy), 0);
        }
        const double far = difference(r.given, healthy.given);
        worst = far > worst && !is_told ? far : worst;
        told += is_told;
        silent += !is_told && !(far < 1e-3);
    }
    printf("# %ld flips: %ld reported by a status, %ld silent ones end elsewhere, worst %.1e\n",
           (long)WINDOWS, told, silent, worst);
    assert_int_equal(silent, 0);
    close_rig(&r);
    close_rig(&healthy);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_limits),
                                       cmocka_unit_test(test_harmless)};
    return cmocka_run_group_tests_name("flips", tests, NULL, NULL);
}
