/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Model of hysteresis and creep of piezoelectric ceramic, and its inverse. The effect u of an
 * electrode is the voltage that would move the structure as far without hysteresis and creep. At
 * the voltage v, with s = v - middle of the voltage range,
 *
 *   u = offset + m(s) + sum_i a_i P_i + sum_j x_j
 *   m    piecewise linear function of four slopes
 *   P_i  position of play i (an element with backlash), which moves only as far as is needed for
 *        |P_i - s| <= r_i
 *   r_i  slack of play i
 *   a_i  weight of play i: one value above and one below the middle
 *   x_j  creep term of first order
 *
 *   - The plays are computed in series: play i follows play i - 1 with the slack r_i - r_(i-1), and
 *     play 0 follows s. Even damaged positions thus become possible ones.
 *   - u always rises with v, because slopes are positive and weights are not negative. The inverse
 *     is therefore unique.
 *   - u is a piecewise linear function of v. The inverse visits the pieces in turn and ends with
 *     one division, without iterations.
 *
 * Work of a tick for each input: `plays` steps, and one for each play that moves on the way to the
 * lowest or highest voltage of the tick; the inverse visits at most 2 plays + 4 pieces.
 */
#include <string.h>
#include "hysteresis.h"
#include "control.h"
#include "effect_range.h"
#include "scrub.h"
#include "../core/guard.h"
#include "../core/numbers.h"

#define SEGMENTS PZS_HYSTERESIS_SEGMENTS

/* ---- tables ----------------------------------------------------------- */

/* List the arrays that the checksum of the hysteresis tables covers. Returns their number. */
static uint32_t list_parts(const pzs_hysteresis *tables, pzs_table_part part[PZS_TABLE_PARTS])
{
    const size_t sets = tables->sets;
    part[0] = (pzs_table_part){&tables->inputs, 4u * sizeof tables->inputs};
    part[1] = scrub_reals(tables->middle, sets);
    part[2] = scrub_reals(tables->half_range, sets);
    part[3] = scrub_reals(tables->offset, sets);
    part[4] = scrub_reals(tables->slope, sets * SEGMENTS);
    part[5] = scrub_reals(tables->slack, sets * tables->plays);
    part[6] = scrub_reals(tables->above, sets * tables->plays);
    part[7] = scrub_reals(tables->below, sets * tables->plays);
    part[8] = scrub_reals(tables->creep, sets * tables->creeps);
    part[9] = scrub_reals(tables->creep_rate, tables->creeps);
    part[10] = scrub_reals(tables->identified_offset, sets);
    part[11] = scrub_reals(tables->identified_slope, sets * SEGMENTS);
    part[12] = scrub_reals(tables->identified_above, sets * tables->plays);
    part[13] = scrub_reals(tables->identified_below, sets * tables->plays);
    return 14;
}

static uint32_t checksum(const pzs_hysteresis *tables)
{
    pzs_table_part part[PZS_TABLE_PARTS];
    return pzs_scrub_crc(part, list_parts(tables, part));
}

/*
 * Whether hysteresis tables contain either all or none of the arrays identified_offset,
 * identified_slope, identified_above and identified_below, the measured hysteresis model of the
 * electrodes.
 */
static bool is_identified_complete(const pzs_hysteresis *tables)
{
    const bool has_offset = tables->identified_offset != NULL;
    return (tables->identified_slope != NULL) == has_offset &&
           (tables->identified_above != NULL) == has_offset &&
           (tables->identified_below != NULL) == has_offset;
}

static bool are_complete(const pzs_hysteresis *tables)
{
    const bool has_sets = tables->sets == 1 || tables->sets == tables->inputs;
    return tables->inputs > 0 && has_sets && tables->plays <= PZS_PLAY_LIMIT &&
           tables->creeps <= PZS_CREEP_LIMIT && tables->middle != NULL &&
           tables->half_range != NULL && tables->offset != NULL && tables->slope != NULL &&
           tables->slack != NULL && tables->above != NULL && tables->below != NULL &&
           tables->creep != NULL && tables->creep_rate != NULL && is_identified_complete(tables);
}

pzs_status pzs_hysteresis_seal(pzs_hysteresis *tables)
{
    if (tables == NULL || !are_complete(tables))
        return PZS_E_ARGUMENT;
    tables->format = PZS_TABLE_FORMAT;
    tables->crc = checksum(tables);
    return PZS_OK;
}

/* Whether all numbers of an array lie between `least` and `most` or equal one of them. */
static bool are_between(const pzs_real *entry, size_t count, pzs_real least, pzs_real most)
{
    size_t k = 0;
    while (k < count && entry[k] >= least && entry[k] <= most)
        k++;
    return k == count;
}

