/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Vibration damper: estimates the vibration modes of the structure from the sensor readings, and
 * changes the objective of the control tick so that the voltages damp them.
 *
 * A mode has the modal coordinate q, the angular frequency w0 and the state (d, p), which one tick
 * under constant voltages multiplies by a 2 x 2 matrix:
 *   d = q - g v - w  deviation from static equilibrium
 *   g v              static modal coordinate under the voltages v (g: response per volt)
 *   w                static modal coordinate under the loads
 *   p                velocity / w0
 *
 * An observer of constant gain estimates q, p and w. It corrects the state that was predicted for
 * the time of the readings, `delay` ticks ago, and predicts the present state from the corrected
 * one.
 *
 * Where amplifiers lag, their output y follows the commanded voltages v with one time constant. All
 * that the damper computes from voltages is linear in them, so it filters the results:
 *   a  part of y - v that is left after a tick;  b  mean of this part in the tick
 *   y(next tick) = v + a (y - v),  mean of y in the tick = v + b (y - v)
 * The modes are predicted with the mean of y. The voltages are to move y as they would move v
 * without lag: by an amount c d(k) in tick k, with the deviation d of a mode from its equilibrium
 * under y. For this they have to change by
 *   c (d(k) - a d(k - 1)) / (1 - a).
 * The damper finds d(k - 1) by turning the mode back by a tick. For a sine this change has the
 * phase of d before the lag, so that step limits, which cut it, do not turn the phase of y. With
 * the position, velocity and y - v of a mode it is a sum of three terms.
 *
 * Work of a tick (multiply-adds), besides the optimisation of the voltages: at most
 *   3 * modes * (sensors + outputs) + inputs * (sensors + 2 * modes) + outputs * sensors
 */
#include <string.h>
#include "pzs_loop.h"
#include "control.h"
#include "scrub.h"
#include "../core/guard.h"
#include "../core/numbers.h"
#include "../core/product.h"
#include "../core/unrolled.h"
#include "sensor_check.h"

#define READY 1u
/*
 * A reading whose difference from the predicted reading exceeds this number counts as missing, so
 * that sums of squares do not overflow.
 */
#define DEVIATION_LIMIT PZS_R(1e12)

/* ---- tables ----------------------------------------------------------- */

/* List the arrays that the checksum of the vibration tables covers. Returns their number. */
static uint32_t list_parts(const pzs_vibration *tables, pzs_table_part part[PZS_TABLE_PARTS])
{
    const size_t modes = tables->modes, inputs = tables->inputs, sensors = tables->sensors;
    part[0] = (pzs_table_part){&tables->inputs, 5u * sizeof tables->inputs};
    part[1] = scrub_reals(tables->shape, tables->outputs * modes);
    part[2] = scrub_reals(tables->reading, sensors * modes);
    part[3] = scrub_reals(tables->direct, sensors * inputs);
    part[4] = scrub_reals(tables->gain, tables->outputs * sensors);
    part[5] = scrub_reals(tables->precision, sensors);
    part[6] = scrub_reals(tables->modal, modes * inputs);
    part[7] = scrub_reals(tables->turn, 4 * modes);
    part[8] = scrub_reals(tables->observer, 3 * modes * modes);
    part[9] = scrub_reals(tables->explain, modes * modes);
    part[10] = scrub_reals(tables->damping, modes * inputs);
    part[11] = scrub_reals(tables->inverse_angle, modes);
    part[12] = scrub_reals(&tables->share, 3);
    part[13] = scrub_reals(tables->lag, tables->lag != NULL ? 2 + 2 * modes : 0);
    return 14;
}

static uint32_t checksum(const pzs_vibration *tables)
{
    pzs_table_part part[PZS_TABLE_PARTS];
    return pzs_scrub_crc(part, list_parts(tables, part));
}

static bool are_complete(const pzs_vibration *tables)
{
    const bool few = tables->reading != NULL;
    const bool is_either = (tables->direct != NULL) == few && (tables->gain != NULL) == few;
    const bool has_sensors = few ? tables->sensors > 0 : tables->sensors == tables->outputs;
    return tables->shape != NULL && tables->modal != NULL && tables->turn != NULL &&
           tables->observer != NULL && tables->explain != NULL && tables->damping != NULL &&
           tables->inverse_angle != NULL && is_either && has_sensors;
}

pzs_status pzs_vibration_seal(pzs_vibration *tables)
{
    if (tables == NULL || !are_complete(tables))
        return PZS_E_ARGUMENT;
    tables->format = PZS_TABLE_FORMAT;
    tables->crc = checksum(tables);
    return PZS_OK;
}

static bool is_finite_array(const pzs_real *value, size_t count)
{
    return value == NULL || pzs_guard_nonfinite(value, (uint32_t)count) < 0;
}

