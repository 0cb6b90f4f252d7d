/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Self-test of amplifiers, cables and sensors before the loop takes control (pzs_loop.h).
 *
 * The amplifiers are moved one after the other, because the response to a single electrode can be
 * recognised even if gains, natural frequencies and hysteresis differ much from the model. Patterns
 * in which many amplifiers move at once would need as many pulses for as many unknowns, and would
 * hide a weak electrode behind the errors of strong ones.
 *
 * Before the first of these pulses, all amplifiers make one slow pulse together. It brings the
 * ceramic of every electrode into the minor hysteresis loop of the later pulses, whatever voltages
 * the electrode had before, so that the gains of electrodes can be compared with each other.
 *
 * Pulses and the weights of the readings are those of test_pulse.h.
 *
 * The evaluation compares the matrix of the measured responses with that of the model. A column of
 * these matrices is the response of all sensors to one amplifier, a row is the response of one
 * sensor to all amplifiers. First, the column or row that differs most from the model is
 * reported if it is reversed. Then pairs of similar columns and of similar rows are compared,
 * because two amplifiers or sensors with exchanged cables may respond so similarly that neither
 * looks faulty alone. Then each tick reports the amplifier or sensor whose column or row differs
 * most from the model, and excludes it from later comparisons: a faulty amplifier also changes the
 * rows of sensors near it, but by less than its own column, and a faulty sensor changes the columns
 * of amplifiers likewise.
 */
#include <string.h>
#include "pzs_loop.h"
#include "control.h"
#include "scrub.h"
#include "test_pulse.h"
#include "../core/guard.h"
#include "../core/numbers.h"

/*
 * A sensor reading that is larger than this counts as missing, so that no sum of squares overflows.
 */
#define READING_LIMIT PZS_R(1e12)
/*
 * A sensor counts as noisy if the variance of its noise exceeds this multiple of the mean variance
 * of the noise of all other sensors.
 */
#define UNUSUAL PZS_R(16)
/*
 * An amplifier or sensor counts as silent if its measured response is smaller than this fraction of
 * the response expected from the model.
 */
#define SILENT PZS_R(0.3)
/*
 * A measured response counts as that of another amplifier or sensor (exchanged cables) only if its
 * energy, the sum of its squares, exceeds this multiple of the energy of noise and vibration.
 */
#define RESPONSE PZS_R(16)
/*
 * Smallest and largest plausible mean gain of all amplifiers: measured response divided by modelled
 * response. Electrodes with hysteresis respond to a small voltage with as little as a third of the
 * response per volt to a large voltage.
 */
#define LEAST_GAIN PZS_R(0.15)
#define LARGEST_GAIN PZS_R(2)
/*
 * Smallest noise that the self-test assumes for a sensor, relative to its largest plausible noise.
 */
#define LEAST_NOISE PZS_R(0.01)
/*
 * Number of times that the self-test computes the mean gain of the amplifiers again, each time
 * without the amplifiers that it shows to be silent.
 */
#define GAIN_ROUNDS 3
/*
 * SWAP_GAIN: two amplifiers, or two sensors, count as swapped if exchanging them divides their
 * differences from the model by at least this number. SWAP_NOISE: the differences must also exceed
 * this multiple of what noise and vibration explain.
 */
#define SWAP_GAIN PZS_R(4)
#define SWAP_NOISE PZS_R(9)
/*
 * Two amplifiers, or two sensors, are so similar that exchanged cables cannot be noticed if the
 * squared sine of the angle between their modelled responses is less than SIMILAR times (noise
 * energy divided by response energy), plus SAME_DIRECTION.
 */
#define SIMILAR PZS_R(36)
#define SAME_DIRECTION PZS_R(1e-4)

/*
 * CONDITIONING_WINDOWS: number of pulse durations at the start of the self-test in which all
 * amplifiers move together. WINDOWS_BEFORE: number of pulse durations before the first pulse of a
 * single amplifier; in the last of these durations no amplifier moves.
 */
#define CONDITIONING_WINDOWS 2u
#define WINDOWS_BEFORE 3u
/*
 * Number of ticks that the self-test takes to search for the amplifier or sensor whose measured
 * response differs most from the model: one tick each for the mean gain, the amplifiers, the
 * sensors and the report of the fault.
 */
#define SEARCH_TICKS 4u

static pzs_real square(pzs_real number)
{
    return number * number;
}

/* ---- tables of the self-test -------------------------------------------- */

uint32_t pzs_selftest_parts(const pzs_selftest_tables *tables, pzs_table_part part[PZS_TABLE_PARTS])
{
    part[0] = (pzs_table_part){&tables->inputs, 4u * sizeof tables->inputs};
    part[1] = scrub_reals(tables->direct, (size_t)tables->sensors * tables->inputs);
    part[2] = scrub_reals(tables->amplitude, tables->inputs);
    part[3] = scrub_reals(tables->scale, tables->sensors);
    part[4] = scrub_reals(tables->noise, tables->sensors);
    part[5] = scrub_reals(&tables->gain_tolerance, 1);
    return 6;
}

static bool are_complete(const pzs_selftest_tables *tables)
{
    return tables->amplitude != NULL && tables->scale != NULL && tables->noise != NULL &&
           tables->inputs > 0 && tables->sensors > 0;
}

pzs_status pzs_selftest_seal(pzs_selftest_tables *tables)
{
    pzs_table_part part[PZS_TABLE_PARTS];
    if (tables == NULL || !are_complete(tables))
        return PZS_E_ARGUMENT;
    tables->format = PZS_TABLE_FORMAT;
    tables->crc = pzs_scrub_crc(part, pzs_selftest_parts(tables, part));
    return PZS_OK;
}

static bool are_finite(const pzs_selftest_tables *tables)
{
    const uint32_t entries = (uint32_t)tables->sensors * tables->inputs;
    return pzs_guard_nonfinite(tables->amplitude, tables->inputs) < 0 &&
           pzs_guard_nonfinite(tables->scale, tables->sensors) < 0 &&
           pzs_guard_nonfinite(tables->noise, tables->sensors) < 0 &&
           (tables->direct == NULL || pzs_guard_nonfinite(tables->direct, entries) < 0) &&
           number_is_finite(tables->gain_tolerance);
}

static bool are_in_range(const pzs_selftest_tables *tables)
{
    bool is_valid = tables->delay <= PZS_DELAY_LIMIT &&
                    tables->pulse_ticks >= PZS_LEAST_PULSE_TICKS && tables->gain_tolerance > 0;
    for (uint32_t i = 0; i < tables->sensors; i++)
        is_valid = is_valid && tables->scale[i] >= 0 && tables->noise[i] >= 0;
    for (uint32_t j = 0; j < tables->inputs; j++)
        is_valid = is_valid && tables->amplitude[j] >= 0;
    return is_valid;
}