/*
 * Whether the slacks of the plays (elements with backlash) in the hysteresis model of an electrode
 * are positive and in ascending order.
 */
static bool are_rising(const pzs_real *slack, uint32_t plays)
{
    uint32_t i = 0;
    while (i < plays && slack[i] > (i > 0 ? slack[i - 1] : 0))
        i++;
    return i == plays;
}

/*
 * Whether the hysteresis parameters in set k of the tables (one set for all inputs, or one for
 * each) are valid: the numbers are finite, and the effect (voltage that would move the structure as
 * far without hysteresis) rises with the voltage.
 */
static bool is_valid_set(const pzs_hysteresis *tables, uint32_t k)
{
    const size_t plays = tables->plays, creeps = tables->creeps;
    const pzs_real most = PZS_BY_BITS(1e30f, 1e30);
    return are_between(tables->middle + k, 1, -most, most) && tables->half_range[k] > 0 &&
           tables->half_range[k] <= most && are_between(tables->offset + k, 1, -most, most) &&
           are_between(tables->slope + k * SEGMENTS, SEGMENTS, PZS_LEAST_SLOPE, most) &&
           are_rising(tables->slack + k * plays, tables->plays) &&
           are_between(tables->slack + k * plays, plays, 0, most) &&
           are_between(tables->above + k * plays, plays, 0, most) &&
           are_between(tables->below + k * plays, plays, 0, most) &&
           are_between(tables->creep + k * creeps, creeps, 0, most);
}

/*
 * Whether all numbers in parameter set k of the measured hysteresis model (arrays identified_... of
 * the tables, with one parameter set for each electrode or one for all) are finite; true where the
 * tables have no such arrays.
 */
static bool is_identified_valid(const pzs_hysteresis *tables, uint32_t k)
{
    const size_t plays = tables->plays;
    const pzs_real most = PZS_BY_BITS(1e30f, 1e30);
    return tables->identified_offset == NULL ||
           (are_between(tables->identified_offset + k, 1, -most, most) &&
            are_between(tables->identified_slope + k * SEGMENTS, SEGMENTS, 0, most) &&
            are_between(tables->identified_above + k * plays, plays, 0, most) &&
            are_between(tables->identified_below + k * plays, plays, 0, most));
}

/*
 * Return the index of the set of hysteresis parameters that belongs to an input; there is one set
 * for all inputs, or one for each.
 */
static size_t set_of(const pzs_hysteresis *tables, uint32_t input)
{
    return tables->sets > 1 ? input : 0;
}

static pzs_status check(const pzs_hysteresis *tables, const pzs_problem *problem, int32_t *where)
{
    if (tables->format != PZS_TABLE_FORMAT || tables->scene != problem->scene)
        return PZS_E_FORMAT;
    if (!are_complete(tables) || tables->inputs != problem->inputs)
        return PZS_E_ARGUMENT;
    if (checksum(tables) != tables->crc)
        return PZS_E_CRC;
    for (uint32_t k = 0; k < tables->inputs; k++) {
        *where = (int32_t)k;
        const bool has_limits =
            number_is_finite(problem->lower[k]) && number_is_finite(problem->upper[k]);
        const uint32_t set = (uint32_t)set_of(tables, k);
        if (!has_limits || !is_valid_set(tables, set) || !is_identified_valid(tables, set))
            return PZS_E_LIMITS;
    }
    *where = -1;
    return are_between(tables->creep_rate, tables->creeps, 0, 1) ? PZS_OK : PZS_E_ARGUMENT;
}

/* ---- one electrode ---------------------------------------------------- */

/* Parameters of the hysteresis model of one electrode. */
typedef struct electrode {
    const pzs_real *slope; /* [SEGMENTS] slopes of the piecewise linear part of the electrode's
                              effect (voltage that would move the structure as far without
                              hysteresis), from the lowest to the highest quarter of the voltage
                              range (dimensionless) */
    const pzs_real *slack; /* [plays] slack of each play (element with backlash), the half width of
                              its backlash (V) */
    const pzs_real *above; /* [plays] weight of each play (element with backlash) in the effect
                              (voltage that would move the structure as far without hysteresis)
                              while the play is above the middle of the voltage range
                              (dimensionless) */
    const pzs_real *below; /* [plays] weight of each play (element with backlash) in the effect
                              (voltage that would move the structure as far without hysteresis)
                              while the play is below the middle of the voltage range
                              (dimensionless) */
    const pzs_real *creep; /* [creeps] final value of each creep term in the effect of the electrode
                              (voltage that would move the structure as far without hysteresis),
                              divided by the voltage (dimensionless) */
    pzs_real middle;     /* middle of the voltage range of the electrode (V), at which the model of
                            hysteresis has its zero */
    pzs_real half_range; /* half of the voltage range of the electrode (V) */
    pzs_real offset; /* constant part of the effect of the electrode (V); the effect is the voltage
                        that would move the structure as far without hysteresis */
    uint32_t plays, creeps;
} electrode_tables;