static bool are_finite(const pzs_vibration *tables)
{
    const size_t modes = tables->modes, inputs = tables->inputs, sensors = tables->sensors;
    return is_finite_array(tables->shape, tables->outputs * modes) &&
           is_finite_array(tables->reading, sensors * modes) &&
           is_finite_array(tables->direct, sensors * inputs) &&
           is_finite_array(tables->gain, tables->outputs * sensors) &&
           is_finite_array(tables->precision, sensors) &&
           is_finite_array(tables->modal, modes * inputs) &&
           is_finite_array(tables->turn, 4 * modes) &&
           is_finite_array(tables->observer, 3 * modes * modes) &&
           is_finite_array(tables->explain, modes * modes) &&
           is_finite_array(tables->damping, modes * inputs) &&
           is_finite_array(tables->inverse_angle, modes) &&
           is_finite_array(tables->lag, 2 + 2 * modes);
}

/* Whether the lag of the amplifiers, if there is one, takes the output to the commanded voltage. */
static bool is_lag_stable(const pzs_real *lag)
{
    return lag == NULL || (lag[0] >= 0 && lag[0] < 1 && lag[1] >= 0 && lag[1] <= 1);
}

static bool are_in_range(const pzs_vibration *tables)
{
    return is_lag_stable(tables->lag) && tables->delay <= PZS_DELAY_LIMIT && tables->share > 0 &&
           tables->share <= 1 && tables->mix >= 0 && tables->mix <= 1 && tables->slow >= 0 &&
           tables->slow <= 1;
}

static pzs_status check(const pzs_vibration *tables, const pzs_problem *problem)
{
    if (tables->format != PZS_TABLE_FORMAT || tables->scene != problem->scene)
        return PZS_E_FORMAT;
    const bool fits = tables->inputs == problem->inputs && tables->outputs == problem->outputs;
    if (!fits || !are_complete(tables) || !are_in_range(tables))
        return PZS_E_ARGUMENT;
    if (checksum(tables) != tables->crc)
        return PZS_E_CRC;
    return are_finite(tables) ? PZS_OK : PZS_E_NONFINITE;
}

/* ---- modes ------------------------------------------------------------ */

static size_t width_of(const pzs_damper *damper)
{
    return PZS_FOURS(damper->state.tables->modes);
}

static size_t sensor_width(const pzs_damper *damper)
{
    return PZS_FOURS(damper->state.tables->sensors);
}

/*
 * Return the index of the row that belongs to a tick in the ring buffer of the static modal
 * coordinates and readings of the last ticks. Age 0 is the present tick; age `delay` is the tick in
 * which the present readings were taken.
 */
static size_t row_of(const pzs_damper *damper, uint32_t age)
{
    const uint32_t rows = damper->state.tables->delay + 1u;
    return (damper->state.newest + rows - age) % rows;
}

static pzs_real *equilibrium_of(const pzs_damper *damper, uint32_t age)
{
    return damper->state.equilibrium + row_of(damper, age) * width_of(damper);
}

static pzs_real *expected_of(const pzs_damper *damper, uint32_t age)
{
    return damper->state.expected + row_of(damper, age) * sensor_width(damper);
}

/*
 * Advance the first-order lag of the amplifiers by a tick, for numbers that are proportional to
 * their voltages.
 *   output [count] in/out  numbers under the output voltages, at the last and at the present tick
 *   number [count] in/out  in: under the commanded voltages; out: mean under the output voltages
 */
static void lag_numbers(const pzs_vibration *tables, pzs_real *output, pzs_real *number,
                        size_t count)
{
    const pzs_real kept = tables->lag[0], mean = tables->lag[1];
    for (size_t i = 0; i < count; i++) {
        const pzs_real behind = output[i] - number[i];
        output[i] = number[i] + kept * behind;
        number[i] += mean * behind;
    }
}

/*
 * Replace the static modal coordinates and readings in the newest row of the ring buffer, which are
 * those under the commanded voltages, by their means under the output voltages of the amplifiers.
 */
static void lag_voltages(pzs_damper *damper)
{
    const pzs_vibration *tables = damper->state.tables;
    const size_t modes = tables->modes;
    pzs_real *equilibrium = equilibrium_of(damper, 0), *output = damper->state.output;
    for (size_t i = 0; i < modes; i++)
        damper->state.behind[i] = output[i] - equilibrium[i];
    lag_numbers(tables, output, equilibrium, modes);
    lag_numbers(tables, output + width_of(damper), expected_of(damper, 0), tables->sensors);
}

/*
 * Compute the modal coordinates and the readings of static equilibrium under the present voltages,
 * as commanded, and store them in the newest row of the ring buffer that holds those of the last
 * ticks.
 */
static void record_commands(pzs_damper *damper)
{
    const pzs_vibration *tables = damper->state.tables;
    pzs_control *control = damper->state.control;
    pzs_product_matrix(equilibrium_of(damper, 0), tables->modal, control->state.voltage,
                       tables->modes, tables->inputs);
    if (tables->direct != NULL) {
        pzs_product_matrix(expected_of(damper, 0), tables->direct, control->state.voltage,
                           tables->sensors, tables->inputs);
    } else {
        pzs_control_predict(control);
        if (expected_of(damper, 0) != control->state.predicted)
            memcpy(expected_of(damper, 0), control->state.predicted,
                   tables->sensors * sizeof(pzs_real));
    }
}

/* The same, with the lag of the amplifiers. */
static void record_voltages(pzs_damper *damper)
{
    record_commands(damper);
    if (damper->state.output != NULL)
        lag_voltages(damper);
}