/*
 * Return the first input whose self-test pulse exceeds half its voltage range or may exceed its
 * step limit, or -1 if there is none. In one tick a pulse changes by less than 4 / pulse_ticks of
 * its height.
 */
static int32_t too_high(const pzs_selftest_tables *tables, const pzs_problem *problem)
{
    for (uint32_t j = 0; j < tables->inputs; j++) {
        const pzs_real height = tables->amplitude[j];
        const pzs_real range = problem->upper[j] - problem->lower[j];
        const pzs_real most = (pzs_real)tables->pulse_ticks * problem->step_limit[j];
        if (height > 0 && !(2 * height <= range && 4 * height <= most))
            return (int32_t)j;
    }
    return -1;
}

pzs_status pzs_selftest_check(const pzs_selftest_tables *tables, const pzs_loop_signals *signals,
                              int32_t *where)
{
    const pzs_problem *problem = signals->control->state.problem;
    pzs_table_part part[PZS_TABLE_PARTS];
    if (tables->format != PZS_TABLE_FORMAT || tables->scene != problem->scene)
        return PZS_E_FORMAT;
    const bool has_sizes = tables->inputs == problem->inputs &&
                           tables->sensors == signals->sensors &&
                           (tables->direct != NULL || tables->sensors == problem->outputs);
    if (!are_complete(tables) || !has_sizes)
        return PZS_E_ARGUMENT;
    if (pzs_scrub_crc(part, pzs_selftest_parts(tables, part)) != tables->crc)
        return PZS_E_CRC;
    if (!are_finite(tables))
        return PZS_E_NONFINITE;
    if (!are_in_range(tables))
        return PZS_E_ARGUMENT;
    *where = too_high(tables, problem);
    return *where < 0 ? PZS_OK : PZS_E_LIMITS;
}

/* ---- memory of the self-test -------------------------------------------- */

/* Reserve the next `count` real numbers of the memory of the self-test and return their address. */
static pzs_real *take_reals(pzs_real **next, size_t count)
{
    pzs_real *const taken = *next;
    *next += count;
    return taken;
}

/* Set the pointers of the self-test to its tables, its controller and its arrays. */
static void place(pzs_selftest *selftest, const pzs_loop_signals *signals)
{
    const pzs_selftest_tables *tables = signals->tables;
    const size_t inputs = tables->inputs, sensors = tables->sensors;
    pzs_selftest_state *state = &selftest->state;
    pzs_real *next = (void *)((uint8_t *)selftest + PZS_ALIGNED(sizeof *selftest));
    state->tables = tables;
    state->control = signals->control;
    state->direct = tables->direct != NULL ? tables->direct : signals->control->state.influence;
    state->response = take_reals(&next, inputs * sensors);
    state->first = take_reals(&next, sensors);
    state->last = take_reals(&next, sensors);
    state->change = take_reals(&next, sensors);
    state->noise = take_reals(&next, sensors);
    state->even = take_reals(&next, sensors);
    state->odd = take_reals(&next, sensors);
    state->null = take_reals(&next, sensors);
    state->start = take_reals(&next, inputs);
    state->amplifier = (void *)next;
    state->sensor = state->amplifier + inputs;
    selftest->info.amplifier = state->amplifier;
    selftest->info.sensor = state->sensor;
}

/*
 * Copy the first of the three copies of the progress and the result of the self-test, which protect
 * them against damaged memory, over the other two.
 */
static void copy_core(pzs_selftest *selftest)
{
    selftest->state.core[1] = selftest->state.core[0];
    selftest->state.core[2] = selftest->state.core[0];
}

/*
 * Return the number of ticks in which the self-test moves amplifiers or uses readings: all pulse
 * durations, plus the delay until the last reading arrives.
 */
static uint32_t measuring_ticks(const pzs_selftest_tables *tables)
{
    return (tables->inputs + WINDOWS_BEFORE + 1u) * tables->pulse_ticks + tables->delay + 1u;
}

static uint32_t all_ticks(const pzs_selftest_tables *tables)
{
    return PZS_SELFTEST_TICKS(tables->inputs, tables->sensors, tables->pulse_ticks, tables->delay);
}

static void report(pzs_selftest *selftest)
{
    const pzs_selftest_core *core = &selftest->state.core[0];
    const uint32_t all = all_ticks(selftest->state.tables);
    const bool is_running = core->verdict == PZS_SELFTEST_RUNNING && core->position < all;
    selftest->info.verdict = (pzs_selftest_verdict)core->verdict;
    selftest->info.remaining = is_running ? all - core->position : 0;
}

/* ---- test pulses -------------------------------------------------------- */

/*
 * Return the height of the self-test pulse of input j (V). It is negative if the voltage is nearer
 * to its upper limit than to its lower limit.
 */
static pzs_real height_of(const pzs_selftest *selftest, uint32_t j)
{
    const pzs_problem *problem = selftest->state.control->state.problem;
    const pzs_real start = selftest->state.start[j], height = selftest->state.tables->amplitude[j];
    const bool is_upwards = problem->upper[j] - start >= start - problem->lower[j];
    return is_upwards ? height : -height;
}

/*
 * Whether the self-test moves input j: the tables give the input a pulse of positive height, and
 * the program does not hold the input at a fixed voltage.
 */
static bool is_tested(const pzs_selftest *selftest, uint32_t j)
{
    const pzs_control_state *control = &selftest->state.control->state;
    return selftest->state.tables->amplitude[j] > 0 && control->lower[j] < control->upper[j];
}

/*
 * Set the voltages of one tick of the self-test to the voltages before the test plus the pulse of
 * one input, or, in the first two pulse durations, plus the pulses of all inputs.
 */
static void set_voltages(pzs_selftest *selftest, uint32_t position)
{
    const pzs_selftest_tables *tables = selftest->state.tables;
    pzs_control_state *control = &selftest->state.control->state;
    const uint32_t window = position / tables->pulse_ticks;
    const bool is_for_all = window < CONDITIONING_WINDOWS;
    const uint32_t ticks = (is_for_all ? CONDITIONING_WINDOWS : 1u) * tables->pulse_ticks;
    const pzs_real pulse = test_pulse_at(test_pulse_place(position % ticks, ticks));
    for (uint32_t j = 0; j < tables->inputs; j++) {
        pzs_real voltage = selftest->state.start[j];
        if ((is_for_all || window == j + WINDOWS_BEFORE) && is_tested(selftest, j))
            voltage += height_of(selftest, j) * pulse;
        control->voltage[j] = number_clamp(voltage, control->lower[j], control->upper[j]);
    }
    pzs_control_moved(selftest->state.control);
}