static electrode_tables electrode_of(const pzs_hysteresis *tables, uint32_t input)
{
    const size_t set = set_of(tables, input), first = set * tables->plays;
    const electrode_tables result = {tables->slope + set * SEGMENTS,
                                     tables->slack + first,
                                     tables->above + first,
                                     tables->below + first,
                                     tables->creep + set * tables->creeps,
                                     tables->middle[set],
                                     tables->half_range[set],
                                     tables->offset[set],
                                     tables->plays,
                                     tables->creeps};
    return result;
}

/*
 * Return `value`, the position of a play (element with backlash), clamped to [middle - slack,
 * middle + slack], where `middle` is the position that the play follows (V); NaN becomes the lower
 * end.
 */
static pzs_real follow(pzs_real value, pzs_real middle, pzs_real slack)
{
    const pzs_real low = middle - slack, high = middle + slack;
    const pzs_real least = value > low ? value : low;
    return least < high ? least : high;
}

/*
 * Return the slack of play i relative to the play that it follows (V): the difference of the slacks
 * of play i and play i - 1; for play 0 its own slack. A play is an element with backlash.
 */
static pzs_real slack_behind(const pzs_real *slack, uint32_t i)
{
    return i > 0 ? slack[i] - slack[i - 1] : slack[0];
}

/*
 * Return the piecewise linear part of an electrode's effect (voltage that would move the structure
 * as far without hysteresis) (V). It is 0 in the middle of the voltage range; its slope changes
 * there and at the quarters of the range.
 *   offset in  distance of the voltage from the middle of the range (V)
 */
static pzs_real line_at(const electrode_tables *electrode, pzs_real offset)
{
    const pzs_real *slope = electrode->slope;
    const pzs_real knot = electrode->half_range / 2, size = number_absolute(offset);
    const pzs_real inner = offset < 0 ? slope[1] : slope[2];
    const pzs_real outer = offset < 0 ? slope[0] : slope[3];
    const pzs_real near_part = size < knot ? size : knot;
    const pzs_real way = inner * near_part + outer * (size - near_part);
    return offset < 0 ? -way : way;
}

/*
 * Return the contribution of play i (an element with backlash) to the effect of an electrode
 * (voltage that would move the structure as far without hysteresis) when the play is at `position`
 * (V).
 */
static pzs_real part_of(const electrode_tables *electrode, uint32_t i, pzs_real position)
{
    return (position > 0 ? electrode->above : electrode->below)[i] * position;
}

void pzs_hysteresis_rest(const pzs_hysteresis *tables, uint32_t input, hysteresis_memory memory,
                         pzs_real voltage)
{
    const size_t set = set_of(tables, input);
    const pzs_real *slack = tables->slack + set * tables->plays;
    const pzs_real *creep = tables->creep + set * tables->creeps;
    pzs_real place = voltage - tables->middle[set];
    for (uint32_t i = 0; i < tables->plays; i++) {
        place = follow(-tables->middle[set], place, slack_behind(slack, i));
        memory.play[i] = place;
    }
    for (uint32_t j = 0; j < tables->creeps; j++)
        memory.creep[j] = creep[j] * voltage;
}

/*
 * Return the fraction of the way to its final value that a creep term of the hysteresis model goes
 * in a number of ticks, where `rate` is the fraction in one tick.
 */
static pzs_real rate_of(pzs_real rate, uint32_t ticks)
{
    pzs_real left = 1, square = 1 - rate;
    if (ticks == 1)
        return rate;
    for (uint32_t bits = ticks; bits > 0; bits /= 2u) {
        left *= bits % 2u ? square : 1;
        square *= square;
    }
    return 1 - left;
}

/*
 * Return a creep term of the hysteresis model (V) after it has gone the fraction `rate` of the way
 * to its final value gain * voltage.
 *   gain in  final value per volt (1)
 *   most in  largest possible voltage (V); a creep term above gain * most shows damaged memory and
 *            is first set to the final value
 */
static pzs_real creep_after(pzs_real creep, pzs_real gain, pzs_real rate, pzs_real voltage,
                            pzs_real most)
{
    const pzs_real end = gain * voltage;
    const pzs_real now = number_absolute(creep) <= gain * most ? creep : end;
    return now + rate * (end - now);
}

/*
 * Move the creep terms in the hysteresis model of an electrode by some ticks under a voltage.
 * Returns the sum of their changes (V).
 *   creep [creeps] in/out  creep terms before and after these ticks (V)
 *   rate  [creeps] in      fraction of the way to its final value that each creep term goes
 *                          (dimensionless)
 */