/*
 * Predict the state of all vibration modes one tick ahead. The width is the number of vibration
 * modes rounded up to a multiple of 4.
 *   state [3][width]    in/out  position, velocity and static position under loads of each mode
 *   equilibrium [width] in      static modal coordinates under the voltages of this tick
 */
static void predict(const pzs_damper *damper, pzs_real *state, const pzs_real *equilibrium)
{
    const pzs_vibration *tables = damper->state.tables;
    const size_t modes = tables->modes, width = width_of(damper);
    const pzs_real *turn = tables->turn;
    pzs_real *position = state, *velocity = state + width;
    const pzs_real *load = state + 2 * width;
    for (size_t i = 0; i < modes; i++) {
        const pzs_real rest = equilibrium[i] + load[i];
        const pzs_real deviation = position[i] - rest, speed = velocity[i];
        position[i] = rest + (turn[i] * deviation + turn[modes + i] * speed);
        velocity[i] = turn[2 * modes + i] * deviation + turn[3 * modes + i] * speed;
    }
}

/*
 * Copy the static modal coordinates and static readings of the previous tick into the newest row of
 * the ring buffer of the last ticks, because the voltages have not changed.
 */
static void repeat_voltages(pzs_damper *damper)
{
    const pzs_vibration *tables = damper->state.tables;
    if (tables->delay == 0)
        return; /* Without delay of the sensors, the ring buffer of static modal coordinates and
                   readings has only one row, so there is no previous row to copy. */
    memcpy(equilibrium_of(damper, 0), equilibrium_of(damper, 1), tables->modes * sizeof(pzs_real));
    memcpy(expected_of(damper, 0), expected_of(damper, 1), tables->sensors * sizeof(pzs_real));
}

/*
 * Return the exclusive or of all words in one row of the ring buffers of static modal coordinates
 * and readings.
 */
static uint32_t row_sum(const pzs_damper *damper, uint32_t age)
{
    const pzs_vibration *tables = damper->state.tables;
    return pzs_guard_word_sum(equilibrium_of(damper, age), tables->modes * sizeof(pzs_real)) ^
           pzs_guard_word_sum(expected_of(damper, age), tables->sensors * sizeof(pzs_real));
}

/* Store the sum of the words in the newest row of the ring buffers. */
static void keep_row(pzs_damper *damper)
{
    if (damper->state.tables->delay > 0)
        damper->state.row_sum[row_of(damper, 0)] = row_sum(damper, 0);
}

/*
 * Advance the ring buffer of static modal coordinates and readings by one tick: its newest row
 * receives those under the present voltages.
 *   is_same in  true: the voltages are those of the previous tick
 */
static void advance(pzs_damper *damper, bool is_same)
{
    damper->state.newest =
        (uint16_t)((damper->state.newest + 1u) % (damper->state.tables->delay + 1u));
    if (is_same && damper->state.tables->lag == NULL)
        repeat_voltages(damper);
    else
        record_voltages(damper);
    keep_row(damper);
    predict(damper, damper->state.late, equilibrium_of(damper, damper->state.tables->delay));
}

/*
 * Predict the state of the vibration modes at the present tick from the corrected state at the time
 * at which the readings were taken.
 */
static void catch_up(pzs_damper *damper)
{
    const size_t width = width_of(damper);
    memcpy(damper->state.now, damper->state.late, 3 * width * sizeof(pzs_real));
    for (uint32_t age = damper->state.tables->delay; age-- > 0;)
        predict(damper, damper->state.now, equilibrium_of(damper, age));
}

/*
 * Keep the velocities of the vibration modes at the last tick. They are predicted once more from
 * the state that is protected against damaged memory.
 */
static void keep_velocity(pzs_damper *damper)
{
    const size_t width = width_of(damper);
    const pzs_real *state = damper->state.late;
    if (damper->state.tables->delay > 0) {
        catch_up(damper);
        state = damper->state.now;
    }
    memcpy(damper->state.velocity_before, state + width, width * sizeof *state);
}

/* ---- damaged memory ---------------------------------------------------- */

/*
 * Factor by which rounding errors may raise the squared norm of the residuals above its bound. It
 * is generous, as only damage far above the usual size of the residuals must be found.
 */
#define RESIDUAL_ROUNDING 2

/*
 * Store a copy of an array behind it, for the next tick. Returns the sum of its words.
 *   state [2][count] in/out  array and copy; count is a multiple of 4
 */
static uint32_t keep_copy(pzs_real *state, size_t count)
{
    memcpy(state + count, state, count * sizeof *state);
    return pzs_guard_word_sum(state, count * sizeof *state);
}

/*
 * If an array is not that of the end of the last tick, take its copy. Where the copy has another
 * sum as well, the sum itself is damaged.
 *   state [2][count] in/out  array and copy
 *   sum              in      result of keep_copy
 */
static void repair_copy(pzs_real *state, size_t count, uint32_t sum)
{
    const size_t bytes = count * sizeof *state;
    if (pzs_guard_word_sum(state, bytes) != sum && pzs_guard_word_sum(state + count, bytes) == sum)
        memcpy(state, state + count, bytes);
}

/* Number of entries of the static positions and readings under the amplifiers' output voltages. */
static size_t output_width(const pzs_damper *damper)
{
    return width_of(damper) + sensor_width(damper);
}

