/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Hysteresis and creep of piezoelectric ceramic, and their inverse (pzs_loop.h).
 *
 * The effect of an electrode at the voltage v, with s = v - middle, is
 *
 *   u = offset + m(s) + sum_i a_i P_i + sum_j x_j,
 *
 * where m is a line of four slopes, P_i is the position of play i, a_i is its weight above or below
 * the middle, as P_i is positive or negative, and x_j is a creep of first order. The plays are in
 * series: play i follows play i - 1, and play 0 follows s, each with the slack r_i - r_(i-1); this
 * is the same as P_i following s with the slack r_i, and it can hold no memory that no voltages
 * have left. Slopes are positive and weights are not negative, so u rises with v whatever the
 * memory is: the voltage limits and step limits of a tick are mapped end to end, and the inverse is
 * unique.
 *
 * Seen from the present voltage u is a line of straight pieces. In either direction the plays begin
 * to move one after the other, in the order of their slack, and cross the middle in that order,
 * too. The inverse walks along these pieces; it ends in one division and has no iteration.
 *
 * Work of a tick, an input: 4 plays + 30 multiply-adds and comparisons for the limits and the
 * memory, at most 2 plays + 4 pieces of the inverse.
 */
#include <string.h>
#include "hysteresis.h"
#include "control.h"
#include "step_bounds.h"
#include "scrub.h"
#include "../core/guard.h"
#include "../core/numbers.h"

#define SEGMENTS PZS_HYSTERESIS_SEGMENTS

/* ---- tables ----------------------------------------------------------- */

/* List the parts of the checksum of the tables. Returns their number. */
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
    return 10;
}

uint32_t pzs_hysteresis_crc(const pzs_hysteresis *tables)
{
    pzs_table_part part[PZS_TABLE_PARTS];
    return pzs_scrub_crc(part, list_parts(tables, part));
}

static bool are_complete(const pzs_hysteresis *tables)
{
    const bool has_sets = tables->sets == 1 || tables->sets == tables->inputs;
    return tables->inputs > 0 && has_sets && tables->plays <= PZS_PLAY_LIMIT &&
           tables->creeps <= PZS_CREEP_LIMIT && tables->middle != NULL &&
           tables->half_range != NULL && tables->offset != NULL && tables->slope != NULL &&
           tables->slack != NULL && tables->above != NULL && tables->below != NULL &&
           tables->creep != NULL && tables->creep_rate != NULL;
}

pzs_status pzs_hysteresis_seal(pzs_hysteresis *tables)
{
    if (tables == NULL || !are_complete(tables))
        return PZS_E_ARGUMENT;
    tables->format = PZS_TABLE_FORMAT;
    tables->crc = pzs_hysteresis_crc(tables);
    return PZS_OK;
}

/* Whether all entries lie between two bounds, both of which may occur. */
static bool are_between(const pzs_real *entry, size_t count, pzs_real least, pzs_real most)
{
    size_t k = 0;
    while (k < count && entry[k] >= least && entry[k] <= most)
        k++;
    return k == count;
}

/* Whether the slacks of the plays of an electrode are positive and rise. */
static bool are_rising(const pzs_real *slack, uint32_t plays)
{
    uint32_t i = 0;
    while (i < plays && slack[i] > (i > 0 ? slack[i - 1] : 0))
        i++;
    return i == plays;
}

/* Whether the effect of set k rises with the voltage, and its numbers are finite. */
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

/* Index of the set of numbers of an input. */
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
    if (pzs_hysteresis_crc(tables) != tables->crc)
        return PZS_E_CRC;
    for (uint32_t k = 0; k < tables->inputs; k++) {
        *where = (int32_t)k;
        const bool has_limits =
            number_is_finite(problem->lower[k]) && number_is_finite(problem->upper[k]);
        if (!has_limits || !is_valid_set(tables, (uint32_t)set_of(tables, k)))
            return PZS_E_LIMITS;
    }
    *where = -1;
    return are_between(tables->creep_rate, tables->creeps, 0, 1) ? PZS_OK : PZS_E_ARGUMENT;
}

/* ---- one electrode ---------------------------------------------------- */