/* ---- sensor readings ---------------------------------------------------- */

/*
 * Add a reading of sensor i to the weighted sums of its readings during a pulse. A missing reading
 * is replaced by the last one.
 *   even, odd in  even and odd weight of the reading (1)
 */
static void add_reading(pzs_selftest_state *state, uint32_t i, pzs_real reading, pzs_real even,
                        pzs_real odd)
{
    const bool is_usable = number_is_finite(reading) && number_absolute(reading) <= READING_LIMIT;
    if (is_usable && !number_is_finite(state->last[i])) {
        state->first[i] = reading;
        state->last[i] = reading;
    }
    if (!number_is_finite(state->last[i]))
        return;
    const pzs_real change = is_usable ? reading - state->last[i] : 0;
    state->noise[i] += square(change - state->change[i]);
    state->change[i] = change;
    state->last[i] += change;
    state->even[i] += even * (state->last[i] - state->first[i]);
    state->odd[i] += odd * (state->last[i] - state->first[i]);
}

/*
 * Finish one pulse duration of the self-test: turn the weighted sums of the readings into the
 * response of all sensors to the pulse, or, if no amplifier moved, into the squared response to
 * noise and vibration. The variance of the noise is measured only after the last pulse, because
 * modes of high frequency may still vibrate at the beginning.
 */
static void end_window(pzs_selftest *selftest, uint32_t window)
{
    pzs_selftest_state *state = &selftest->state;
    const uint32_t inputs = state->tables->inputs, sensors = state->tables->sensors;
    const bool has_pulse = window >= WINDOWS_BEFORE && window - WINDOWS_BEFORE < inputs;
    const uint32_t j = has_pulse ? window - WINDOWS_BEFORE : 0;
    const pzs_real height = has_pulse && is_tested(selftest, j) ? height_of(selftest, j) : 1;
    for (uint32_t i = 0; i < sensors; i++) {
        const pzs_real response = state->even[i] / (state->pulse * height);
        const pzs_real energy = square(response) + square(state->odd[i] / state->pulse);
        if (has_pulse)
            state->response[(size_t)j * sensors + i] = state->tables->scale[i] * response;
        else if (window >= CONDITIONING_WINDOWS && !(energy <= state->null[i]))
            state->null[i] = energy;
        state->even[i] = 0;
        state->odd[i] = 0;
        if (window + 1u == inputs + WINDOWS_BEFORE)
            state->noise[i] = 0;
    }
    state->pulse = 0;
}

/*
 * Add the readings of a tick to the sums of the self-test, each times a weight that follows the
 * shape of the test pulse. The readings show the effect of the voltages that were set delay + 1
 * ticks ago, where `delay` is the delay of the loop (ticks).
 */
static void measure(pzs_selftest *selftest, const pzs_real *readings, uint32_t position)
{
    pzs_selftest_state *state = &selftest->state;
    const pzs_selftest_tables *tables = state->tables;
    if (position <= tables->delay)
        return;
    const uint32_t then = position - tables->delay - 1u;
    const pzs_real place = test_pulse_place(then % tables->pulse_ticks, tables->pulse_ticks);
    const pzs_real even = test_pulse_even(place), odd = test_pulse_odd(place);
    for (uint32_t i = 0; i < tables->sensors; i++)
        add_reading(state, i, readings != NULL ? readings[i] : (pzs_real)NAN, even, odd);
    state->pulse += even * test_pulse_at(place);
    if (then % tables->pulse_ticks == tables->pulse_ticks - 1u)
        end_window(selftest, then / tables->pulse_ticks);
}

/* ---- columns (amplifiers) and rows (sensors) of responses --------------- */

/*
 * All columns or all rows of the matrix of measured responses and of the modelled matrix. The
 * column of an amplifier has an entry for each sensor; the row of a sensor has an entry for each
 * amplifier. The members named `line` refer to a column or a row.
 */
typedef struct selftest_axis {
    bool is_row;
    uint32_t lines, entries;
    size_t measured_line, measured_entry; /* distance in state.response, the measured responses,
                                             between the first entries of two columns (or two rows),
                                             and between two entries of a column (or row), in real
                                             numbers */
    size_t model_line, model_entry; /* distance in state.direct, the modelled responses, between the
                                       first entries of two columns (or two rows), and between two
                                       entries of a column (or row), in real numbers */
    pzs_wiring *line, *entry; /* [lines] results of the self-test (healthy or kind of fault) for the
                                 amplifiers if `is_row` is false, or for the sensors if it is true;
                                 [entries] results for the sensors if `is_row` is false, or for the
                                 amplifiers if it is true */
    bool has_gains; /* true: before the comparison of measured and modelled responses, each entry of
                       a modelled row (one sensor, all amplifiers) is multiplied by the measured
                       gain of its amplifier */
} selftest_axis;

static selftest_axis columns_of(const pzs_selftest *selftest)
{
    const uint32_t inputs = selftest->state.tables->inputs;
    const uint32_t sensors = selftest->state.tables->sensors;
    return (selftest_axis){false,
                           inputs,
                           sensors,
                           sensors,
                           1,
                           1,
                           inputs,
                           selftest->state.amplifier,
                           selftest->state.sensor,
                           false};
}

static selftest_axis rows_of(const pzs_selftest *selftest)
{
    const uint32_t inputs = selftest->state.tables->inputs;
    const uint32_t sensors = selftest->state.tables->sensors;
    return (selftest_axis){true,
                           sensors,
                           inputs,
                           1,
                           sensors,
                           inputs,
                           1,
                           selftest->state.sensor,
                           selftest->state.amplifier,
                           false};
}

/*
 * Sums over the entries of the measured and of the modelled column of an amplifier, or row of a
 * sensor, in the matrix of responses. Each entry is multiplied by the scale of its sensor.
 */
typedef struct line_sums {
    pzs_real product;  /* sum of the products of measured and modelled responses (1/V2) */
    pzs_real size;     /* sum of the absolute values of the products of measured and modelled
                          responses (1/V2) */
    pzs_real measured; /* sum of the squared measured responses of the sensors to the amplifiers
                          (1/V2) */
    pzs_real modelled; /* sum of the squared responses that the model predicts, each times the
                          scale of its sensor (1/V2) */
    pzs_real noise;    /* expected contribution of noise and vibration to the sum of the squared
                          measured responses (1/V2) */
} line_sums;