/* Store a copy of the state of the vibration modes for the next tick, and the sum of its words. */
static void keep_state(pzs_damper *damper)
{
    damper->state.late_sum = keep_copy(damper->state.late, 4 * width_of(damper));
    if (damper->state.output != NULL)
        damper->state.output_sum = keep_copy(damper->state.output, output_width(damper));
}

/*
 * Repair the state of the vibration modes and of the amplifiers. One damaged number would otherwise
 * drive the voltages to their limits, for as long as the observer takes to forget it.
 */
static void repair_state(pzs_damper *damper)
{
    repair_copy(damper->state.late, 4 * width_of(damper), damper->state.late_sum);
    if (damper->state.output != NULL)
        repair_copy(damper->state.output, output_width(damper), damper->state.output_sum);
}

/*
 * Replace damaged rows of the ring buffers of static modal coordinates and readings by the row of
 * the next tick, the newest row by that of the tick before, as voltages change little in a tick.
 * Without delay both are computed anew in each tick.
 */
static void repair_rows(pzs_damper *damper)
{
    const pzs_vibration *tables = damper->state.tables;
    for (uint32_t age = 0; tables->delay > 0 && age <= tables->delay; age++) {
        const uint32_t other = age > 0 ? age - 1u : 1u;
        uint32_t *sum = &damper->state.row_sum[row_of(damper, age)];
        if (row_sum(damper, age) == *sum)
            continue;
        memcpy(equilibrium_of(damper, age), equilibrium_of(damper, other),
               tables->modes * sizeof(pzs_real));
        memcpy(expected_of(damper, age), expected_of(damper, other),
               tables->sensors * sizeof(pzs_real));
        *sum = row_sum(damper, age);
    }
}

/* Repair what the damper keeps from tick to tick. */
static void repair(pzs_damper *damper)
{
    repair_state(damper);
    repair_rows(damper);
}

/* Whether residuals with the sum of squares `energy` cannot exceed `most`, their bound. */
static bool is_within(pzs_real energy, pzs_real most)
{
    return energy <= RESIDUAL_ROUNDING * most * most;
}

/*
 * Update the bound of the norm of the residuals, which are the low-passed innovations. If they
 * exceed it, memory was damaged: start the low-pass filter again from the present innovations, and
 * their modal coordinates from `change`.
 *   sudden in  sum of the squared differences between the innovations and the residuals
 */
static void check_residuals(pzs_damper *damper, pzs_real sudden, const pzs_real *change)
{
    const pzs_vibration *tables = damper->state.tables;
    const pzs_real size = damper->state.innovation_norm, before = damper->state.residual_most;
    damper->state.residual_most = before + tables->slow * (size - before);
    if (is_within(sudden, size + before))
        return;
    memcpy(damper->state.residual, damper->state.innovation, tables->sensors * sizeof *change);
    memcpy(damper->state.residual_modes, change, tables->modes * sizeof *change);
    damper->state.residual_most = size;
}

/* ---- readings --------------------------------------------------------- */

/* Return the table [sensors][modes] of readings per unit of each modal coordinate. */
static const pzs_real *readings_table(const pzs_vibration *tables)
{
    return tables->reading != NULL ? tables->reading : tables->shape;
}

/*
 * Predict the readings from the voltages and the estimated vibration modes at the time at which the
 * readings were taken.
 */
static void predict_readings(pzs_damper *damper)
{
    const pzs_vibration *tables = damper->state.tables;
    const pzs_real *equilibrium = equilibrium_of(damper, tables->delay);
    const pzs_real *expected = expected_of(damper, tables->delay);
    pzs_real *deviation = damper->state.work, *predicted = damper->state.predicted;
    for (uint32_t i = 0; i < tables->modes; i++)
        deviation[i] = damper->state.late[i] - equilibrium[i];
    pzs_product_add(predicted, expected, readings_table(tables), deviation, tables->sensors,
                    tables->modes);
}

/*
 * Compute the residuals of all sensors: the low-passed innovation (reading minus predicted reading)
 * of each sensor, minus the part that the vibration modes explain.
 *   rest [sensors] out  residuals (unit of each sensor)
 */
static void find_residuals(pzs_damper *damper, pzs_real *rest)
{
    const pzs_vibration *tables = damper->state.tables;
    pzs_real *explained = damper->state.work;
    for (uint32_t i = 0; i < tables->modes; i++)
        explained[i] = -damper->state.residual_modes[i];
    pzs_product_add(rest, damper->state.residual, readings_table(tables), explained,
                    tables->sensors, tables->modes);
}

/*
 * Replace the innovation (reading minus predicted reading) of each sensor with an unusable reading
 * by the low-passed innovation of earlier ticks, minus the part that the vibration modes explain.
 * Returns the number of unusable readings; *where receives the index of the first one.
 */