static pzs_real move_creeps(const electrode_tables *electrode, pzs_real *creep, pzs_real voltage,
                            const pzs_real *rate)
{
    const pzs_real most = 2 * (number_absolute(electrode->middle) + electrode->half_range);
    pzs_real change = 0;
    for (uint32_t j = 0; j < electrode->creeps; j++) {
        const pzs_real before = creep[j];
        creep[j] = creep_after(before, electrode->creep[j], rate[j], voltage, most);
        change += creep[j] - before;
    }
    return change;
}

/*
 * Move the plays (elements with backlash) of an electrode to the positions that follow from a new
 * voltage. Returns the effect of the electrode (voltage that would move the structure as far
 * without hysteresis), without its creep terms (V).
 *   play [plays] in/out  positions of the plays before and after the change to `voltage` (V)
 */
static pzs_real move_plays(const electrode_tables *electrode, pzs_real *play, pzs_real voltage)
{
    pzs_real place = voltage - electrode->middle, slack_before = 0;
    pzs_real effect = electrode->offset + line_at(electrode, place);
    for (uint32_t i = 0; i < electrode->plays; i++) {
        const pzs_real slack = electrode->slack[i];
        place = follow(play[i], place, slack - slack_before);
        slack_before = slack;
        play[i] = place;
        effect += part_of(electrode, i, place);
    }
    return effect;
}

static pzs_real sum_of(const pzs_real *term, uint32_t count)
{
    pzs_real sum = 0;
    for (uint32_t j = 0; j < count; j++)
        sum += term[j];
    return sum;
}

pzs_real pzs_hysteresis_remember(const pzs_hysteresis *tables, uint32_t input,
                                 hysteresis_memory memory, pzs_real voltage, uint32_t ticks)
{
    const electrode_tables electrode = electrode_of(tables, input);
    pzs_real rate[PZS_CREEP_LIMIT];
    for (uint32_t j = 0; j < tables->creeps; j++)
        rate[j] = rate_of(tables->creep_rate[j], ticks);
    const pzs_real effect =
        move_plays(&electrode, memory.play, voltage) + sum_of(memory.creep, tables->creeps);
    (void)move_creeps(&electrode, memory.creep, voltage, rate);
    return effect;
}

pzs_real pzs_hysteresis_effect(const pzs_hysteresis *tables, uint32_t input,
                               hysteresis_memory memory, pzs_real voltage)
{
    const electrode_tables electrode = electrode_of(tables, input);
    pzs_real play[PZS_PLAY_LIMIT];
    memcpy(play, memory.play, tables->plays * sizeof *play);
    return move_plays(&electrode, play, voltage) + sum_of(memory.creep, tables->creeps);
}

/*
 * Return by how much the effect of an electrode (voltage that would move the structure as far
 * without hysteresis) changes when its voltage changes from one value to another (V).
 *   play [plays] in  positions of the plays (elements with backlash) at the voltage `from` (V)
 */
static pzs_real effect_change(const electrode_tables *electrode, const pzs_real *play,
                              pzs_real from, pzs_real to)
{
    const pzs_real sign = to < from ? -1 : 1, place = to - electrode->middle;
    pzs_real change = line_at(electrode, place) - line_at(electrode, from - electrode->middle);
    for (uint32_t i = 0; i < electrode->plays; i++) {
        const pzs_real moved = place - sign * electrode->slack[i], before = play[i];
        if (!(sign * (moved - before) > 0))
            break;
        change += part_of(electrode, i, moved) - part_of(electrode, i, before);
    }
    return change;
}

/* ---- inverse ---------------------------------------------------------- */

/*
 * State of a search for the voltage at which an electrode has a wanted effect (voltage that would
 * move the structure as far without hysteresis). The search starts at the present voltage and
 * follows the piecewise linear curve of the effect over the voltage, upwards (`sign` 1) or
 * downwards (`sign` -1). Voltages are relative to the middle of the voltage range and, except those
 * in `play`, multiplied by `sign`, so that every search runs towards larger numbers.
 */