/*
 * Compare the measured column of an amplifier (or row of a sensor) in the matrix of responses with
 * the modelled one of index `modelled`. Entries of sensors (or amplifiers) at which the self-test
 * has found a fault do not count.
 *   noise [sensors] in  squared response of each sensor to noise and vibration, times the squared
 *                       height of a pulse (squared unit of each sensor)
 */
static line_sums compare_lines(const pzs_selftest *selftest, const selftest_axis *axis,
                               uint32_t measured, uint32_t modelled, const pzs_real *noise)
{
    const pzs_selftest_state *state = &selftest->state;
    const size_t sensor_step = axis->is_row ? 0 : 1, input_step = axis->is_row ? 1 : 0;
    const uint32_t sensor = axis->is_row ? measured : 0, input = axis->is_row ? 0 : measured;
    const pzs_real *scale = state->tables->scale + sensor, *variance = noise + sensor;
    const pzs_real *amplitude = state->tables->amplitude + input;
    const pzs_real *found = state->response + measured * axis->measured_line;
    const pzs_real *model = state->direct + modelled * axis->model_line;
    line_sums sums = {0, 0, 0, 0, 0};
    for (uint32_t k = 0; k < axis->entries; k++) {
        if (axis->entry[k].state == PZS_WIRING_HEALTHY) {
            const pzs_real gain = axis->has_gains ? axis->entry[k].gain : 1;
            const pzs_real response = *found, expected = gain * *scale * *model;
            const pzs_real product = response * expected;
            sums.product += product;
            sums.size += number_absolute(product);
            sums.measured += square(response);
            sums.modelled += square(expected);
            sums.noise += square(*scale / *amplitude) * *variance;
        }
        found += axis->measured_entry;
        model += axis->model_entry;
        scale += sensor_step;
        variance += sensor_step;
        amplitude += input_step;
    }
    return sums;
}

/*
 * Return the squared sine of the angle between the measured and the modelled column of an
 * amplifier, or row of a sensor, in the matrix of responses (0 to 1).
 */
static pzs_real direction_error(const line_sums *sums)
{
    const pzs_real both = sums->measured * sums->modelled;
    const pzs_real rest = both > 0 ? 1 - square(sums->product) / both : 1;
    return rest > 0 ? rest : 0;
}

/*
 * Whether the modelled response of an amplifier or sensor is large enough, compared with noise and
 * vibration, for the measured response to be compared with it.
 */
static bool can_judge(const line_sums *sums)
{
    return sums->modelled > PZS_SELFTEST_JUDGED * sums->noise && sums->modelled > 0;
}

/* ---- evaluation: responses above noise ---------------------------------- */

/*
 * Compute the variance of the noise of each sensor from the second differences of its readings, and
 * mark sensors as noisy, or as silent if they never gave a finite reading. A sensor is noisy if its
 * noise exceeds both the value in the tables and a multiple of the mean of the other sensors. The
 * second condition is needed because a vibration of high frequency looks like noise of many
 * sensors.
 */
static void mark_sensors(pzs_selftest *selftest)
{
    pzs_selftest_state *state = &selftest->state;
    const uint32_t sensors = state->tables->sensors;
    const pzs_real count = 6 * (pzs_real)state->tables->pulse_ticks;
    pzs_real sum = 0;
    for (uint32_t i = 0; i < sensors; i++) {
        state->noise[i] /= count;
        sum += square(state->tables->scale[i]) * state->noise[i];
    }
    for (uint32_t i = 0; i < sensors; i++) {
        const pzs_real own = square(state->tables->scale[i]) * state->noise[i];
        const pzs_real usual = sensors > 1 ? (sum - own) / (pzs_real)(sensors - 1u) : 0;
        const bool is_usual =
            state->noise[i] <= square(state->tables->noise[i]) || own <= UNUSUAL * usual;
        const bool has_readings = number_is_finite(state->last[i]);
        state->sensor[i].state = is_usual ? PZS_WIRING_HEALTHY : PZS_WIRING_NOISY;
        if (!has_readings)
            state->sensor[i].state = PZS_WIRING_SILENT;
    }
}

/*
 * Raise state.null, the squared response to noise and vibration, of each sensor, if it is smaller,
 * to the squared response that the noise of the sensor causes. The noise is the measured one, or a
 * small part of the largest plausible noise, because rounding errors of readings without noise are
 * no response.
 */
static void find_noise_responses(pzs_selftest_state *state)
{
    const pzs_selftest_tables *tables = state->tables;
    const pzs_real factor = PZS_SELFTEST_NOISE_ENERGY / (pzs_real)tables->pulse_ticks;
    for (uint32_t i = 0; i < tables->sensors; i++) {
        const pzs_real measured = factor * state->noise[i];
        const pzs_real least = factor * square(LEAST_NOISE * tables->noise[i]);
        const pzs_real noise = measured > least ? measured : least;
        state->null[i] = noise > state->null[i] ? noise : state->null[i];
    }
}

/*
 * Mark the amplifiers (or sensors) whose modelled response is too small, compared with noise and
 * vibration, to be compared with the measured one. Returns the number of amplifiers (or sensors)
 * that this call has marked.
 */
static uint32_t mark_unobservable(const pzs_selftest *selftest, const selftest_axis *axis)
{
    uint32_t hidden = 0;
    for (uint32_t line = 0; line < axis->lines; line++) {
        const line_sums sums = compare_lines(selftest, axis, line, line, selftest->state.null);
        if (axis->line[line].state != PZS_WIRING_HEALTHY || can_judge(&sums))
            continue;
        axis->line[line].state = PZS_WIRING_UNOBSERVABLE;
        hidden++;
    }
    return hidden;
}

/*
 * Compute the gain of each amplifier at which the self-test has found no fault: the sum of the
 * absolute products of measured and modelled responses, divided by the sum of the squared modelled
 * responses, with the sign of the sum of the products. A sensor that is reversed or swapped then
 * changes the gain little; in a sum with signs it would cancel the responses of the other sensors.
 */
static void find_gains(const pzs_selftest *selftest)
{
    const selftest_axis columns = columns_of(selftest);
    for (uint32_t j = 0; j < columns.lines; j++) {
        if (columns.line[j].state != PZS_WIRING_HEALTHY)
            continue;
        const line_sums sums = compare_lines(selftest, &columns, j, j, selftest->state.null);
        const pzs_real gain = sums.modelled > 0 ? sums.size / sums.modelled : 0;
        columns.line[j].gain = sums.product < 0 ? -gain : gain;
    }
}