static uint32_t replace_unusable(pzs_damper *damper, int32_t *where)
{
    const uint32_t sensors = damper->state.tables->sensors;
    const uint8_t *repeats = damper->state.repeats;
    pzs_real *innovation = damper->state.innovation, *rest = damper->state.predicted;
    const pzs_real *residual = damper->state.residual;
    const pzs_real most = RESIDUAL_ROUNDING * damper->state.residual_most;
    uint32_t unusable = 0;
    find_residuals(damper, rest);
    for (uint32_t i = 0; i < sensors; i++) {
        if (!sensor_is_unusable(repeats[i]) && number_absolute(innovation[i]) <= DEVIATION_LIMIT)
            continue;
        innovation[i] = number_absolute(residual[i]) <= most ? rest[i] : 0;
        *where = unusable++ == 0 ? (int32_t)i : *where;
    }
    return unusable;
}

/*
 * Compute the innovation of each sensor, its reading minus its predicted reading. Returns the
 * number of unusable readings; *where receives the index of the first one.
 */
static uint32_t compare(pzs_damper *damper, const pzs_real *readings, int32_t *where)
{
    const uint32_t sensors = damper->state.tables->sensors;
    pzs_real *innovation = damper->state.innovation;
    const sensor_check all = {sensors, damper->state.predicted, damper->state.sensed, innovation,
                              damper->state.repeats};
    predict_readings(damper);
    damper->info.is_repeated = true;
    const uint32_t rejected = pzs_sensor_check(&all, readings, where, &damper->info.is_repeated);
    const pzs_real energy = pzs_product_dot(innovation, innovation, sensors);
    const bool is_small = energy <= DEVIATION_LIMIT * DEVIATION_LIMIT;
    damper->state.innovation_norm = is_small ? PZS_SQRT(energy) : damper->state.residual_most;
    return rejected == 0 && is_small ? 0 : replace_unusable(damper, where);
}

/*
 * Project the innovations (readings minus predicted readings), each multiplied by the precision of
 * its sensor (inverse variance of the noise), onto the vibration modes.
 *   fit [modes] out  products of innovations and mode shapes at the sensors
 */
static void project_innovation(pzs_damper *damper, pzs_real *fit)
{
    const pzs_vibration *tables = damper->state.tables;
    const pzs_real *innovation = damper->state.innovation;
    if (tables->precision != NULL) {
        pzs_real *weighted = damper->state.predicted;
        for (uint32_t i = 0; i < tables->sensors; i++)
            weighted[i] = tables->precision[i] * innovation[i];
        innovation = weighted;
    }
    pzs_product_sum_rows(fit, readings_table(tables), tables->modes, innovation, tables->sensors,
                         tables->modes);
}

/*
 * Low-pass filter: move each number of the array `filtered` by the fraction `slow` of the way to
 * that of the array `present`. Returns the sum of the squared differences between the two arrays
 * before the move.
 */
static pzs_real low_pass(pzs_real *restrict filtered, const pzs_real *restrict present,
                         pzs_real slow, size_t count)
{
    pzs_real energy = 0;
    for (size_t i = 0; i < count; i += 4) {
        UNROLLED
        for (size_t k = i; k < i + 4; k++) {
            const pzs_real fast = present[k] - filtered[k];
            filtered[k] += slow * fast;
            energy += fast * fast;
        }
    }
    return energy;
}

/*
 * Whether info.innovation reports only the part of the innovations (readings minus predicted
 * readings) that the vibration modes explain. This is so if three conditions hold: the target has
 * free functions (shapes, such as a tilt, that may be added to it at no cost), every target node is
 * measured, and vibration modes are observed. The reported number is an RMS over the sensors,
 * because single modal coordinates may be large but cancel each other.
 */
static bool has_free_functions(const pzs_vibration *tables)
{
    return tables->precision != NULL && tables->gain == NULL && tables->modes > 0;
}

static void add_vector(pzs_real *restrict sum, const pzs_real *restrict vector, size_t count)
{
    size_t i = 0;
    for (; i + 4 <= count; i += 4) {
        UNROLLED
        for (size_t k = i; k < i + 4; k++)
            sum[k] += vector[k];
    }
    for (; i < count; i++)
        sum[i] += vector[i];
}

/* Return the coordinates [modes] of the vibration modes by the readings alone (m). */
static pzs_real *modal_position(const pzs_damper *damper)
{
    return damper->state.work + width_of(damper);
}

/*
 * Correct the estimated state of the vibration modes at the time at which the readings were taken,
 * and low-pass the part of the readings that the modes do not explain. The sum of the predicted
 * modal coordinates and the part of the innovations that they explain is stored as modal_position.
 */
static void correct(pzs_damper *damper)
{
    const pzs_vibration *tables = damper->state.tables;
    const size_t modes = tables->modes, width = width_of(damper);
    pzs_real *fit = damper->state.work, *change = modal_position(damper);
    pzs_real *before = damper->state.now; // not needed until catch_up
    project_innovation(damper, fit);
    memcpy(before, damper->state.late, modes * sizeof *before);
    for (size_t part = 0; part < 3; part++) {
        pzs_real *state = damper->state.late + part * width;
        pzs_product_matrix(change, tables->observer + part * modes * modes, fit, modes, modes);
        for (size_t i = 0; i < modes; i++)
            state[i] += change[i];
    }
    pzs_product_matrix(change, tables->explain, fit, modes, modes);
    const pzs_real explained = pzs_product_dot(fit, change, modes);
    (void)low_pass(damper->state.residual_modes, change, tables->slow, modes);
    const pzs_real sudden =
        low_pass(damper->state.residual, damper->state.innovation, tables->slow, tables->sensors);
    check_residuals(damper, sudden, change);
    add_vector(change, before, modes);
    const pzs_real energy = has_free_functions(tables) ? explained : sudden;
    damper->info.innovation = energy > 0 ? PZS_SQRT(energy / (pzs_real)tables->sensors) : 0;
}