typedef struct effect_walk {
    const pzs_real *slope; /* [SEGMENTS] slopes of the piecewise linear part of the electrode's
                              effect (voltage that would move the structure as far without
                              hysteresis), from the lowest to the highest quarter of the voltage
                              range (dimensionless) */
    const pzs_real *slack; /* [plays] slack of each play (element with backlash), the half width of
                              its backlash (V) */
    /*
     * [plays] position of each play (element with backlash) at the present voltage, where the
     * search for the voltage that causes a wanted strain starts (V). It is relative to the middle
     * of the voltage range, and positive above the middle for either direction of the search
     */
    const pzs_real *play;
    /*
     * [plays] weight of each play (element with backlash) in the effect (voltage that would move
     * the structure as far without hysteresis), while the play is in the upper half of the voltage
     * range if `sign` is 1, in the lower half if it is -1 (dimensionless)
     */
    const pzs_real *ahead;
    /*
     * [plays] weight of each play (element with backlash) in the effect (voltage that would move
     * the structure as far without hysteresis), while the play is in the lower half of the voltage
     * range if `sign` is 1, in the upper half if it is -1 (dimensionless)
     */
    const pzs_real *behind;
    pzs_real sign; /* direction of the search for a voltage along the characteristic of an electrode
                      (its strain as a function of the voltage): 1 towards higher voltages, -1
                      towards lower ones */
    pzs_real knot; /* a quarter of the voltage range (V). The slope of the piecewise linear part of
                      the effect (voltage that would move the structure as far without hysteresis)
                      changes at three voltages: in the middle of the range, and a quarter of the
                      range above and below */
    pzs_real place; /* voltage that the search along the characteristic of an electrode (its strain
                       as a function of the voltage) has reached, relative to the middle of the
                       voltage range (V) */
    pzs_real gain; /* slope of the characteristic at the voltage that the search has reached, in the
                      direction of the search (dimensionless); the characteristic is the effect of
                      an electrode (voltage that would move the structure as far without hysteresis)
                      as a function of its voltage */
    uint32_t plays;
    uint32_t moving;  /* number of plays (elements with backlash) that have used up their slack and
                         move with the voltage: the first ones in the order of their slack */
    uint32_t crossed; /* number of plays (elements with backlash) that move with the voltage and
                         have crossed the middle of the voltage range */
    uint32_t knots;   /* number of changes of slope in the piecewise linear part of the effect
                         (voltage that would move the structure as far without hysteresis) that the
                         search for a voltage has passed */
} effect_walk;

#define NOWHERE PZS_R(HUGE_VAL)

/*
 * Return the slope of the piecewise linear part of an electrode's effect (voltage that would move
 * the structure as far without hysteresis) in quarter k of the voltage range: k = 0 to 3 from the
 * lowest voltages to the highest in a search towards higher voltages, otherwise in the reverse
 * order.
 */
static pzs_real slope_of(const effect_walk *walk, uint32_t k)
{
    return walk->slope[walk->sign > 0 ? k : SEGMENTS - 1u - k];
}

static effect_walk start_walk(const electrode_tables *electrode, const pzs_real *play,
                              pzs_real sign, pzs_real from)
{
    const bool is_up = sign > 0;
    const pzs_real *ahead = is_up ? electrode->above : electrode->below;
    const pzs_real *behind = is_up ? electrode->below : electrode->above;
    effect_walk walk = {.slope = electrode->slope,
                        .slack = electrode->slack,
                        .play = play,
                        .ahead = ahead,
                        .behind = behind,
                        .sign = sign,
                        .knot = electrode->half_range / 2,
                        .place = sign * (from - electrode->middle),
                        .plays = electrode->plays};
    walk.gain = slope_of(&walk, 0);
    return walk;
}

/*
 * Part of the search for the voltage that causes a wanted strain: return the next voltage at which
 * a play (element with backlash) begins to move, in the order of slack. Relative to the middle of
 * the voltage range, in the direction of the search (V); infinite if all plays move already.
 */
static pzs_real next_move(const effect_walk *walk)
{
    const uint32_t i = walk->moving;
    return i < walk->plays ? walk->sign * walk->play[i] + walk->slack[i] : NOWHERE;
}

/*
 * Part of the search for the voltage that causes a wanted strain: return the next voltage at which
 * the slope of the strain over the voltage changes because a moving play (element with backlash)
 * reaches the middle of the voltage range. The result is relative to the middle, in the direction
 * of the search (V).
 */
static pzs_real next_crossing(const effect_walk *walk)
{
    return walk->crossed < walk->moving ? walk->slack[walk->crossed] : NOWHERE;
}

/*
 * Return the next voltage at which the slope of the piecewise linear part of the effect (voltage
 * that would move the structure as far without hysteresis) changes, in a search for the voltage
 * with a wanted effect. The result is relative to the middle of the voltage range (V).
 */
static pzs_real next_knot(const effect_walk *walk)
{
    return walk->knots + 1u < SEGMENTS ? ((pzs_real)walk->knots - 1) * walk->knot : NOWHERE;
}

/*
 * Part of the search for the voltage that causes a wanted strain: let the next play (element with
 * backlash) move with the voltage, because its slack is used up. Its weight, which differs below
 * and above the middle of the voltage range, is added to the slope of the strain over the voltage.
 */
