/*
 * The gain monitor of the supervisor, with modes that follow exact recursions.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <cmocka.h>
#include "../../lib/control/polarity_gain.h"
#include "../rigs/uniform.h"

enum { MODES = 4, PERIOD = 63 };
#define FIRST_ANGLE 0.1 /* turned by the first mode in a tick (rad) */

/* Modes under voltages, and the tables and signals with which the monitor sees them. */
typedef struct rig {
    pzs_vibration vibration;
    pzs_loop_signals signals;
    pzs_supervision supervision;
    pzs_gain_state gain;
    pzs_real turn[4 * MODES], inverse_angle[MODES], position[MODES], rest[MODES];
    double angle[MODES], deviation[MODES], velocity[MODES];
    double factor; /* true gain of the structure */
    unsigned seed;
    bool is_reversed; /* result of the last tick */
} rig;

/* Modes that turn by `first` times 1, 2, 4 and 8 in a tick, with a damping ratio of 0.005. */
static void open_rig(rig *r, double first, double factor)
{
    memset(r, 0, sizeof *r);
    for (size_t i = 0; i < MODES; i++) {
        r->angle[i] = first * pow(2, (double)i);
        const double kept = exp(-0.005 * r->angle[i]), c = kept * cos(r->angle[i]),
                     s = kept * sin(r->angle[i]);
        r->turn[i] = r->turn[3 * MODES + i] = (pzs_real)c;
        r->turn[MODES + i] = (pzs_real)s;
        r->turn[2 * MODES + i] = (pzs_real)-s;
        r->inverse_angle[i] = (pzs_real)(1 / r->angle[i]);
    }
    r->vibration.modes = MODES;
    r->vibration.turn = r->turn;
    r->vibration.inverse_angle = r->inverse_angle;
    r->signals.vibration = &r->vibration;
    r->signals.modal_position = r->position;
    r->signals.modal_rest = r->rest;
    r->supervision.polarity_ticks = PERIOD;
    r->supervision.load = PZS_R(0.1);
    r->factor = factor;
    r->seed = 1;
    pzs_polarity_gain_begin(&r->gain, &r->signals);
}

/* Advance the modes by a tick under the present voltages, and then let the monitor judge. */
static void run_tick(rig *r)
{
    for (size_t i = 0; i < MODES; i++) {
        const double d = r->deviation[i], v = r->velocity[i];
        r->deviation[i] = (double)r->turn[i] * d + (double)r->turn[MODES + i] * v;
        r->velocity[i] = (double)r->turn[2 * MODES + i] * d + (double)r->turn[3 * MODES + i] * v;
        r->position[i] = (pzs_real)(r->factor * (double)r->rest[i] + r->deviation[i]);
    }
    r->is_reversed = pzs_polarity_gain_is_reversed(&r->gain, &r->supervision, &r->signals, false);
}

/* Move the static positions of all modes by random amounts of up to `size`, now and then. */
static void move_voltages(rig *r, double size)
{
    if (uniform(&r->seed, 0, 1) < 0.9)
        return;
    for (size_t i = 0; i < MODES; i++) {
        const pzs_real before = r->rest[i];
        r->rest[i] = (pzs_real)uniform(&r->seed, -size, size);
        r->deviation[i] -= r->factor * ((double)r->rest[i] - (double)before);
    }
}

/*
 * Law: where nothing but the voltages moves the modes, and they respond with a gain k, the filtered
 * deviation from the model is (k - 1) times the filtered motion, also in its squares. The filter
 * takes differences of the order of the angle, so that rounding errors are epsilon / angle^2.
 */
static void gain_is_that_of_the_structure(void **state)
{
    static const double first[] = {0.02, 0.1, 0.25}, factor[] = {-1.33, -1, -0.8, 0.8, 1.33};
    (void)state;
    for (int k = 0; k < 15; k++) {
        rig r;
        const double angle = first[k / 5], excess = factor[k % 5] - 1;
        const double tolerance = 50 * (double)PZS_EPSILON / (angle * angle);
        open_rig(&r, angle, factor[k % 5]);
        for (int tick = 0; tick < 1000; tick++) {
            move_voltages(&r, 1);
            run_tick(&r);
        }
        const double ratio = (double)(r.gain.product / r.gain.moved);
        const double square = (double)(r.gain.deviation / r.gain.moved);
        assert_true(fabs(ratio - excess) <= tolerance * fabs(excess));
        assert_true(fabs(square - excess * excess) <= 2 * tolerance * excess * excess);
    }
}

/*
 * Law: the observers have three equal eigenvalues r = 1 / (1 + angle). After a load has moved a
 * mode to 1, the estimated positions q of successive ticks obey
 *     q(3) - 3 r q(2) + 3 r^2 q(1) - r^3 q(0) = (1 - r)^3.
 */