/* ---- results ---------------------------------------------------------- */

/*
 * A control tick that damps vibration chooses the voltages v that minimise, within all limits and
 * up to terms that do not depend on v,
 *   share * |W (B v + C w + r - z)|^2 / 2  -  v . sum_i damping_i d_i  +  |W B (v - v_last)|^2 / 2
 *   v_last     voltages of the last tick
 *   W, B, C    output weights, influence matrix, mode shapes
 *   w          static modal coordinates under the loads
 *   z, r       target shape; low-passed part of the shape that the modes do not explain
 *   damping_i  [inputs] row i of pzs_vibration.damping: decrease of the gradient per unit of d_i
 *   d_i        deviation of mode i from static equilibrium: (1 - mix) p_i + mix a_i
 *   p_i        modal coordinate minus its value in static equilibrium
 *   a_i        the same, estimated from the velocity alone, without static modal coordinates:
 *              decrease of (velocity / angular frequency) in a tick / (angular frequency * tick)
 *   share      from 0 to 1, slows the approach to the static optimum
 *
 * For exact modes observed without error, their energy plus the static objective never rises,
 * because every limit permits unchanged voltages. In static equilibrium the voltages are those of a
 * tick without damping.
 */

/*
 * Advance the phase of the deviations that the voltages damp by that of the amplifiers' lag.
 *   damped [modes] in/out  deviation of each vibration mode from its static equilibrium (m)
 */
static void lead_lag(const pzs_damper *damper, pzs_real *damped)
{
    const size_t modes = damper->state.tables->modes;
    const pzs_real *velocity = damper->state.now + width_of(damper),
                   *by_velocity = damper->state.tables->lag + 2, *by_lag = by_velocity + modes;
    for (size_t i = 0; i < modes; i++)
        damped[i] += by_velocity[i] * velocity[i] + by_lag[i] * damper->state.behind[i];
}

/*
 * Compute how far each vibration mode deviates from its static equilibrium, and the damping
 * gradient: the term in the gradient of the tick's objective by which the voltages damp the modes.
 */
static void damp(pzs_damper *damper)
{
    const pzs_vibration *tables = damper->state.tables;
    const size_t width = width_of(damper);
    const pzs_real *position = damper->state.now, *velocity = position + width,
                   *load = velocity + width, *before = damper->state.velocity_before,
                   *equilibrium = equilibrium_of(damper, 0);
    pzs_real *damped = damper->state.work, energy = 0;
    for (size_t i = 0; i < tables->modes; i++) {
        const pzs_real deviation = position[i] - load[i] - equilibrium[i];
        const pzs_real turned = (before[i] - velocity[i]) * tables->inverse_angle[i];
        damped[i] = deviation + tables->mix * (turned - deviation);
        energy += deviation * deviation + velocity[i] * velocity[i];
    }
    damper->info.deviation = PZS_SQRT(energy);
    if (tables->lag != NULL)
        lead_lag(damper, damped);
    pzs_product_sum_rows(damper->state.damping, tables->damping, tables->inputs, damped,
                         tables->modes, tables->inputs);
    const pzs_real share = damper->state.control->state.is_paused ? 0 : tables->share;
    pzs_control_damp(damper->state.control, share, damper->state.damping, damper->state.carry);
}

/*
 * Compute the static shape under the present voltages and loads, if the sensors measure the shape
 * itself: predicted shape, plus the shape of the vibration modes in static equilibrium under the
 * loads, plus the low-passed part of the readings that the modes do not explain.
 *   shape [outputs] out  static shape (m)
 */
static void measured_shape(pzs_damper *damper, pzs_real *shape)
{
    const pzs_vibration *tables = damper->state.tables;
    const pzs_real *load = damper->state.now + 2 * width_of(damper),
                   *predicted = damper->state.control->state.predicted;
    pzs_real *part = damper->state.work;
    for (size_t i = 0; i < tables->modes; i++)
        part[i] = load[i] - damper->state.residual_modes[i];
    pzs_product_add(shape, predicted, tables->shape, part, tables->outputs, tables->modes);
    add_vector(shape, damper->state.residual, tables->outputs);
}

/*
 * Compute the static shape under the present voltages and loads from few sensors: the predicted
 * shape, plus the shape of the vibration modes in static equilibrium, plus the estimator's gain
 * matrix times the readings that the modes do not explain.
 *   shape [outputs] out  static shape (m)
 */
static void estimated_shape(pzs_damper *damper, pzs_real *shape)
{
    const pzs_vibration *tables = damper->state.tables;
    const pzs_real *load = damper->state.now + 2 * width_of(damper);
    pzs_real *rest = damper->state.predicted, *still = damper->state.control->state.weighted;
    find_residuals(damper, rest);
    pzs_control_predict(damper->state.control);
    pzs_product_matrix(still, tables->gain, rest, tables->outputs, tables->sensors);
    add_vector(still, damper->state.control->state.predicted, tables->outputs);
    pzs_product_add(shape, still, tables->shape, load, tables->outputs, tables->modes);
}