/*
 * Return the mean absolute gain (measured divided by modelled response) of the healthy amplifiers
 * whose absolute gain is at least `least`. Returns 0 where there is none.
 */
static pzs_real mean_above(const pzs_selftest *selftest, pzs_real least)
{
    const pzs_wiring *amplifier = selftest->state.amplifier;
    pzs_real sum = 0;
    uint32_t count = 0;
    for (uint32_t j = 0; j < selftest->state.tables->inputs; j++) {
        const pzs_real gain = number_absolute(amplifier[j].gain);
        if (amplifier[j].state != PZS_WIRING_HEALTHY || !(gain >= least))
            continue;
        sum += gain;
        count++;
    }
    return count > 0 ? sum / (pzs_real)count : 0;
}

/*
 * Set info.gain to the mean absolute gain of the healthy amplifiers. Silent amplifiers are left
 * out, because they would make the healthy ones seem too strong: an amplifier counts as silent if
 * its gain is much smaller than the mean of the others, which three rounds determine.
 */
static void find_mean_gain(pzs_selftest *selftest)
{
    find_gains(selftest);
    pzs_real mean = mean_above(selftest, 0);
    for (int round = 0; round < GAIN_ROUNDS; round++)
        mean = mean_above(selftest, SILENT * mean);
    if (mean > 0 && number_is_finite(mean))
        selftest->info.gain = mean;
}

/*
 * Whether the mean gain (measured divided by modelled response) of the amplifiers is within
 * plausible bounds.
 */
static bool is_gain_plausible(const pzs_selftest *selftest)
{
    return selftest->info.gain >= LEAST_GAIN && selftest->info.gain <= LARGEST_GAIN;
}

/*
 * Make the first tick in which the self-test evaluates the responses: find the sensors that are
 * noisy or give no readings, and the amplifiers that were tested.
 */
static void begin_evaluation(pzs_selftest *selftest)
{
    pzs_selftest_state *state = &selftest->state;
    mark_sensors(selftest);
    find_noise_responses(state);
    for (uint32_t j = 0; j < state->tables->inputs; j++)
        if (is_tested(selftest, j))
            state->amplifier[j].state = PZS_WIRING_HEALTHY;
}

/* Find out whether noise or vibration hides the response of an amplifier to its test pulse. */
static void find_disturbance(pzs_selftest *selftest)
{
    const selftest_axis columns = columns_of(selftest);
    const uint32_t hidden = mark_unobservable(selftest, &columns);
    selftest->state.core[0].disturbed = hidden > 0 ? 1u : 0u;
}

/* ---- evaluation: responses unlike the model ----------------------------- */

/*
 * The amplifier (column of the matrix of responses) or sensor (row of this matrix) whose measured
 * response differs most from the modelled one.
 */
typedef struct worst_line {
    pzs_real difference; /* squared difference between the measured response and the mean gain of
                            all amplifiers times the modelled response (1/V2) */
    uint32_t line;
    bool is_found;
} worst_line;

/*
 * Whether the self-test may report a fault of an amplifier or sensor whose measured response
 * differs from the model. If the modelled response to the amplifiers or sensors at which no fault
 * was found is too small to be compared, the measured response must be large. An amplifier or
 * sensor with a reported fault gets no second one.
 */
static bool may_be_reported(const pzs_wiring *finding, const line_sums *sums)
{
    const bool is_large = sums->measured > 4 * RESPONSE * sums->noise;
    const bool is_healthy = finding->state == PZS_WIRING_HEALTHY;
    return (is_healthy && can_judge(sums)) ||
           ((is_healthy || finding->state == PZS_WIRING_UNOBSERVABLE) && is_large);
}

/*
 * Return the sum of all squared modelled entries of a column or row (1/V2), also of those that
 * belong to faulty amplifiers or sensors. Differences that are tiny beside this sum are not
 * reported, because a sensor that mainly a faulty amplifier moves shows little but errors of the
 * model.
 */
static pzs_real whole_energy(const pzs_selftest *selftest, const selftest_axis *axis, uint32_t line)
{
    const pzs_selftest_state *state = &selftest->state;
    pzs_real sum = 0;
    for (uint32_t k = 0; k < axis->entries; k++) {
        const pzs_real scale = state->tables->scale[axis->is_row ? line : k];
        sum += square(scale * state->direct[line * axis->model_line + k * axis->model_entry]);
    }
    return sum;
}

/*
 * Find the amplifier (or sensor) whose measured response differs most from the model, among those
 * that differ by more than the tolerance that the tables grant to the gains of amplifiers.
 */
static worst_line find_worst(const pzs_selftest *selftest, const selftest_axis *axis, pzs_real gain)
{
    worst_line worst = {0, 0, false};
    for (uint32_t line = 0; line < axis->lines; line++) {
        const line_sums sums = compare_lines(selftest, axis, line, line, selftest->state.null);
        const pzs_real expected = square(gain) * sums.modelled;
        const pzs_real difference = sums.measured - 2 * gain * sums.product + expected - sums.noise;
        const pzs_real most = square(selftest->state.tables->gain_tolerance) * expected;
        if (may_be_reported(&axis->line[line], &sums) && !(difference <= most) &&
            !(difference <= worst.difference) &&
            !(difference <= SAME_DIRECTION * whole_energy(selftest, axis, line)))
            worst = (worst_line){difference, line, true};
    }
    return worst;
}

/*
 * Return how much the measured response of an amplifier or sensor differs from a modelled response.
 * Gains of amplifiers differ, so that only directions are compared, by the squared sine of their
 * angle (0 to 1). Where the modelled row of a sensor contains the measured gains of the amplifiers,
 * its size counts, too: the result is the squared difference of the two rows (1/V2).
 */
static pzs_real response_error(const selftest_axis *axis, const line_sums *sums)
{
    if (axis->has_gains)
        return sums->measured - 2 * sums->product + sums->modelled;
    return direction_error(sums);
}

/*
 * Find the amplifier (or sensor) whose modelled response differs least from the measured response
 * of amplifier (or sensor) `line`. Returns its index.
 */
static uint32_t nearest_line(const pzs_selftest *selftest, const selftest_axis *axis, uint32_t line)
{
    const line_sums own = compare_lines(selftest, axis, line, line, selftest->state.null);
    pzs_real least = response_error(axis, &own);
    uint32_t nearest = line;
    for (uint32_t other = 0; other < axis->lines; other++) {
        const line_sums sums = compare_lines(selftest, axis, line, other, selftest->state.null);
        const pzs_real error = response_error(axis, &sums);
        if (error < least) {
            nearest = other;
            least = error;
        }
    }
    return nearest;
}

