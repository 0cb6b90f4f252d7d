/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Gain monitor of the supervisor. A structure of gain k (1: as the model; 0.8 to 1.33 tolerated;
 * about -1: amplifiers of the wrong polarity) moves its vibration modes by
 *
 *     y = k x + (loads, noise)
 *
 *   x  motion of a mode under the voltages alone, by the model (m)
 *   y  measured motion of the mode (m)
 *
 * Both pass the same filter: the prediction error of an observer of the mode that knows no voltages
 * and takes every motion for that of a load. The filter forgets within about a third of a period
 * what stays or changes slowly. With its outputs X and Y in the lowest modes, and with sums over
 * the modes and, decaying, over the last 1.5 periods of the first mode, the monitor computes
 *
 *     k = 1 + <Y - X, X> / <X, X>,    share = <Y - X, X>^2 / (<Y - X, Y - X> <X, X>)
 *
 * The share tells which part of the deviation Y - X is explained by a wrong gain. The polarity is
 * wrong if, for 1.5 periods,
 *
 *     MOST_REVERSED < k < LEAST_REVERSED,    share > LEAST_SHARE,    |X| > least
 *
 * A loop that compensates a load moves the voltages against it, so that Y - X is opposite to X, as
 * with a wrong polarity. But a healthy loop does not move the structure further than the load does:
 * k is then about 0. It is lower only while the voltages follow late, or cannot follow because of
 * their limits, and then Y - X does not have the course of X, and the share is small.
 *
 * The observer of a mode has the states position, velocity / angular frequency and static position
 * under loads, and three equal eigenvalues r = 1 / (1 + angle), where the angle is that by which
 * the mode turns in a tick. Its gains follow from the 2 x 2 matrix T of the mode. With p = 1 - r
 * and D = det(I - T):
 *
 *     load      p^3 / D
 *     position  1 - r^3 / det T
 *     velocity  from the trace of the matrix of the prediction error, which is 3 r
 *
 * Work of a tick: about 45 operations for each of at most PZS_GAIN_MODES modes, and 60 in addition.
 */
#include <string.h>
#include "polarity_gain.h"
#include "polarity.h"

/*
 * The gain counts as reversed between these bounds. A reversed gain is -1.33 to -0.8, and up to 0.5
 * more where 30 % hysteresis takes a part of the motion.
 */
#define LEAST_REVERSED PZS_R(-0.4)
#define MOST_REVERSED (-2)
/* Smallest part of the deviation from the model that a reversed gain explains. */
#define LEAST_SHARE PZS_R(0.93)
/* Rounding errors do not raise the share above this number, but damaged memory does. */
#define MOST_SHARE PZS_R(1.01)
/*
 * The gain is judged where the motion X exceeds this part of the smallest motion that the polarity
 * monitor judges (polarity.h), which makes a tenth of the largest expected sudden load.
 */
#define LEAST_PART PZS_R(0.05)
/*
 * Sums of squares that exceed the smallest one that is judged by this factor are those of damaged
 * memory, or of loads a million times as large as the monitor expects: the estimate starts again.
 */
#define MOST_SQUARE PZS_R(1e12)
/*
 * Number of half periods of the first mode in which the sums decay by e, and for which the gain has
 * to be reversed until an alarm.
 */
#define LONG_HALVES 3u

/* The 2 x 2 matrix by which one mode turns in a tick (pzs_vibration.turn). */
typedef struct turn {
    pzs_real pp, pv, vp, vv;
} turn;

static turn turn_of(const pzs_vibration *tables, size_t mode)
{
    const pzs_real *entry = tables->turn + mode;
    const size_t modes = tables->modes;
    return (turn){entry[0], entry[modes], entry[2 * modes], entry[3 * modes]};
}

/*
 * Compute the corrections of the observer of a mode (formulas above). The differences from 1 keep
 * their digits where the mode turns by a small angle.
 *   correction [3] out  of position, velocity and load, per prediction error
 */
static void correct(pzs_real *correction, const pzs_vibration *tables, size_t mode)
{
    const turn t = turn_of(tables, mode);
    const pzs_real speed = 1 / (1 + tables->inverse_angle[mode]), square = speed * speed;
    const pzs_real determinant = t.pp * t.vv - t.pv * t.vp, lost = 1 - determinant;
    const pzs_real still = (1 - t.pp) * (1 - t.vv) - t.pv * t.vp;
    const pzs_real curved = (3 - speed) * square, inverse = 1 / determinant;
    const pzs_real load = square * speed / still;
    const pzs_real position = (3 * speed - curved - lost) * inverse;
    const pzs_real rest = (lost * (1 - 3 * speed) + curved) * inverse - (1 - t.vv);
    correction[0] = position;
    correction[1] = (rest + (1 - t.pp) * (position - 1 - load)) / t.pv;
    correction[2] = load;
}

/*
 * Advance both observers of one mode by a tick.
 *   motion [2] out  filtered measured motion Y and filtered motion X under the voltages (m). The
 *                   observer of X has the model's motion subtracted from its state, so that its
 *                   prediction error is -X
 */