/* ---- calls ------------------------------------------------------------ */

static pzs_status finish(pzs_damper *damper, pzs_status status, int32_t where)
{
    damper->info.where = where;
    return status;
}

/* Size of the workspace of a vibration damper (bytes). */
static size_t damper_bytes(const pzs_vibration *tables)
{
    const size_t lag = tables->lag != NULL ? PZS_LAG_BYTES(tables->modes, tables->sensors) : 0;
    return lag + PZS_DAMPER_BYTES(tables->modes, tables->inputs, tables->sensors, tables->delay);
}

/* Set the pointers of the vibration damper to its arrays in the workspace. */
static void lay_out(pzs_damper *damper, pzs_real *at)
{
    const size_t width = width_of(damper), sensors = sensor_width(damper);
    const size_t rows = damper->state.tables->delay + 1u;
    damper->state.late = at;
    damper->state.residual_modes = at + 3 * width;
    damper->state.now = at + 8 * width;
    damper->state.velocity_before = at + 11 * width;
    damper->state.work = at + 12 * width;
    damper->state.equilibrium = at + 14 * width;
    at += (14 + rows) * width;
    damper->state.predicted = at;
    damper->state.innovation = at + sensors;
    damper->state.sensed = at + 2 * sensors;
    damper->state.residual = at + 3 * sensors;
    // Without delay and lag the predicted shape of the controller lasts long enough.
    const bool lags = damper->state.tables->lag != NULL;
    const bool is_shared = rows == 1 && damper->state.tables->direct == NULL && !lags;
    damper->state.expected = is_shared ? damper->state.control->state.predicted : at + 4 * sensors;
    at += (4 + rows) * sensors;
    damper->state.damping = at;
    at += PZS_FOURS(damper->state.tables->inputs);
    damper->state.carry = at;
    at += PZS_FOURS(damper->state.tables->inputs);
    damper->state.output = lags ? at : NULL;
    damper->state.behind = at + 2 * (width + sensors);
    if (lags)
        at = damper->state.behind + width;
    damper->state.repeats = (uint8_t *)at;
    damper->info.position = damper->state.now;
    damper->info.velocity = damper->state.now + width;
    damper->info.load = damper->state.now + 2 * width;
}

/* Set the output voltages of amplifiers that lag to the present voltages. */
static void settle_amplifiers(pzs_damper *damper)
{
    const pzs_vibration *tables = damper->state.tables;
    pzs_real *output = damper->state.output;
    memcpy(output, equilibrium_of(damper, 0), tables->modes * sizeof *output);
    memcpy(output + width_of(damper), expected_of(damper, 0), tables->sensors * sizeof *output);
}

/*
 * Set the state of the vibration modes to that of a structure in static equilibrium under the
 * present voltages.
 */
static void set_initial_state(pzs_damper *damper)
{
    const size_t bytes = width_of(damper) * sizeof(pzs_real);
    for (uint32_t i = 0; i <= damper->state.tables->delay; i++) {
        damper->state.newest = (uint16_t)i;
        record_commands(damper);
        keep_row(damper);
    }
    if (damper->state.output != NULL)
        settle_amplifiers(damper);
    memcpy(damper->state.late, equilibrium_of(damper, 0), bytes);
    memcpy(damper->state.now, equilibrium_of(damper, 0), bytes);
    damper->state.residual_most = 0;
    keep_state(damper);
}

/* Set the pointers of the vibration damper to its controller, its tables and its arrays. */
static void place(pzs_damper *damper, pzs_control *control, const pzs_vibration *tables, void *work)
{
    damper->state.control = control;
    damper->state.tables = tables;
    damper->state.stage = READY;
    lay_out(damper, work);
}

pzs_status pzs_damper_init(pzs_damper *damper, pzs_control *control, const pzs_vibration *tables,
                           void *work, size_t bytes)
{
    if (damper == NULL)
        return PZS_E_ARGUMENT;
    memset(damper, 0, sizeof *damper);
    if (control == NULL || tables == NULL || work == NULL)
        return finish(damper, PZS_E_ARGUMENT, -1);
    const pzs_status status =
        control->state.stage == CONTROL_READY ? check(tables, control->state.problem) : PZS_E_STAGE;
    if (status != PZS_OK)
        return finish(damper, status, -1);
    const size_t need = damper_bytes(tables);
    const int32_t missing = guard_missing_bytes(work, bytes, need);
    if (missing >= 0)
        return finish(damper, PZS_E_WORKSPACE, missing);
    memset(work, 0, need);
    place(damper, control, tables, work);
    set_initial_state(damper);
    return finish(damper, PZS_OK, -1);
}