/*
 * Whether the measured response of amplifier (or sensor) `line` is that of amplifier (or sensor)
 * `other`, because cables are exchanged: its energy exceeds that of noise and vibration, its
 * direction is that of the modelled response of `other`, and its size is at least a plausible
 * fraction of that response.
 */
static bool is_other_line(const pzs_selftest *selftest, const selftest_axis *axis, uint32_t line,
                          uint32_t other, pzs_real gain)
{
    const line_sums own = compare_lines(selftest, axis, line, line, selftest->state.null);
    const line_sums its = compare_lines(selftest, axis, line, other, selftest->state.null);
    const pzs_real error = direction_error(&its);
    return other != line && SWAP_GAIN * error < direction_error(&own) && 2 * error < 1 &&
           own.measured > RESPONSE * own.noise &&
           number_absolute(its.product) > SILENT * gain * its.modelled;
}

/*
 * Report the kind of fault of an amplifier or sensor whose measured response differs from the
 * model.
 *   nearest in  index of the amplifier (or sensor) whose modelled response is nearest to the
 *               measured response
 */
static void set_finding(const pzs_selftest *selftest, const selftest_axis *axis, uint32_t line,
                        uint32_t nearest, pzs_real gain)
{
    pzs_wiring *finding = &axis->line[line];
    const line_sums sums = compare_lines(selftest, axis, line, line, selftest->state.null);
    const pzs_real energy = sums.measured - sums.noise;
    finding->gain = sums.modelled > 0 ? sums.product / sums.modelled : 0;
    if (is_other_line(selftest, axis, line, nearest, gain)) {
        finding->state = PZS_WIRING_SWAPPED;
        finding->other = (uint16_t)nearest;
    } else if (energy < square(SILENT * gain) * sums.modelled) {
        finding->state = PZS_WIRING_SILENT;
    } else if (2 * direction_error(&sums) > 1) {
        finding->state = PZS_WIRING_UNKNOWN;
    } else {
        finding->state = sums.product < 0 ? PZS_WIRING_REVERSED : PZS_WIRING_GAIN;
    }
}

/*
 * Return the mean gain (measured divided by modelled response) of all amplifiers, clamped to
 * plausible values.
 */
static pzs_real plausible_gain(const pzs_selftest *selftest)
{
    return number_clamp(selftest->info.gain, LEAST_GAIN, LARGEST_GAIN);
}

/*
 * Store which amplifier (or which sensor) has the measured response that differs most from the
 * model. Sensors count only while the mean gain (measured divided by modelled response) of the
 * amplifiers is plausible.
 */
static void store_worst(pzs_selftest *selftest, bool is_row)
{
    const selftest_axis axis = is_row ? rows_of(selftest) : columns_of(selftest);
    worst_line worst = find_worst(selftest, &axis, plausible_gain(selftest));
    if (is_row && !is_gain_plausible(selftest))
        worst.is_found = false;
    selftest->state.worst[is_row] = worst.is_found ? (uint16_t)worst.line : PZS_WIRING_NONE;
    selftest->state.difference[is_row] = worst.is_found ? worst.difference : 0;
}

/*
 * Return whether the response of any amplifier or sensor differs from the model. Sets *axis to the
 * responses of all amplifiers or to those of all sensors, and *line to the one that differs most.
 */
static bool has_worst(const pzs_selftest *selftest, selftest_axis *axis, uint32_t *line)
{
    const pzs_selftest_state *state = &selftest->state;
    const selftest_axis columns = columns_of(selftest), rows = rows_of(selftest);
    const bool is_row =
        state->worst[1] < rows.lines && !(state->difference[1] <= state->difference[0]);
    *axis = is_row ? rows : columns;
    *line = state->worst[is_row];
    return *line < axis->lines;
}

/*
 * Report the fault of the amplifier or sensor whose measured response differs most from the model.
 * Later ticks exclude its responses from all comparisons with the model. If no amplifier or sensor
 * differs by more than the tolerance that the tables grant to the gains of amplifiers, the search
 * for differences ends. While the mean gain of the amplifiers is implausible, only amplifiers are
 * reported, because all of them differ from the model.
 */
static void report_worst(pzs_selftest *selftest)
{
    selftest_axis axis;
    uint32_t line;
    const bool is_found = has_worst(selftest, &axis, &line);
    selftest->state.core[0].is_complete = is_found ? 0u : 1u;
    if (is_found)
        set_finding(selftest, &axis, line, nearest_line(selftest, &axis, line),
                    plausible_gain(selftest));
}

/*
 * Report the amplifier or sensor whose measured response differs most from the model if it is
 * reversed. This comes before exchanged cables are looked for: where there are few sensors, a
 * reversed one makes the responses to healthy amplifiers resemble those to other amplifiers.
 */
static void report_reversed(pzs_selftest *selftest)
{
    selftest_axis axis;
    uint32_t line;
    if (!has_worst(selftest, &axis, &line) || nearest_line(selftest, &axis, line) != line)
        return;
    const line_sums sums = compare_lines(selftest, &axis, line, line, selftest->state.null);
    if (sums.product < 0 && 2 * direction_error(&sums) < 1)
        set_finding(selftest, &axis, line, line, plausible_gain(selftest));
}

/*
 * Make one tick of a search for the amplifier or sensor whose measured response differs most from
 * the model. The search takes several ticks (SEARCH_TICKS), because one tick would need too many
 * instructions.
 *   is_first in  true: only a reversed amplifier or sensor is reported
 */
static void search(pzs_selftest *selftest, uint32_t tick, bool is_first)
{
    if (selftest->state.core[0].is_complete != 0)
        return;
    if (tick == 0)
        find_mean_gain(selftest);
    else if (tick < SEARCH_TICKS - 1u)
        store_worst(selftest, tick == 2u);
    else if (is_first)
        report_reversed(selftest);
    else
        report_worst(selftest);
}

/* ---- evaluation: exchanged cables --------------------------------------- */

/*
 * Return the squared sine of the angle between the modelled responses of two amplifiers, or of two
 * sensors (0 to 1).
 */