static void move_play(effect_walk *walk)
{
    const uint32_t i = walk->moving++;
    const bool is_beyond = walk->slack[i] <= walk->place;
    walk->gain += is_beyond ? walk->ahead[i] : walk->behind[i];
    walk->crossed = is_beyond ? walk->moving : walk->crossed;
}

/*
 * Pass the next knot in the search for the voltage of an electrode that has a wanted effect, and
 * update the slope of the effect. The effect is the voltage that would move the structure as far
 * without hysteresis. Knots are the three voltages at which its piecewise linear part changes its
 * slope.
 */
static void pass_knot(effect_walk *walk)
{
    walk->gain += slope_of(walk, walk->knots + 1u) - slope_of(walk, walk->knots);
    walk->knots++;
}

/*
 * Let the search for a voltage with a wanted effect pass the nearest voltage at which the slope of
 * the effect (voltage that would move the structure as far without hysteresis) changes, and update
 * the slope.
 */
static void pass_break(effect_walk *walk, pzs_real nearest)
{
    if (next_crossing(walk) <= nearest) {
        walk->gain += walk->ahead[walk->crossed] - walk->behind[walk->crossed];
        walk->crossed++;
    } else if (next_move(walk) <= nearest) {
        move_play(walk);
    } else {
        pass_knot(walk);
    }
}

/*
 * Begin the search for the voltage at which an electrode causes a wanted strain: find the slope of
 * the strain over the voltage at the present voltage, in the direction of the search. Plays without
 * slack in this direction move from the beginning. Changes of slope before the present voltage are
 * skipped.
 */
static void find_first_slope(effect_walk *walk)
{
    while (next_move(walk) <= walk->place)
        move_play(walk);
    while (next_knot(walk) <= walk->place)
        pass_knot(walk);
}

static pzs_real smaller(pzs_real one, pzs_real other)
{
    return one < other ? one : other;
}

/*
 * Return the voltage (V) at which the effect of an electrode (voltage that would move the structure
 * as far without hysteresis) differs by `way` (V) from the effect at the voltage `from`.
 *   play [plays] in  positions of the plays (elements with backlash) at the voltage `from` (V)
 */
static pzs_real voltage_after(const electrode_tables *electrode, const pzs_real *play,
                              pzs_real from, pzs_real way)
{
    const pzs_real sign = way < 0 ? -1 : 1;
    effect_walk walk = start_walk(electrode, play, sign, from);
    pzs_real rest = number_absolute(way);
    const uint32_t breaks = 2u * walk.plays + SEGMENTS;
    find_first_slope(&walk);
    for (uint32_t k = 0; k < breaks; k++) {
        const pzs_real nearest =
            smaller(next_move(&walk), smaller(next_crossing(&walk), next_knot(&walk)));
        if (nearest > walk.place) {
            const pzs_real part = walk.gain * (nearest - walk.place);
            if (!(part < rest))
                break;
            rest -= part;
            walk.place = nearest;
        }
        pass_break(&walk, nearest);
    }
    return electrode->middle + sign * (walk.place + rest / walk.gain);
}

pzs_real pzs_hysteresis_voltage(const pzs_hysteresis *tables, uint32_t input,
                                hysteresis_memory memory, pzs_real from, pzs_real effect)
{
    const electrode_tables electrode = electrode_of(tables, input);
    const pzs_real way = effect - pzs_hysteresis_effect(tables, input, memory, from);
    return voltage_after(&electrode, memory.play, from, way);
}

/* ---- identified model ------------------------------------------------- */

/*
 * Return the parameters of the measured hysteresis model of the electrode of an input. The
 * compensation may use a model with less hysteresis, whose inverse is more robust.
 */
static electrode_tables identified_electrode(const pzs_hysteresis *tables, uint32_t input)
{
    const size_t set = set_of(tables, input), first = set * tables->plays;
    electrode_tables electrode = electrode_of(tables, input);
    if (tables->identified_offset == NULL)
        return electrode;
    electrode.offset = tables->identified_offset[set];
    electrode.slope = tables->identified_slope + set * SEGMENTS;
    electrode.above = tables->identified_above + first;
    electrode.below = tables->identified_below + first;
    return electrode;
}

pzs_real pzs_hysteresis_identified(const pzs_compensator *compensator, uint32_t input,
                                   pzs_real voltage)
{
    const pzs_hysteresis *tables = compensator->state.tables;
    const electrode_tables electrode = identified_electrode(tables, input);
    const pzs_real *creep = compensator->state.creep + (size_t)input * tables->creeps;
    pzs_real play[PZS_PLAY_LIMIT];
    memcpy(play, compensator->state.play + (size_t)input * tables->plays,
           tables->plays * sizeof *play);
    return move_plays(&electrode, play, voltage) + sum_of(creep, tables->creeps);
}