static void observe(pzs_gain_state *gain, size_t mode, const pzs_loop_signals *signals,
                    pzs_real motion[2])
{
    pzs_gain_filter *measured = &gain->measured, *predicted = &gain->predicted;
    const turn t = turn_of(signals->vibration, mode);
    const pzs_real *correction = gain->correction[mode];
    const pzs_real position = correction[0], velocity = correction[1], load = correction[2];
    const pzs_real rest = measured->load[mode], speed = measured->velocity[mode];
    const pzs_real deviation = measured->position[mode] - rest;
    const pzs_real now = rest + (t.pp * deviation + t.pv * speed);
    const pzs_real wrong = signals->modal_position[mode] - now;
    measured->position[mode] = now + position * wrong;
    measured->velocity[mode] = t.vp * deviation + t.vv * speed + velocity * wrong;
    measured->load[mode] = rest + load * wrong;
    const pzs_real pull = predicted->load[mode], rate = predicted->velocity[mode];
    const pzs_real driven = signals->modal_rest[mode] + pull;
    const pzs_real distance = predicted->position[mode] - driven;
    const pzs_real next = driven + (t.pp * distance + t.pv * rate);
    predicted->position[mode] = next - position * next;
    predicted->velocity[mode] = t.vp * distance + t.vv * rate - velocity * next;
    predicted->load[mode] = pull - load * next;
    motion[0] = wrong;
    motion[1] = next;
}

static size_t modes_of(const pzs_loop_signals *signals)
{
    const size_t modes = signals->vibration->modes;
    return modes < PZS_GAIN_MODES ? modes : PZS_GAIN_MODES;
}

void pzs_polarity_gain_begin(pzs_gain_state *gain, const pzs_loop_signals *signals)
{
    const size_t modes = modes_of(signals);
    memset(gain, 0, sizeof *gain);
    for (size_t i = 0; i < modes; i++) {
        correct(gain->correction[i], signals->vibration, i);
        gain->measured.position[i] = signals->modal_position[i];
        gain->measured.load[i] = signals->modal_position[i];
        gain->predicted.load[i] = -signals->modal_rest[i];
    }
}

/* Add the motions of this tick to the decaying sums of squares and products. */
static void add_motions(pzs_gain_state *gain, const pzs_loop_signals *signals, pzs_real fading)
{
    const size_t modes = modes_of(signals), turning = gain->turn % PZS_GAIN_MODES;
    pzs_real moved = 0, product = 0, deviation = 0;
    if (turning < modes)
        correct(gain->correction[turning], signals->vibration, turning);
    for (size_t i = 0; i < modes; i++) {
        pzs_real motion[2];
        observe(gain, i, signals, motion);
        const pzs_real missed = motion[0] - motion[1];
        moved += motion[1] * motion[1];
        product += missed * motion[1];
        deviation += missed * missed;
    }
    gain->turn++;
    gain->moved = fading * gain->moved + moved;
    gain->product = fading * gain->product + product;
    gain->deviation = fading * gain->deviation + deviation;
}

/*
 * Whether the sums are those of a reversed gain.
 *   least in  smallest sum of squares of the motion that is judged (m2)
 */
static bool seems_reversed(const pzs_gain_state *gain, pzs_real least)
{
    if (!(gain->moved > least) || !(gain->deviation > 0))
        return false;
    const pzs_real excess = gain->product / gain->moved;
    const pzs_real share = excess * (gain->product / gain->deviation);
    return excess > MOST_REVERSED - 1 && excess < LEAST_REVERSED - 1 && share > LEAST_SHARE;
}

/* Whether the sums can be true: damaged memory may make them infinite, or their share above 1. */
static bool are_sums_valid(const pzs_gain_state *gain, pzs_real least)
{
    const pzs_real ratio = gain->moved > 0 ? gain->product / gain->moved : 0;
    return gain->moved >= 0 && gain->moved + gain->deviation <= MOST_SQUARE * least &&
           ratio * gain->product <= MOST_SHARE * gain->deviation;
}

bool pzs_polarity_gain_is_reversed(pzs_gain_state *gain, const pzs_supervision *tables,
                                   const pzs_loop_signals *signals, bool is_shaken)
{
    const uint32_t most = LONG_HALVES * tables->polarity_ticks / 2u;
    const pzs_real part = LEAST_PART * pzs_polarity_least(tables);
    const pzs_real least = tables->polarity_ticks * part * part;
    add_motions(gain, signals, 1 - 1 / (pzs_real)most);
    if (!are_sums_valid(gain, least)) {
        pzs_polarity_gain_begin(gain, signals);
        return false;
    }
    const bool is_reversed = !is_shaken && seems_reversed(gain, least);
    const uint32_t before = gain->reversed < most ? gain->reversed : most;
    const uint32_t lowered = before > 2u ? before - 2u : 0;
    gain->reversed = is_reversed ? before + 1u : lowered;
    return gain->reversed > most;
}