static pzs_real model_angle(const pzs_selftest *selftest, const selftest_axis *axis, uint32_t one,
                            uint32_t other)
{
    const pzs_selftest_state *state = &selftest->state;
    const pzs_real *left = state->direct + one * axis->model_line;
    const pzs_real *right = state->direct + other * axis->model_line;
    pzs_real product = 0, first = 0, second = 0;
    for (uint32_t k = 0; k < axis->entries; k++) {
        const pzs_real scale = axis->is_row ? 1 : square(state->tables->scale[k]);
        if (axis->entry[k].state == PZS_WIRING_HEALTHY) {
            product += scale * *left * *right;
            first += scale * square(*left);
            second += scale * square(*right);
        }
        left += axis->model_entry;
        right += axis->model_entry;
    }
    const line_sums sums = {product, product, first, second, 0};
    return direction_error(&sums);
}

/*
 * Store, for an amplifier (or sensor) at which the self-test has found no fault, the index of the
 * one with the most similar modelled response, if both are so similar that the self-test would not
 * notice exchanged cables.
 */
static void note_similar(const pzs_selftest *selftest, const selftest_axis *axis, uint32_t line)
{
    const line_sums sums = compare_lines(selftest, axis, line, line, selftest->state.null);
    pzs_real least = SIMILAR * sums.noise / sums.modelled + SAME_DIRECTION;
    for (uint32_t other = 0; other < axis->lines; other++) {
        const pzs_real angle = other != line ? model_angle(selftest, axis, line, other) : 1;
        if (angle < least) {
            least = angle;
            axis->line[line].similar = (uint16_t)other;
        }
    }
}

/*
 * Return how much the measured responses of two amplifiers, or of two sensors, differ from the
 * modelled responses of two amplifiers or sensors. Rows of two sensors whose modelled entries
 * contain the gains of the amplifiers are compared as one vector, the second row behind the first:
 * where two sensors see nearly the same shape, an exchange shows in the sizes of the rows alone.
 */
static pzs_real pair_error(const selftest_axis *axis, const line_sums *one, const line_sums *other)
{
    const line_sums both = {one->product + other->product, one->size + other->size,
                            one->measured + other->measured, one->modelled + other->modelled,
                            one->noise + other->noise};
    if (axis->has_gains)
        return direction_error(&both);
    return direction_error(one) + direction_error(other);
}

/*
 * Find out whether amplifier (or sensor) `line` and the one whose modelled response is nearest to
 * the measured response of `line` have exchanged cables. Both are marked as swapped if an exchange
 * explains their measured responses much better, and if their differences from the model exceed
 * noise and vibration.
 */
static void find_swap(const pzs_selftest *selftest, const selftest_axis *axis, uint32_t line)
{
    const pzs_real *noise = selftest->state.null;
    const uint32_t other = nearest_line(selftest, axis, line);
    if (other == line || axis->line[other].state != PZS_WIRING_HEALTHY)
        return;
    const line_sums own = compare_lines(selftest, axis, line, line, noise);
    const line_sums its = compare_lines(selftest, axis, other, other, noise);
    const line_sums there = compare_lines(selftest, axis, line, other, noise);
    const line_sums back = compare_lines(selftest, axis, other, line, noise);
    const pzs_real kept = pair_error(axis, &own, &its);
    const pzs_real exchanged = pair_error(axis, &there, &back);
    const pzs_real least = SWAP_NOISE * (own.noise / own.measured + its.noise / its.measured);
    if (!(SWAP_GAIN * exchanged < kept && kept > least && kept > SAME_DIRECTION))
        return;
    axis->line[line].state = PZS_WIRING_SWAPPED;
    axis->line[line].other = (uint16_t)other;
    axis->line[other].state = PZS_WIRING_SWAPPED;
    axis->line[other].other = (uint16_t)line;
}

/*
 * Compare one amplifier or sensor, if no fault was found at it, with all others whose cables could
 * have been exchanged with its own. The amplifiers or the sensors, whichever are fewer, have the
 * smaller values of `number`, because a fault of one among few changes the responses of the others
 * more.
 *   finds_swaps in  true: look for exchanged cables; false: note the most similar response
 */
static void compare_pairs(pzs_selftest *selftest, uint32_t number, bool finds_swaps)
{
    const selftest_axis columns = columns_of(selftest), rows = rows_of(selftest);
    const selftest_axis few = columns.lines <= rows.lines ? columns : rows;
    const selftest_axis many = columns.lines <= rows.lines ? rows : columns;
    selftest_axis axis = number < few.lines ? few : many;
    const uint32_t line = number < few.lines ? number : number - few.lines;
    axis.has_gains = axis.is_row;
    if (axis.line[line].state != PZS_WIRING_HEALTHY)
        return;
    if (finds_swaps)
        find_swap(selftest, &axis, line);
    else
        note_similar(selftest, &axis, line);
}

/* ---- verdict of the self-test ------------------------------------------- */

/* Return the number of amplifiers (or sensors) at which the self-test has found a fault. */
static uint16_t count_findings(const selftest_axis *axis)
{
    uint16_t count = 0;
    for (uint32_t line = 0; line < axis->lines; line++)
        count = (uint16_t)(count + (axis->line[line].state >= PZS_WIRING_SILENT ? 1u : 0u));
    return count;
}

/*
 * Mark an amplifier (or sensor) that seems silent as swapped if the self-test has found the other
 * one of the pair to be swapped with it. If the cables of a strong and a weak electrode are
 * exchanged, the amplifier of the strong electrode seems to be silent.
 */
static void complete_swaps(const selftest_axis *axis)
{
    for (uint32_t line = 0; line < axis->lines; line++) {
        const uint32_t other = axis->line[line].other;
        const bool is_swapped = axis->line[line].state == PZS_WIRING_SWAPPED && other < axis->lines;
        if (!is_swapped || axis->line[other].state != PZS_WIRING_SILENT)
            continue;
        axis->line[other].state = PZS_WIRING_SWAPPED;
        axis->line[other].other = (uint16_t)line;
    }
}

/*
 * Mark every healthy amplifier with PZS_WIRING_GAIN if the mean gain (measured divided by modelled
 * response) is implausible: the amplifiers agree with each other, but all of them differ from the
 * model.
 */
static void mark_common_gain(const pzs_selftest *selftest, const selftest_axis *columns)
{
    for (uint32_t j = 0; j < columns->lines && !is_gain_plausible(selftest); j++)
        if (columns->line[j].state == PZS_WIRING_HEALTHY)
            columns->line[j].state = PZS_WIRING_GAIN;
}