/* ---- blocks ----------------------------------------------------------- */

static size_t play_count(const pzs_hysteresis *tables)
{
    return (size_t)tables->inputs * tables->plays;
}

static size_t effect_bytes(const void *tables, const pzs_problem *problem)
{
    const pzs_hysteresis *hysteresis = tables;
    return PZS_EFFECT_BLOCK_BYTES(problem->inputs, hysteresis->plays, hysteresis->creeps);
}

/* Set the pointers of the compensation of hysteresis to its tables and its arrays. */
static void place(pzs_compensator *compensator, const pzs_hysteresis *tables)
{
    const size_t inputs = tables->inputs;
    pzs_real *at = (void *)((uint8_t *)compensator + PZS_ALIGNED(sizeof *compensator));
    compensator->state.tables = tables;
    compensator->state.effect = at;
    compensator->state.lower = at + inputs;
    compensator->state.upper = at + 2 * inputs;
    compensator->state.present = at + 3 * inputs;
    compensator->state.play = at + 4 * inputs;
    compensator->state.creep = at + 4 * inputs + play_count(tables);
    compensator->info.effect = compensator->state.effect;
}

static hysteresis_memory memory_of(const pzs_compensator *compensator, uint32_t input)
{
    const pzs_hysteresis *tables = compensator->state.tables;
    const hysteresis_memory memory = {compensator->state.play + (size_t)input * tables->plays,
                                      compensator->state.creep + (size_t)input * tables->creeps};
    return memory;
}

static pzs_status effect_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    pzs_compensator *compensator = self;
    const pzs_control *control = signals->control;
    const pzs_status status = check(tables, control->state.problem, &signals->where);
    if (status != PZS_OK)
        return status;
    if (!signals->has_inverse)
        return PZS_E_STAGE;
    /*
     * The compensation of hysteresis is refused where sums of voltages are limited: it replaces
     * voltages by effects (voltages that would move the structure as far without hysteresis), to
     * which such limits do not apply.
     */
    if (control->state.problem->limit_rows != NULL)
        return PZS_E_ARGUMENT;
    memset(compensator, 0, sizeof *compensator);
    place(compensator, tables);
    for (uint32_t k = 0; k < control->state.problem->inputs; k++) {
        const pzs_real voltage = control->state.voltage[k];
        const hysteresis_memory memory = memory_of(compensator, k);
        pzs_hysteresis_rest(tables, k, memory, voltage);
        compensator->state.effect[k] = pzs_hysteresis_effect(tables, k, memory, voltage);
    }
    return PZS_OK;
}

/*
 * Compute the lowest and the highest voltage of input k that voltage limits and step limit allow in
 * this tick. If the two limits do not overlap, the voltage limits take precedence. Returns whether
 * they overlap.
 */
static bool set_range(pzs_compensator *compensator, const pzs_control *control, uint32_t k,
                      pzs_real given)
{
    return effect_set_range(control, k, given, &compensator->state.lower[k],
                            &compensator->state.upper[k]);
}

/*
 * Replace the voltage limits of input k in the controller by limits of its effect (voltage that
 * would move the structure as far without hysteresis): the effects at the lowest and the highest
 * voltage that this tick allows, starting from the present voltage `given`.
 */
static void set_effect_limits(const pzs_compensator *compensator, pzs_control *control,
                              const electrode_tables *electrode, uint32_t k, pzs_real given)
{
    const pzs_real *play = memory_of(compensator, k).play;
    const pzs_real present = compensator->state.present[k];
    const pzs_real low =
        present + effect_change(electrode, play, given, compensator->state.lower[k]);
    const pzs_real high =
        present + effect_change(electrode, play, given, compensator->state.upper[k]);
    control->state.lower[k] = smaller(low, high);
    control->state.upper[k] = high;
}

/*
 * Replace the controller's voltages of the last tick, from which it starts, by their effects. The
 * effect of a voltage is the voltage that would move the structure as far without hysteresis and
 * creep (V).
 */
static void take_effects(const pzs_compensator *compensator, pzs_control *control)
{
    const pzs_hysteresis *tables = compensator->state.tables;
    const pzs_real *effect = compensator->state.effect, *base = control->state.optimiser.base;
    // The controller's prediction of the shape stays valid if the effects (voltages that would move
    // the structure as far without hysteresis) are those for which it was computed, up to rounding
    // errors.
    bool is_known = control->state.behind == PZS_BEHIND_NOTHING;
    for (uint32_t k = 0; k < tables->inputs && is_known; k++) {
        const size_t set = set_of(tables, k);
        const pzs_real size = number_absolute(tables->middle[set]) + tables->half_range[set];
        is_known = number_absolute(effect[k] - base[k]) <= EFFECT_ROUNDING * PZS_EPSILON * size;
    }
    effect_take(control, effect, is_known);
}