static void observers_have_three_equal_eigenvalues(void **state)
{
    static const double first[] = {0.002, 0.02, 0.1, 0.25};
    (void)state;
    for (int k = 0; k < 4; k++) {
        rig r;
        double q[4][MODES];
        open_rig(&r, first[k], 1);
        for (size_t i = 0; i < MODES; i++)
            r.deviation[i] = 0;
        for (int tick = 0; tick < 40; tick++) {
            for (size_t i = 0; i < MODES; i++)
                r.position[i] = 1;
            (void)pzs_polarity_gain_is_reversed(&r.gain, &r.supervision, &r.signals, false);
            memmove(q, q + 1, 3 * sizeof *q);
            for (size_t i = 0; i < MODES; i++)
                q[3][i] = (double)r.gain.measured.position[i];
            for (size_t i = 0; i < MODES && tick >= 3; i++) {
                const double p = r.angle[i] / (1 + r.angle[i]), e = 1 - p;
                const double sum =
                    q[3][i] - 3 * e * q[2][i] + 3 * e * e * q[1][i] - e * e * e * q[0][i];
                assert_true(fabs(sum - p * p * p) <= 50 * (double)PZS_EPSILON);
            }
        }
    }
}

/*
 * Law: a reversed gain is an alarm after one and a half periods in which the motion is judged, and
 * after at most two periods altogether; gains of 0 to 1.33, and of -3, as where a load moves the
 * structure, are none, and neither is a reversed gain while the structure shakes or moves less than
 * is judged.
 */
static void reversed_gains_are_found(void **state)
{
    static const double factor[] = {-1.33, -1, -0.5, 0, 0.8, 1.33, -3};
    (void)state;
    for (int k = 0; k < 7; k++) {
        rig r;
        int tick = 0;
        open_rig(&r, FIRST_ANGLE, factor[k]);
        for (; tick < 20 * PERIOD && !r.is_reversed; tick++) {
            move_voltages(&r, 1);
            run_tick(&r);
        }
        if (factor[k] < 0 && factor[k] > -2)
            assert_in_range(tick, 3 * PERIOD / 2, 2 * PERIOD);
        else
            assert_false(r.is_reversed);
        open_rig(&r, FIRST_ANGLE, factor[k]);
        for (tick = 0; tick < 20 * PERIOD; tick++) {
            move_voltages(&r, 1e-4);
            run_tick(&r);
            assert_false(r.is_reversed);
        }
        open_rig(&r, FIRST_ANGLE, factor[k]);
        for (tick = 0; tick < 20 * PERIOD; tick++) {
            move_voltages(&r, 1);
            run_tick(&r);
            r.gain.reversed = 0;
            assert_false(pzs_polarity_gain_is_reversed(&r.gain, &r.supervision, &r.signals, true));
        }
    }
}

/* Let the structure stand still at zero voltages, for so long that the observers forget. */
static void be_still(rig *r, int ticks)
{
    memset(r->rest, 0, sizeof r->rest);
    memset(r->deviation, 0, sizeof r->deviation);
    memset(r->velocity, 0, sizeof r->velocity);
    for (int tick = 0; tick < ticks; tick++)
        run_tick(r);
}

/* Store a value that damaged memory may hold. */
static void damage(rig *r, size_t word, int kind)
{
    static const pzs_real value[] = {PZS_R(1e30), PZS_R(-1e30), PZS_R(1e15), -1, HUGE_VAL, NAN};
    if (kind == 6)
        memset((uint32_t *)(void *)&r->gain + word, 0xFF, sizeof(uint32_t));
    else
        memcpy((pzs_real *)(void *)&r->gain + word * sizeof(uint32_t) / sizeof(pzs_real),
               &value[kind], sizeof *value);
}

/*
 * Law: a damaged number of the monitor raises no alarm in a healthy loop, and its effect fades by e
 * in 1.5 periods, or the estimate starts again: after 60 periods a reversed gain is found within
 * three.
 */
static void damage_fades(void **state)
{
    (void)state;
    const size_t reals = offsetof(pzs_gain_state, turn) / sizeof(uint32_t);
    for (size_t word = 0; word < reals + 2; word++)
        for (int kind = word >= reals ? 6 : 0; kind < 7; kind++) {
            rig r;
            open_rig(&r, FIRST_ANGLE, 1);
            for (int tick = 0; tick < 60 * PERIOD; tick++) {
                if (tick == 2 * PERIOD)
                    damage(&r, word, kind);
                move_voltages(&r, 1);
                run_tick(&r);
                assert_false(r.is_reversed);
            }
            be_still(&r, 5 * PERIOD);
            r.factor = -1;
            int tick = 0;
            for (; tick < 3 * PERIOD && !r.is_reversed; tick++) {
                move_voltages(&r, 1);
                run_tick(&r);
            }
            assert_in_range(tick, 1, 3 * PERIOD - 1);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(gain_is_that_of_the_structure),
                                       cmocka_unit_test(observers_have_three_equal_eigenvalues),
                                       cmocka_unit_test(reversed_gains_are_found),
                                       cmocka_unit_test(damage_fades)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