/* One tick without repair of damaged memory; arguments and result are those of pzs_damper_tick. */
static pzs_status tick(pzs_damper *damper, const pzs_real *readings, pzs_real *shape)
{
    const pzs_vibration *tables = damper->state.tables;
    uint32_t unusable = tables->sensors;
    int32_t where = -1;
    damper->info.is_repeated = false;
    keep_velocity(damper);
    advance(damper, false);
    if (readings != NULL)
        unusable = compare(damper, readings, &where);
    if (damper->info.is_repeated && damper->state.control->state.is_stuck)
        unusable = tables->sensors;
    if (unusable < tables->sensors)
        correct(damper);
    else
        damper->info.innovation = 0;
    catch_up(damper);
    damp(damper);
    if (tables->gain != NULL)
        estimated_shape(damper, shape);
    else
        measured_shape(damper, shape);
    if (readings == NULL || unusable == 0)
        return finish(damper, PZS_OK, -1);
    return finish(damper, unusable < tables->sensors ? PZS_W_SENSOR : PZS_W_HELD, where);
}

pzs_status pzs_damper_tick(pzs_damper *damper, const pzs_real *readings, pzs_real *shape)
{
    if (damper == NULL || shape == NULL)
        return PZS_E_ARGUMENT;
    if (damper->state.stage != READY)
        return PZS_E_STAGE;
    repair(damper);
    const pzs_status status = tick(damper, readings, shape);
    keep_state(damper);
    return status;
}

/* Predict the vibration modes over missed ticks, without repair of damaged memory. */
static void skip(pzs_damper *damper, uint16_t ticks)
{
    for (uint16_t i = 0; i < ticks; i++)
        advance(damper, i > 0);
    if (ticks > 0)
        catch_up(damper);
}

pzs_status pzs_damper_skip(pzs_damper *damper, uint16_t ticks)
{
    if (damper == NULL)
        return PZS_E_ARGUMENT;
    if (damper->state.stage != READY)
        return PZS_E_STAGE;
    repair(damper);
    skip(damper, ticks);
    keep_state(damper);
    return finish(damper, PZS_OK, -1);
}

/* ---- block ------------------------------------------------------------ */

static size_t workspace_of(const pzs_vibration *tables)
{
    return PZS_ALIGNED(damper_bytes(tables));
}

static size_t block_bytes(const void *tables, const pzs_problem *problem)
{
    const pzs_vibration *vibration = tables;
    if (vibration->lag != NULL)
        return PZS_VIBRATION_BLOCK_LAG_BYTES(vibration->modes, vibration->inputs, problem->outputs,
                                             vibration->sensors, vibration->delay);
    return PZS_VIBRATION_BLOCK_BYTES(vibration->modes, vibration->inputs, problem->outputs,
                                     vibration->sensors, vibration->delay);
}

static void *work_of(pzs_damper *damper)
{
    return (uint8_t *)damper + PZS_ALIGNED(sizeof *damper);
}

/*
 * Initialise the vibration damper as a block (stage of the control tick). Its memory holds the
 * struct pzs_damper, then the workspace of the damper, then the estimated shape without vibration
 * [outputs].
 */
static pzs_status block_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    const pzs_vibration *vibration = tables;
    pzs_damper *damper = self;
    /*
     * The damper is refused where actuators have curves, because it computes static equilibria as
     * if the displacements of the actuators were proportional to their voltages.
     */
    if (signals->curves != NULL)
        return PZS_E_STAGE;
    const pzs_status status = pzs_damper_init(damper, signals->control, vibration, work_of(damper),
                                              workspace_of(vibration));
    signals->where = damper->info.where;
    signals->sensors = vibration->sensors;
    signals->vibration = vibration;
    return status;
}

static pzs_status block_tick(void *self, pzs_loop_signals *signals)
{
    pzs_damper *damper = self;
    const pzs_vibration *tables = signals->tables;
    pzs_real *shape = (void *)((uint8_t *)work_of(damper) + workspace_of(tables));
    place(damper, signals->control, tables, work_of(damper));
    repair(damper);
    skip(damper, (uint16_t)signals->missed);
    const pzs_status status = tick(damper, signals->readings, shape);
    keep_state(damper);
    /*
     * Damaged memory may make the state of the vibration modes infinite or NaN; the state then
     * starts again in static equilibrium.
     */
    if (!number_is_finite(damper->info.deviation)) {
        memset(work_of(damper), 0, workspace_of(tables));
        set_initial_state(damper);
    }
    signals->vibration = tables;
    signals->measured = shape;
    signals->is_repeated = damper->info.is_repeated;
    signals->delay = tables->delay;
    signals->sensed = damper->state.sensed;
    signals->expected = expected_of(damper, 0);
    signals->modal_position = modal_position(damper);
    signals->modal_rest = equilibrium_of(damper, tables->delay);
    signals->deviation = PZS_SQRT(damper->info.deviation * damper->info.deviation +
                                  damper->info.innovation * damper->info.innovation);
    signals->where = damper->info.where;
    return status;
}

static uint32_t block_parts(const void *tables, uint32_t number,
                            pzs_table_part part[PZS_TABLE_PARTS], uint32_t *crc)
{
    const pzs_vibration *table = tables;
    *crc = table->crc;
    return number == 0 ? list_parts(table, part) : 0;
}

const pzs_block_type pzs_vibration_block = {"vibration", PZS_PHASE_SHAPE, block_bytes,
                                            block_init,  block_tick,      block_parts};