/*
 * Compute the effect of input k (voltage that would move the structure as far without hysteresis)
 * for its voltage `given` of the last tick: state.effect[k] in the last tick, and state.present[k]
 * in this tick, between which the ceramic creeps. Also updates the plays and creep terms of the
 * input.
 *   rate [creeps] in  part of the way to its final value that each creep term goes in between
 *                     (dimensionless)
 */
static void find_effects(pzs_compensator *compensator, const electrode_tables *electrode,
                         uint32_t k, pzs_real given, const pzs_real *rate)
{
    const hysteresis_memory memory = memory_of(compensator, k);
    const pzs_real effect = move_plays(electrode, memory.play, given);
    compensator->state.effect[k] = effect + sum_of(memory.creep, electrode->creeps);
    compensator->state.present[k] =
        compensator->state.effect[k] + move_creeps(electrode, memory.creep, given, rate);
}

static pzs_status effect_tick(void *self, pzs_loop_signals *signals)
{
    pzs_compensator *compensator = self;
    pzs_control *control = signals->control;
    const pzs_hysteresis *tables = signals->tables;
    pzs_real rate[PZS_CREEP_LIMIT];
    int32_t clash = -1;
    place(compensator, tables);
    for (uint32_t j = 0; j < tables->creeps; j++)
        rate[j] = rate_of(tables->creep_rate[j], 1u + signals->missed);
    for (uint32_t k = 0; k < tables->inputs; k++) {
        const pzs_real given = signals->given[k];
        const electrode_tables electrode = electrode_of(tables, k);
        find_effects(compensator, &electrode, k, given, rate);
        if (!set_range(compensator, control, k, given) && clash < 0)
            clash = (int32_t)k;
        set_effect_limits(compensator, control, &electrode, k, given);
    }
    take_effects(compensator, control);
    signals->compensator = compensator;
    signals->where = clash;
    return clash < 0 ? PZS_OK : PZS_W_STEP_LIMIT;
}

static size_t inverse_bytes(const void *tables, const pzs_problem *problem)
{
    (void)tables;
    (void)problem;
    return 0;
}

static pzs_status inverse_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    (void)self;
    (void)tables;
    signals->has_inverse = true;
    return PZS_OK;
}

/*
 * Return the voltage of input k, inside the range that this tick allows, that has the effect
 * (voltage that would move the structure as far without hysteresis) which the optimiser has chosen.
 */
static pzs_real voltage_of(const pzs_compensator *compensator, const pzs_control *control,
                           const pzs_real *given, uint32_t k)
{
    const pzs_real lower = compensator->state.lower[k], upper = compensator->state.upper[k];
    const pzs_real wanted = control->state.voltage[k];
    /* Damaged memory may give a voltage that is not finite; the present voltage is then kept. */
    if (!number_is_finite(wanted))
        return number_clamp(given[k], lower, upper);
    if (!(wanted < control->state.upper[k]))
        return upper;
    if (!(wanted > control->state.lower[k]))
        return lower;
    const electrode_tables electrode = electrode_of(compensator->state.tables, k);
    const pzs_real voltage = voltage_after(&electrode, memory_of(compensator, k).play, given[k],
                                           wanted - compensator->state.present[k]);
    return number_clamp(voltage, lower, upper);
}

static pzs_status inverse_tick(void *self, pzs_loop_signals *signals)
{
    const pzs_compensator *compensator = signals->compensator;
    pzs_control *control = signals->control;
    (void)self;
    if (compensator == NULL || compensator->state.tables != signals->tables)
        return PZS_E_STAGE;
    for (uint32_t k = 0; k < control->state.problem->inputs; k++) {
        const pzs_real voltage = voltage_of(compensator, control, signals->given, k);
        compensator->state.effect[k] = control->state.voltage[k];
        control->state.voltage[k] = voltage;
    }
    pzs_control_restore_limits(control);
    return PZS_OK;
}

static uint32_t effect_parts(const void *tables, uint32_t number,
                             pzs_table_part part[PZS_TABLE_PARTS], uint32_t *crc)
{
    const pzs_hysteresis *table = tables;
    *crc = table->crc;
    return number == 0 ? list_parts(table, part) : 0;
}

const pzs_block_type pzs_effect_block = {"effect",    PZS_PHASE_READINGS, effect_bytes,
                                         effect_init, effect_tick,        effect_parts};
const pzs_block_type pzs_inverse_block = {"inverse",    PZS_PHASE_VOLTAGE, inverse_bytes,
                                          inverse_init, inverse_tick,      NULL};