/* Value inside [middle - slack, middle + slack]; the lower end if the value is NaN. */
static pzs_real follow(pzs_real value, pzs_real middle, pzs_real slack)
{
    const pzs_real low = middle - slack, high = middle + slack;
    const pzs_real least = value > low ? value : low;
    return least < high ? least : high;
}

/* Slack of play i behind play i - 1, or of play 0 behind the voltage (V). */
static pzs_real slack_behind(const pzs_real *slack, uint32_t i)
{
    return i > 0 ? slack[i] - slack[i - 1] : slack[0];
}

/* Ordinate at s of the line with four slopes through 0, whose knots are quarters of the range. */
static pzs_real line_at(const pzs_real *slope, pzs_real half_range, pzs_real s)
{
    const pzs_real knot = half_range / 2, size = number_absolute(s);
    const pzs_real inner = s < 0 ? slope[1] : slope[2], outer = s < 0 ? slope[0] : slope[3];
    const pzs_real near_part = size < knot ? size : knot;
    const pzs_real way = inner * near_part + outer * (size - near_part);
    return s < 0 ? -way : way;
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

/* Part of the way that a creep goes in some ticks, from the part of one tick. */
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
 * Creep after some ticks at a voltage, towards gain * voltage. A creep above gain * most, which no
 * voltages leave, is taken to be at its end.
 */
static pzs_real creep_after(pzs_real creep, pzs_real gain, pzs_real rate, pzs_real voltage,
                            pzs_real most)
{
    const pzs_real end = gain * voltage;
    const pzs_real now = number_absolute(creep) <= gain * most ? creep : end;
    return now + rate * (end - now);
}

void pzs_hysteresis_remember(const pzs_hysteresis *tables, uint32_t input, hysteresis_memory memory,
                             pzs_real voltage, uint32_t ticks)
{
    const size_t set = set_of(tables, input);
    const pzs_real *slack = tables->slack + set * tables->plays;
    const pzs_real *creep = tables->creep + set * tables->creeps;
    const pzs_real most = number_absolute(tables->middle[set]) + tables->half_range[set];
    pzs_real place = voltage - tables->middle[set];
    for (uint32_t i = 0; i < tables->plays; i++) {
        place = follow(memory.play[i], place, slack_behind(slack, i));
        memory.play[i] = place;
    }
    for (uint32_t j = 0; j < tables->creeps; j++)
        memory.creep[j] = creep_after(memory.creep[j], creep[j],
                                      rate_of(tables->creep_rate[j], ticks), voltage, 2 * most);
}

pzs_real pzs_hysteresis_effect(const pzs_hysteresis *tables, uint32_t input,
                               hysteresis_memory memory, pzs_real voltage)
{
    const size_t set = set_of(tables, input), first = set * tables->plays;
    const pzs_real *slack = tables->slack + first;
    pzs_real place = voltage - tables->middle[set];
    pzs_real sum = tables->offset[set] +
                   line_at(tables->slope + set * SEGMENTS, tables->half_range[set], place);
    for (uint32_t i = 0; i < tables->plays; i++) {
        place = follow(memory.play[i], place, slack_behind(slack, i));
        sum += (place > 0 ? tables->above : tables->below)[first + i] * place;
    }
    for (uint32_t j = 0; j < tables->creeps; j++)
        sum += memory.creep[j];
    return sum;
}

/* ---- inverse ---------------------------------------------------------- */

/*
 * A walk away from the present voltage. All places are mirrored where it goes down, so that the
 * walk always goes up: they are `sign` times s.
 */
typedef struct effect_walk {
    const pzs_real *slope;  /* [SEGMENTS] slopes of the line, upwards */
    const pzs_real *slack;  /* [plays] */
    const pzs_real *play;   /* [plays] positions of the plays, upwards */
    const pzs_real *ahead;  /* [plays] weights of the plays beyond the middle */
    const pzs_real *behind; /* [plays] weights of the plays before the middle */
    pzs_real sign;          /* 1: upwards, -1: downwards */
    pzs_real knot;          /* distance of the outer knots of the line from the middle (V) */
    pzs_real place;         /* where the walk is (V) */
    pzs_real gain;          /* effect per volt ahead */
    uint32_t plays;
    uint32_t moving;  /* the first plays, which move */
    uint32_t crossed; /* the first ones of them, which are beyond the middle */
    uint32_t knots;   /* knots of the line that are passed */
} effect_walk;

#define NOWHERE PZS_R(HUGE_VAL)

/* Slope of the line in segment k, counted in the direction of the walk. */
static pzs_real slope_of(const effect_walk *walk, uint32_t k)
{
    return walk->slope[walk->sign > 0 ? k : SEGMENTS - 1u - k];
}

static effect_walk start_walk(const pzs_hysteresis *tables, uint32_t input,
                              hysteresis_memory memory, pzs_real sign, pzs_real from)
{
    const size_t set = set_of(tables, input), first = set * tables->plays;
    const bool is_up = sign > 0;
    effect_walk walk = {.slope = tables->slope + set * SEGMENTS,
                        .slack = tables->slack + first,
                        .play = memory.play,
                        .ahead = (is_up ? tables->above : tables->below) + first,
                        .behind = (is_up ? tables->below : tables->above) + first,
                        .sign = sign,
                        .knot = tables->half_range[set] / 2,
                        .place = sign * (from - tables->middle[set]),
                        .plays = tables->plays};
    walk.gain = slope_of(&walk, 0);
    return walk;
}

/* Place at which the next play begins to move. */
static pzs_real next_move(const effect_walk *walk)
{
    const uint32_t i = walk->moving;
    return i < walk->plays ? walk->sign * walk->play[i] + walk->slack[i] : NOWHERE;
}

/* Place at which the next moving play crosses the middle. */
static pzs_real next_crossing(const effect_walk *walk)
{
    return walk->crossed < walk->moving ? walk->slack[walk->crossed] : NOWHERE;
}

/* Place of the next knot of the line. */
static pzs_real next_knot(const effect_walk *walk)
{
    return walk->knots + 1u < SEGMENTS ? ((pzs_real)walk->knots - 1) * walk->knot : NOWHERE;
}

/* Let the next play move, from before or from beyond the middle. */
static void move_play(effect_walk *walk)
{
    const uint32_t i = walk->moving++;
    const bool is_beyond = walk->slack[i] <= walk->place;
    walk->gain += is_beyond ? walk->ahead[i] : walk->behind[i];
    walk->crossed = is_beyond ? walk->moving : walk->crossed;
}

/* Pass the nearest break of the line of straight pieces. */
static void pass_break(effect_walk *walk, pzs_real nearest)
{
    if (next_crossing(walk) <= nearest) {
        walk->gain += walk->ahead[walk->crossed] - walk->behind[walk->crossed];
        walk->crossed++;
    } else if (next_move(walk) <= nearest) {
        move_play(walk);
    } else {
        walk->gain += slope_of(walk, walk->knots + 1u) - slope_of(walk, walk->knots);
        walk->knots++;
    }
}

static pzs_real smaller(pzs_real one, pzs_real other)
{
    return one < other ? one : other;
}

pzs_real pzs_hysteresis_voltage(const pzs_hysteresis *tables, uint32_t input,
                                hysteresis_memory memory, pzs_real from, pzs_real effect)
{
    const pzs_real way = effect - pzs_hysteresis_effect(tables, input, memory, from);
    const pzs_real sign = way < 0 ? -1 : 1;
    effect_walk walk = start_walk(tables, input, memory, sign, from);
    pzs_real rest = number_absolute(way);
    const uint32_t breaks = 2u * walk.plays + SEGMENTS;
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
    return tables->middle[set_of(tables, input)] + sign * (walk.place + rest / walk.gain);
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

/* Let the compensator point to its tables and its arrays. */
static void place(pzs_compensator *compensator, const pzs_hysteresis *tables)
{
    const size_t n = tables->inputs;
    pzs_real *at = (void *)((uint8_t *)compensator + PZS_ALIGNED(sizeof *compensator));
    compensator->state.tables = tables;
    compensator->state.effect = at;
    compensator->state.lower = at + n;
    compensator->state.upper = at + 2 * n;
    compensator->state.play = at + 3 * n;
    compensator->state.creep = at + 3 * n + play_count(tables);
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
 * Range of the voltages that input k may have in this tick. Returns whether its step limit and its
 * voltage limits overlap; if not, the voltage limit takes precedence.
 */
static bool set_range(pzs_compensator *compensator, const pzs_control *control, uint32_t k,
                      pzs_real given)
{
    const pzs_real lower = control->state.lower[k], upper = control->state.upper[k];
    const pzs_real down = step_down(given, control->state.step_limit[k]);
    const pzs_real up = step_up(given, control->state.step_limit[k]);
    const pzs_real low = down > lower ? down : lower, high = up < upper ? up : upper;
    const bool overlaps = low <= high;
    const pzs_real limit = given < lower ? lower : upper;
    compensator->state.lower[k] = overlaps ? low : limit;
    compensator->state.upper[k] = overlaps ? high : limit;
    return overlaps;
}

/*
 * Replace the limits of input k by the effects at the ends of its range, after its voltage has been
 * remembered.
 */
static void set_effect_limits(const pzs_compensator *compensator, pzs_control *control, uint32_t k)
{
    const pzs_hysteresis *tables = compensator->state.tables;
    const hysteresis_memory memory = memory_of(compensator, k);
    const pzs_real low = pzs_hysteresis_effect(tables, k, memory, compensator->state.lower[k]);
    const pzs_real high = pzs_hysteresis_effect(tables, k, memory, compensator->state.upper[k]);
    control->state.lower[k] = smaller(low, high);
    control->state.upper[k] = high;
}

/* Factor of epsilon by which an effect may differ from that of the last prediction. */
#define ROUNDING 256

/*
 * Let the controller work with the effects in the place of voltages. Where they are those of its
 * last prediction but for rounding, as after every tick whose voltages were given out unchanged,
 * the prediction is still valid.
 */
static void take_effects(const pzs_compensator *compensator, pzs_control *control)
{
    const pzs_hysteresis *tables = compensator->state.tables;
    const pzs_real *effect = compensator->state.effect, *base = control->state.optimiser.base;
    bool is_known = control->state.behind == PZS_BEHIND_NOTHING;
    for (uint32_t k = 0; k < tables->inputs && is_known; k++) {
        const size_t set = set_of(tables, k);
        const pzs_real size = number_absolute(tables->middle[set]) + tables->half_range[set];
        is_known = number_absolute(effect[k] - base[k]) <= ROUNDING * PZS_EPSILON * size;
    }
    for (uint32_t k = 0; k < tables->inputs; k++)
        control->state.voltage[k] = is_known ? base[k] : effect[k];
    if (!is_known)
        pzs_control_moved(control);
    control->state.has_step_limits = false;
    pzs_control_share_bounds(&control->state.optimiser, control);
}

static pzs_status effect_tick(void *self, pzs_loop_signals *signals)
{
    pzs_compensator *compensator = self;
    pzs_control *control = signals->control;
    const pzs_hysteresis *tables = signals->tables;
    int32_t clash = -1;
    place(compensator, tables);
    for (uint32_t k = 0; k < tables->inputs; k++) {
        const pzs_real given = signals->given[k];
        const hysteresis_memory memory = memory_of(compensator, k);
        compensator->state.effect[k] = pzs_hysteresis_effect(tables, k, memory, given);
        pzs_hysteresis_remember(tables, k, memory, given, 1u + signals->missed);
        if (!set_range(compensator, control, k, given) && clash < 0)
            clash = (int32_t)k;
        set_effect_limits(compensator, control, k);
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

/* Voltage of input k that has the effect which the control step has chosen, inside its range. */
static pzs_real voltage_of(const pzs_compensator *compensator, const pzs_control *control,
                           const pzs_real *given, uint32_t k)
{
    const pzs_real lower = compensator->state.lower[k], upper = compensator->state.upper[k];
    const pzs_real wanted = control->state.voltage[k];
    if (!(wanted < control->state.upper[k]))
        return upper;
    if (!(wanted > control->state.lower[k]))
        return lower;
    const pzs_real voltage = pzs_hysteresis_voltage(compensator->state.tables, k,
                                                    memory_of(compensator, k), given[k], wanted);
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