static void give_verdict(pzs_selftest *selftest)
{
    const selftest_axis columns = columns_of(selftest), rows = rows_of(selftest);
    pzs_selftest_core *core = &selftest->state.core[0];
    complete_swaps(&columns);
    complete_swaps(&rows);
    mark_common_gain(selftest, &columns);
    selftest->info.findings = (uint16_t)(count_findings(&columns) + count_findings(&rows));
    core->verdict = core->disturbed != 0 ? PZS_SELFTEST_DISTURBED : PZS_SELFTEST_PASSED;
    if (selftest->info.findings > 0)
        core->verdict = PZS_SELFTEST_FAULTY;
}

/*
 * Make one tick of the evaluation of the self-test: first look for a reversed amplifier or sensor,
 * then for pairs with exchanged cables, then for other differences from the model. The exchanged
 * cables of two sensors with large responses would otherwise look like faults of the amplifiers
 * near these sensors.
 */
static void evaluate(pzs_selftest *selftest, uint32_t tick)
{
    const pzs_selftest_tables *tables = selftest->state.tables;
    const uint32_t lines = (uint32_t)tables->inputs + tables->sensors;
    const uint32_t first_pair = 4u + SEARCH_TICKS, first_search = first_pair + 2u * lines;
    const selftest_axis rows = rows_of(selftest);
    if (tick == 0)
        begin_evaluation(selftest);
    else if (tick == 1)
        find_disturbance(selftest);
    else if (tick == 2)
        (void)mark_unobservable(selftest, &rows);
    else if (tick < first_pair - 1u)
        search(selftest, tick - 3u, true);
    else if (tick < first_pair)
        find_mean_gain(selftest);
    else if (tick < first_search)
        compare_pairs(selftest, (tick - first_pair) / 2u, (tick - first_pair) % 2u == 1u);
    else
        search(selftest, (tick - first_search) % SEARCH_TICKS, false);
    if (tick + 1u >= first_search + SEARCH_TICKS * lines)
        give_verdict(selftest);
}

pzs_status pzs_selftest_accept(pzs_selftest *selftest)
{
    if (selftest == NULL)
        return PZS_E_ARGUMENT;
    if (selftest->state.control == NULL)
        return PZS_E_STAGE;
    pzs_control *control = selftest->state.control;
    for (uint16_t j = 0; j < selftest->state.tables->inputs; j++) {
        const uint8_t state = selftest->state.amplifier[j].state;
        const pzs_real voltage = state == PZS_WIRING_SILENT ? 0 : control->state.voltage[j];
        if (state >= PZS_WIRING_SILENT)
            (void)pzs_hold(control, j, voltage);
    }
    for (int copy = 0; copy < 3; copy++)
        selftest->state.core[copy].verdict = PZS_SELFTEST_ACCEPTED;
    selftest->info.verdict = PZS_SELFTEST_ACCEPTED;
    return PZS_OK;
}

/* ---- block of the control loop ------------------------------------------ */

static size_t block_bytes(const void *tables, const pzs_problem *problem)
{
    const pzs_selftest_tables *selftest = tables;
    (void)problem;
    return PZS_SELFTEST_BLOCK_BYTES(selftest->inputs, selftest->sensors);
}

/* Begin a self-test, which starts from the present voltages of the controller. */
static void begin(pzs_selftest *selftest)
{
    pzs_selftest_state *state = &selftest->state;
    const size_t inputs = state->tables->inputs, sensors = state->tables->sensors;
    memset(state->response, 0, ((inputs + 7u) * sensors + inputs) * sizeof(pzs_real));
    memset(state->amplifier, 0, (inputs + sensors) * sizeof(pzs_wiring));
    memset(state->core, 0, sizeof state->core);
    memcpy(state->start, state->control->state.voltage, inputs * sizeof(pzs_real));
    for (size_t i = 0; i < sensors; i++)
        state->last[i] = (pzs_real)NAN;
    for (size_t k = 0; k < inputs + sensors; k++) {
        state->amplifier[k].other = PZS_WIRING_NONE;
        state->amplifier[k].similar = PZS_WIRING_NONE;
    }
    state->pulse = 0;
    selftest->info.findings = 0;
    selftest->info.gain = 1;
    report(selftest);
}

pzs_status pzs_selftest_repeat(pzs_selftest *selftest)
{
    if (selftest == NULL)
        return PZS_E_ARGUMENT;
    if (selftest->state.control == NULL)
        return PZS_E_STAGE;
    begin(selftest);
    return PZS_OK;
}

static pzs_status block_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    pzs_selftest *selftest = self;
    const pzs_status status = pzs_selftest_check(tables, signals, &signals->where);
    if (status != PZS_OK)
        return status;
    /*
     * The self-test is refused in a voltage problem with limit rows (limits of weighted sums of
     * voltages), because a test pulse of a single input could violate them.
     */
    if (signals->control->state.problem->limit_rows != NULL)
        return PZS_E_ARGUMENT;
    memset(selftest, 0, sizeof *selftest);
    place(selftest, signals);
    begin(selftest);
    return PZS_OK;
}

/*
 * Make one tick of the self-test of amplifiers and sensors: set voltages and use readings, then
 * evaluate the responses.
 */
static void run(pzs_selftest *selftest, const pzs_real *readings)
{
    pzs_selftest_core *core = &selftest->state.core[0];
    const uint32_t measuring = measuring_ticks(selftest->state.tables);
    if (core->position < measuring)
        measure(selftest, readings, core->position);
    else
        evaluate(selftest, core->position - measuring);
    set_voltages(selftest, core->position);
    core->position++;
}

static pzs_status block_tick(void *self, pzs_loop_signals *signals)
{
    pzs_selftest *selftest = self;
    pzs_selftest_core *core = selftest->state.core;
    pzs_guard_vote(&core[0], &core[1], &core[2], sizeof core[0]);
    place(selftest, signals);
    if (core->verdict == PZS_SELFTEST_RUNNING) {
        run(selftest, signals->readings);
        copy_core(selftest);
    }
    report(selftest);
    if (core->verdict == PZS_SELFTEST_RUNNING)
        return PZS_W_SELFTEST;
    const bool is_refused =
        core->verdict == PZS_SELFTEST_FAULTY || core->verdict == PZS_SELFTEST_DISTURBED;
    return is_refused ? PZS_E_SELFTEST : PZS_OK;
}

static uint32_t block_parts(const void *tables, uint32_t number,
                            pzs_table_part part[PZS_TABLE_PARTS], uint32_t *crc)
{
    const pzs_selftest_tables *table = tables;
    *crc = table->crc;
    return number == 0 ? pzs_selftest_parts(table, part) : 0;
}

const pzs_block_type pzs_selftest_block = {"selftest", PZS_PHASE_COMMISSION, block_bytes,
                                           block_init, block_tick,           block_parts};
