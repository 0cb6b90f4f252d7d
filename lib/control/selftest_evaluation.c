/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Evaluation of the self-test of amplifiers, cables and sensors (selftest.h): finds the amplifiers
 * and sensors that differ from the model. It compares the matrix of measured responses with that of
 * the model; a column is the response of all sensors to one amplifier, a row that of one sensor to
 * all amplifiers.
 *
 *   1. The column or row that differs most from the model is reported if it is reversed.
 *   2. Pairs of similar columns and of similar rows are compared, because exchanged cables may make
 *      neither look faulty alone.
 *   3. The column or row that differs most is reported and excluded from later comparisons, until
 *      nothing differs. Only one is reported at a time, because a faulty amplifier also changes the
 *      rows of sensors near it, and a faulty sensor the columns of amplifiers near it.
 */
#include "selftest.h"
#include "../core/numbers.h"

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
 * A measured response counts as that of another amplifier or sensor (exchanged cables) only if the
 * sum of its squares exceeds this multiple of the sum of squares that noise and vibration cause.
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
 * Number of times that the self-test computes the mean gain (measured divided by modelled response)
 * of the amplifiers again, each time without the amplifiers that it shows to be silent.
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
 * squared sine of the angle between their modelled responses is below
 *   SIMILAR * N / M + SAME_DIRECTION
 *   N  expected sum of squares of the noise in a response
 *   M  sum of squares of the modelled response
 */
#define SIMILAR PZS_R(36)
#define SAME_DIRECTION PZS_R(1e-4)

/*
 * Stages, in their order, in which the self-test evaluates its matrix of responses (a column for
 * each amplifier, a row for each sensor). STAGE_GAINS to STAGE_NEAREST are repeated for each fault.
 * Parts of the names:
 *   HIDDEN         marks columns and rows that are too small beside noise and vibration
 *   GAINS          computes the gains of the amplifiers
 *   COLUMNS, ROWS  finds the amplifier, the sensor that differs most from the model
 *   NEAREST        finds the modelled response that is nearest to a measured one
 *   FIRST          reports only reversed amplifiers and sensors
 *   PAIR           looks for exchanged cables, repeated for each amplifier and sensor
 */
enum {
    STAGE_START = 0,
    STAGE_HIDDEN_COLUMNS,
    STAGE_HIDDEN_ROWS,
    STAGE_FIRST_GAINS,
    STAGE_FIRST_COLUMNS,
    STAGE_FIRST_ROWS,
    STAGE_FIRST_NEAREST,
    STAGE_PAIR_GAINS,
    STAGE_PAIR_SIMILAR,
    STAGE_PAIR_NEAREST,
    STAGE_PAIR_EXCHANGED,
    STAGE_GAINS,
    STAGE_COLUMNS,
    STAGE_ROWS,
    STAGE_NEAREST,
    STAGE_VERDICT
};

static pzs_real square(pzs_real number)
{
    return number * number;
}

/* ---- columns (amplifiers) and rows (sensors) of responses --------------- */

/*
 * One way to read the matrices of measured and of modelled responses: by columns or by rows. A line
 * is then a column (one amplifier, with an entry for each sensor) or a row (one sensor, with an
 * entry for each amplifier).
 */
typedef struct selftest_axis {
    bool is_row;
    uint32_t lines, entries;
    /*
     * strides in the array state.response of measured responses (in reals): measured_line between
     * neighbouring lines, measured_entry between neighbouring entries of a line. A line is the
     * column of an amplifier or the row of a sensor
     */
    size_t measured_line, measured_entry;
    /*
     * strides in the array state.direct of modelled responses (in reals): model_line between
     * neighbouring lines, model_entry between neighbouring entries of a line. A line is the column
     * of an amplifier or the row of a sensor
     */
    size_t model_line, model_entry;
    /*
     * findings of the self-test: `line` about what the lines stand for, `entry` about what the
     * entries of a line stand for. If lines are columns, `line` [inputs] holds findings about
     * amplifiers, and `entry` [sensors] about sensors; if lines are rows (is_row), the reverse
     */
    pzs_wiring *line, *entry;
    bool has_gains; /* whether, before measured and modelled responses are compared, each modelled
                       response of a sensor to an amplifier is multiplied by the measured gain of
                       this amplifier */
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
 * Compare two responses: return sums over their products and squares. The response of an amplifier
 * has an entry for each sensor, that of a sensor an entry for each amplifier; entries at which the
 * self-test has found a fault do not count.
 *   measured in  number of the amplifier (or sensor) whose measured response is compared
 *   modelled in  number of the amplifier (or sensor) whose modelled response is compared
 */
static pzs_selftest_sums compare_lines(const pzs_selftest *selftest, const selftest_axis *axis,
                                       uint32_t measured, uint32_t modelled)
{
    const pzs_selftest_state *state = &selftest->state;
    const size_t sensor_step = axis->is_row ? 0 : 1;
    const size_t input_step = axis->is_row ? 1 : 0;
    const uint32_t sensor = axis->is_row ? measured : 0;
    const uint32_t input = axis->is_row ? 0 : measured;
    const pzs_real *scale = state->tables->scale + sensor, *variance = state->null + sensor;
    const pzs_real *amplitude = state->tables->amplitude + input;
    const pzs_real *found = state->response + measured * axis->measured_line;
    const pzs_real *model = state->direct + modelled * axis->model_line;
    pzs_selftest_sums sums = {0, 0, 0, 0, 0};
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
 * Return the squared sine of the angle (0 to 1) between the measured and the modelled response as
 * vectors: those of all sensors to one amplifier, or those of one sensor to all amplifiers.
 */
static pzs_real direction_error(const pzs_selftest_sums *sums)
{
    const pzs_real both = sums->measured * sums->modelled;
    const pzs_real rest = both > 0 ? 1 - square(sums->product) / both : 1;
    return rest > 0 ? rest : 0;
}

/*
 * Whether the modelled response of an amplifier or sensor is large enough, compared with noise and
 * vibration, for the measured response to be compared with it.
 */
static bool can_judge(const pzs_selftest_sums *sums)
{
    return sums->modelled > PZS_SELFTEST_JUDGED * sums->noise && sums->modelled > 0;
}

/* ---- responses above noise ------------------------------------------------ */

/*
 * Compute the variance of the noise of each sensor from the second differences of its readings. A
 * sensor without any finite reading is marked as silent. One whose noise exceeds both the value in
 * the tables and a multiple of the mean of the other sensors is marked as noisy.
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
        // A vibration of high frequency looks like noise at many sensors at once; the noise of a
        // sensor is therefore compared with the mean of all others.
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
 * Raise the entries of state.null [sensors], the squared responses to noise and vibration measured
 * while no amplifier moved, to at least the mean squared response to the noise of the sensor.
 */
static void find_noise_responses(pzs_selftest_state *state)
{
    const pzs_selftest_tables *tables = state->tables;
    const pzs_real factor = PZS_SELFTEST_NOISE_ENERGY / (pzs_real)tables->pulse_ticks;
    for (uint32_t i = 0; i < tables->sensors; i++) {
        const pzs_real measured = factor * state->noise[i];
        // Readings without any noise still have rounding errors, which are counted as noise here.
        const pzs_real least = factor * square(LEAST_NOISE * tables->noise[i]);
        const pzs_real noise = measured > least ? measured : least;
        state->null[i] = noise > state->null[i] ? noise : state->null[i];
    }
}

/*
 * Mark an amplifier (or sensor) whose modelled response is too small, compared with noise and
 * vibration, to be compared with the measured one. If it is an amplifier, the self-test cannot pass
 * and ends with the verdict PZS_SELFTEST_DISTURBED.
 */
static void find_hidden(pzs_selftest *selftest, const selftest_axis *axis, uint32_t line)
{
    const pzs_selftest_sums sums = compare_lines(selftest, axis, line, line);
    if (axis->line[line].state != PZS_WIRING_HEALTHY || can_judge(&sums))
        return;
    axis->line[line].state = PZS_WIRING_UNOBSERVABLE;
    if (!axis->is_row)
        selftest->state.core[0].disturbed = 1;
}

/*
 * Compute the gain of an amplifier at which the self-test has found no fault:
 *   sign(sum of m r) * (sum of |m r|) / (sum of r^2), over the sensors
 *   m, r  measured and modelled response
 * Absolute values are summed because a reversed or swapped sensor would otherwise cancel the
 * responses of the others.
 */
static void find_gain(const pzs_selftest *selftest, const selftest_axis *columns, uint32_t j)
{
    if (columns->line[j].state != PZS_WIRING_HEALTHY)
        return;
    const pzs_selftest_sums sums = compare_lines(selftest, columns, j, j);
    const pzs_real gain = sums.modelled > 0 ? sums.size / sums.modelled : 0;
    columns->line[j].gain = sums.product < 0 ? -gain : gain;
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
 * Set info.gain to the mean absolute gain (measured divided by modelled response) of the amplifiers
 * that respond. Silent amplifiers would make the others seem too strong, so the mean is repeated
 * GAIN_ROUNDS times, without amplifiers far below the last mean.
 */
static void find_mean_gain(pzs_selftest *selftest)
{
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
 * Prepare the evaluation of the self-test in its first tick: find the sensors that are noisy or
 * give no readings, and the amplifiers that were tested.
 */
static void begin_evaluation(pzs_selftest *selftest)
{
    pzs_selftest_state *state = &selftest->state;
    mark_sensors(selftest);
    find_noise_responses(state);
    for (uint32_t j = 0; j < state->tables->inputs; j++)
        if (pzs_selftest_moves(selftest, j))
            state->amplifier[j].state = PZS_WIRING_HEALTHY;
}

/* ---- responses unlike the model ------------------------------------------- */

/*
 * Whether the self-test may report an amplifier (or sensor) whose measured response differs from
 * the model. It must not have been reported before, and its modelled or measured response must be
 * large beside noise and vibration.
 *   sums in  comparison of its measured and modelled responses; entries of sensors (or amplifiers)
 *            that are already known to be faulty do not count
 */
static bool may_be_reported(const pzs_wiring *finding, const pzs_selftest_sums *sums)
{
    const bool is_large = sums->measured > 4 * RESPONSE * sums->noise;
    const bool is_healthy = finding->state == PZS_WIRING_HEALTHY;
    return (is_healthy && can_judge(sums)) ||
           ((is_healthy || finding->state == PZS_WIRING_UNOBSERVABLE) && is_large);
}

/*
 * Return the sum of the squared modelled responses of all sensors to amplifier `line` or, if lines
 * are rows, of sensor `line` to all amplifiers (1/V2). Entries of faulty amplifiers and sensors
 * count, too. Without them, a sensor that responds mainly to a faulty amplifier would have a
 * response no larger than errors of the model.
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
 * Return the mean gain (measured divided by modelled response) of all amplifiers, clamped to
 * plausible values.
 */
static pzs_real plausible_gain(const pzs_selftest *selftest)
{
    return number_clamp(selftest->info.gain, LEAST_GAIN, LARGEST_GAIN);
}

/*
 * Store an amplifier (or sensor) as the one whose measured response differs most from the model, if
 * its difference exceeds that of all earlier ones and the tolerance for the gains of amplifiers in
 * the self-test's tables.
 */
static void find_difference(pzs_selftest *selftest, const selftest_axis *axis, uint32_t line)
{
    pzs_selftest_state *state = &selftest->state;
    const pzs_real gain = plausible_gain(selftest);
    const pzs_selftest_sums sums = compare_lines(selftest, axis, line, line);
    const pzs_real expected = square(gain) * sums.modelled;
    const pzs_real difference = sums.measured - 2 * gain * sums.product + expected - sums.noise;
    const pzs_real most = square(state->tables->gain_tolerance) * expected;
    if (!may_be_reported(&axis->line[line], &sums) || difference <= most ||
        difference <= state->difference[axis->is_row] ||
        difference <= SAME_DIRECTION * whole_energy(selftest, axis, line))
        return;
    state->worst[axis->is_row] = (uint16_t)line;
    state->difference[axis->is_row] = difference;
}

/*
 * Return how much the measured response of an amplifier or sensor differs from a modelled one. In
 * general it is the squared sine of the angle between both vectors (0 to 1), which does not depend
 * on gains. If the modelled responses contain the gains (axis->has_gains), it is the squared
 * difference of the vectors (1/V2).
 */
static pzs_real response_error(const selftest_axis *axis, const pzs_selftest_sums *sums)
{
    if (axis->has_gains)
        return sums->measured - 2 * sums->product + sums->modelled;
    return direction_error(sums);
}

/*
 * Return the index of the amplifier (or sensor) whose modelled response is compared in step number
 * `step` with the measured response of the amplifier (or sensor) `subject`: in step 0 that of
 * `subject` itself, then all others in their order.
 */
static uint32_t compared_line(uint32_t subject, uint32_t step)
{
    const uint32_t other = step > subject ? step : step - 1u;
    return step > 0 ? other : subject;
}

/*
 * Compare the measured response of the amplifier (or sensor) `subject` with the modelled response
 * of another one (or of itself), and store the index of that other one if its response is nearer
 * than those compared earlier.
 */
static void find_nearest(pzs_selftest *selftest, const selftest_axis *axis, uint32_t subject,
                         uint32_t step)
{
    pzs_selftest_state *state = &selftest->state;
    const uint32_t line = compared_line(subject, step);
    const pzs_selftest_sums sums = compare_lines(selftest, axis, subject, line);
    if (step == 0)
        state->own = sums;
    if (step > 0 && !(response_error(axis, &sums) < response_error(axis, &state->nearest)))
        return;
    state->nearest = sums;
    state->core[0].nearest = line;
}

/*
 * Whether the cable of the amplifier (or sensor) `line` is exchanged with that of another one,
 * whose modelled response is nearest to its measured response. The measured response must exceed
 * noise and vibration, and have the direction and about the size of that modelled response.
 */
static bool is_other_line(const pzs_selftest *selftest, uint32_t line, pzs_real gain)
{
    const pzs_selftest_sums *own = &selftest->state.own, *nearest = &selftest->state.nearest;
    const pzs_real error = direction_error(nearest);
    return selftest->state.core[0].nearest != line && SWAP_GAIN * error < direction_error(own) &&
           2 * error < 1 && own->measured > RESPONSE * own->noise &&
           number_absolute(nearest->product) > SILENT * gain * nearest->modelled;
}

/*
 * Report the kind of fault of an amplifier or sensor whose measured response differs from the
 * model, after its response was compared with all modelled responses.
 */
static void set_finding(const pzs_selftest *selftest, const selftest_axis *axis, uint32_t line)
{
    pzs_wiring *finding = &axis->line[line];
    const pzs_real gain = plausible_gain(selftest);
    const pzs_selftest_sums *own = &selftest->state.own;
    const pzs_real energy = own->measured - own->noise;
    finding->gain = own->modelled > 0 ? own->product / own->modelled : 0;
    if (is_other_line(selftest, line, gain)) {
        finding->state = PZS_WIRING_SWAPPED;
        finding->other = (uint16_t)selftest->state.core[0].nearest;
    } else if (energy < square(SILENT * gain) * own->modelled) {
        finding->state = PZS_WIRING_SILENT;
    } else if (2 * direction_error(own) > 1) {
        finding->state = PZS_WIRING_UNKNOWN;
    } else {
        finding->state = own->product < 0 ? PZS_WIRING_REVERSED : PZS_WIRING_GAIN;
    }
}

/*
 * Report the amplifier or sensor whose measured response differs most from the model if it responds
 * with the wrong sign (reversed). This precedes the search for exchanged cables: where there are
 * few sensors, a reversed one makes healthy amplifiers resemble others.
 */
static void report_reversed(const pzs_selftest *selftest, const selftest_axis *axis, uint32_t line)
{
    const pzs_selftest_sums *own = &selftest->state.own;
    if (selftest->state.core[0].nearest == line && own->product < 0 && 2 * direction_error(own) < 1)
        set_finding(selftest, axis, line);
}

/* ---- exchanged cables ----------------------------------------------------- */

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
    const pzs_selftest_sums sums = {product, product, first, second, 0};
    return direction_error(&sums);
}

/*
 * Compare the modelled response of the amplifier (or sensor) `subject` with that of another one, in
 * each step the next one. If both are so similar that the self-test would not notice exchanged
 * cables, and more similar than all before, the other one is stored as `similar` in the finding
 * about `subject`.
 */
static void find_similar(pzs_selftest *selftest, const selftest_axis *axis, uint32_t subject,
                         uint32_t step)
{
    const uint32_t line = compared_line(subject, step);
    pzs_real *least = &selftest->state.least_angle;
    if (step == 0) {
        const pzs_selftest_sums sums = compare_lines(selftest, axis, subject, subject);
        *least = SIMILAR * sums.noise / sums.modelled + SAME_DIRECTION;
        return;
    }
    const pzs_real angle = model_angle(selftest, axis, subject, line);
    if (!(angle < *least))
        return;
    *least = angle;
    axis->line[subject].similar = (uint16_t)line;
}

/*
 * Return how much the measured responses of two amplifiers (or sensors) differ from two modelled
 * responses. Each response is a vector. The result is the sum of two squared sines: one of the
 * angle between the measured and the modelled vector of the first amplifier, one of the same angle
 * of the second.
 *
 * If the modelled vectors contain the measured gains (axis->has_gains), their lengths count, too:
 * the result is the squared sine of the angle between both measured vectors, joined to one long
 * vector, and both modelled ones, joined in the same way.
 *   one   in  comparison of the measured response of the first amplifier (or sensor) with a
 *             modelled response: its own or, to find exchanged cables, that of the second
 *   other in  comparison of the measured response of the second, with its own modelled response or
 *             that of the first
 */
static pzs_real pair_error(const selftest_axis *axis, const pzs_selftest_sums *one,
                           const pzs_selftest_sums *other)
{
    const pzs_selftest_sums both = {one->product + other->product, one->size + other->size,
                                    one->measured + other->measured,
                                    one->modelled + other->modelled, one->noise + other->noise};
    // Two sensors may see nearly the same shape: exchanged cables then show only in the sizes of
    // their responses.
    if (axis->has_gains)
        return direction_error(&both);
    return direction_error(one) + direction_error(other);
}

/*
 * In the search for exchanged cables, examine the possible partner of the amplifier (or sensor)
 * `subject`: compare the partner's measured response with a modelled response, with its own (`step`
 * 0), or with that of `subject` (`step` 1).
 */
static void compare_partner(pzs_selftest *selftest, const selftest_axis *axis, uint32_t subject,
                            uint32_t step)
{
    pzs_selftest_state *state = &selftest->state;
    const uint32_t partner = state->core[0].nearest;
    if (step == 0)
        state->partner_own = compare_lines(selftest, axis, partner, partner);
    else
        state->partner_nearest = compare_lines(selftest, axis, partner, subject);
}

/*
 * Mark two amplifiers (or sensors) as swapped: the given one, and the one whose modelled response
 * is nearest to its measured response. Both are marked if an exchange of their cables explains
 * their measured responses much better, and if the differences from the model exceed noise and
 * vibration.
 */
static void find_swap(const pzs_selftest *selftest, const selftest_axis *axis, uint32_t line)
{
    const pzs_selftest_state *state = &selftest->state;
    const uint32_t other = state->core[0].nearest;
    const pzs_real kept = pair_error(axis, &state->own, &state->partner_own);
    const pzs_real exchanged = pair_error(axis, &state->nearest, &state->partner_nearest);
    const pzs_real noise = state->own.noise / state->own.measured +
                           state->partner_own.noise / state->partner_own.measured;
    if (!(SWAP_GAIN * exchanged < kept && kept > SWAP_NOISE * noise && kept > SAME_DIRECTION))
        return;
    axis->line[line].state = PZS_WIRING_SWAPPED;
    axis->line[line].other = (uint16_t)other;
    axis->line[other].state = PZS_WIRING_SWAPPED;
    axis->line[other].other = (uint16_t)line;
}

/* ---- verdict -------------------------------------------------------------- */

/* Return the number of amplifiers (or sensors) at which the self-test has found a fault. */
static uint16_t count_findings(const selftest_axis *axis)
{
    uint16_t count = 0;
    for (uint32_t line = 0; line < axis->lines; line++)
        count = (uint16_t)(count + (axis->line[line].state >= PZS_WIRING_SILENT ? 1u : 0u));
    return count;
}

/*
 * Mark an amplifier (or sensor) that seems silent as swapped if the self-test has found that the
 * cable of another one is exchanged with its cable. If the cables of a strong and a weak electrode
 * are exchanged, the amplifier of the strong electrode seems to be silent.
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

/* ---- stages --------------------------------------------------------------- */

/*
 * Each stage of the self-test's evaluation is a sequence of steps. A step compares one measured
 * with one modelled response: a column (of an amplifier) or a row (of a sensor) of the matrix of
 * changes of readings per voltage. The last step decides what the comparisons mean, and which stage
 * is next.
 *
 * A tick makes steps until it has compared settings.work_limit matrix entries, so that its time
 * hardly depends on the size of the structure. The findings are the same for any number of ticks.
 */

/*
 * Plan of a stage of the self-test's evaluation: which comparisons of measured with modelled
 * responses of sensors to amplifiers the stage makes, one in each step.
 */
typedef struct stage_plan {
    selftest_axis axis;
    uint32_t subject; /* index of the amplifier (or sensor) whose measured response is compared with
                         modelled ones, in the stages that examine one amplifier or sensor; 0 in the
                         stages that go through all of them */
    uint32_t steps;   /* number of comparisons of responses in a stage of the self-test's evaluation
                       */
} stage_plan;

/* Return the number of amplifiers and sensors of the self-test together. */
static uint32_t count_lines(const pzs_selftest *selftest)
{
    const pzs_selftest_tables *tables = selftest->state.tables;
    return (uint32_t)tables->inputs + tables->sensors;
}

/*
 * Return the plan (list of comparisons) of a stage of the self-test's evaluation: compare the
 * measured response that differs most from the model with the modelled responses of all amplifiers
 * (or all sensors). The plan is empty if no response differs.
 */
static stage_plan plan_of_worst(const pzs_selftest *selftest)
{
    const pzs_selftest_state *state = &selftest->state;
    const selftest_axis columns = columns_of(selftest), rows = rows_of(selftest);
    const bool is_row =
        state->worst[1] < rows.lines && !(state->difference[1] <= state->difference[0]);
    const selftest_axis axis = is_row ? rows : columns;
    const uint32_t line = state->worst[is_row];
    return (stage_plan){axis, line, line < axis.lines ? axis.lines : 0};
}

/*
 * Return the list of comparisons (plan) for the present stage of the self-test's evaluation, if the
 * stage looks for exchanged cables of the amplifier or sensor number `core->pair`. The list is
 * empty if a fault of this amplifier or sensor is already known.
 *   STAGE_PAIR_SIMILAR, STAGE_PAIR_NEAREST  comparisons with all amplifiers (or sensors)
 *   STAGE_PAIR_EXCHANGED                    two comparisons with its possible partner
 *                                           (compare_partner); none if no healthy partner has been
 *                                           found
 */
static stage_plan plan_of_pair(const pzs_selftest *selftest)
{
    const pzs_selftest_core *core = &selftest->state.core[0];
    const selftest_axis columns = columns_of(selftest), rows = rows_of(selftest);
    // Begin with the smaller group, amplifiers or sensors (amplifiers if both are equal): if a
    // group is small, a fault of one member changes the responses of the others more.
    const selftest_axis few = columns.lines <= rows.lines ? columns : rows;
    const selftest_axis many = columns.lines <= rows.lines ? rows : columns;
    const bool is_few = core->pair < few.lines;
    const uint32_t pair = is_few ? core->pair : core->pair - few.lines;
    stage_plan plan = {is_few ? few : many, pair, 0};
    const pzs_wiring *line = plan.axis.line;
    plan.axis.has_gains = plan.axis.is_row;
    if (plan.subject >= plan.axis.lines || line[plan.subject].state != PZS_WIRING_HEALTHY)
        return plan;
    const bool has_partner = core->nearest < plan.axis.lines && core->nearest != plan.subject &&
                             line[core->nearest].state == PZS_WIRING_HEALTHY;
    plan.steps = plan.axis.lines;
    if (core->stage == STAGE_PAIR_EXCHANGED)
        plan.steps = has_partner ? 2 : 0;
    return plan;
}

/*
 * Return which comparisons of measured with modelled responses the present stage of the self-test's
 * evaluation makes. Sensors are compared with the model only while the mean gain (measured divided
 * by modelled response) of the amplifiers is plausible: otherwise all responses differ from the
 * model.
 */
static stage_plan plan_of(const pzs_selftest *selftest)
{
    const selftest_axis columns = columns_of(selftest), rows = rows_of(selftest);
    switch (selftest->state.core[0].stage) {
    case STAGE_HIDDEN_ROWS: return (stage_plan){rows, 0, rows.lines};
    case STAGE_FIRST_ROWS:
    case STAGE_ROWS: return (stage_plan){rows, 0, is_gain_plausible(selftest) ? rows.lines : 0};
    case STAGE_FIRST_NEAREST:
    case STAGE_NEAREST: return plan_of_worst(selftest);
    case STAGE_PAIR_SIMILAR:
    case STAGE_PAIR_NEAREST:
    case STAGE_PAIR_EXCHANGED: return plan_of_pair(selftest);
    default: return (stage_plan){columns, 0, columns.lines};
    }
}

/*
 * Make comparison number `step` of a measured with a modelled response of sensors to amplifiers, in
 * the present stage of the self-test's evaluation.
 */
static void compare(pzs_selftest *selftest, const stage_plan *plan, uint32_t step)
{
    switch (selftest->state.core[0].stage) {
    case STAGE_HIDDEN_COLUMNS:
    case STAGE_HIDDEN_ROWS: find_hidden(selftest, &plan->axis, step); return;
    case STAGE_FIRST_GAINS:
    case STAGE_PAIR_GAINS:
    case STAGE_GAINS: find_gain(selftest, &plan->axis, step); return;
    case STAGE_PAIR_SIMILAR: find_similar(selftest, &plan->axis, plan->subject, step); return;
    case STAGE_PAIR_EXCHANGED: compare_partner(selftest, &plan->axis, plan->subject, step); return;
    case STAGE_FIRST_NEAREST:
    case STAGE_PAIR_NEAREST:
    case STAGE_NEAREST: find_nearest(selftest, &plan->axis, plan->subject, step); return;
    default: find_difference(selftest, &plan->axis, step); return;
    }
}

/*
 * End the search of the self-test's evaluation for the amplifier or sensor whose measured response
 * differs most from the model: report its fault. Returns the next stage: another search without the
 * responses of this amplifier or sensor, or the verdict if no response differs.
 */
static uint32_t end_search(pzs_selftest *selftest, const stage_plan *plan)
{
    if (plan->steps == 0)
        return STAGE_VERDICT;
    set_finding(selftest, &plan->axis, plan->subject);
    selftest->state.core[0].searches++;
    return selftest->state.core[0].searches < count_lines(selftest) ? STAGE_GAINS : STAGE_VERDICT;
}

/*
 * End a stage of the self-test's evaluation, which has compared measured with modelled responses:
 * compute gains or report the faults that the comparisons show. Returns the next stage.
 */
static uint32_t end_stage(pzs_selftest *selftest, const stage_plan *plan)
{
    pzs_selftest_core *core = &selftest->state.core[0];
    switch (core->stage) {
    case STAGE_FIRST_GAINS:
    case STAGE_PAIR_GAINS:
    case STAGE_GAINS: find_mean_gain(selftest); break;
    case STAGE_FIRST_NEAREST:
        if (plan->steps > 0)
            report_reversed(selftest, &plan->axis, plan->subject);
        break;
    case STAGE_PAIR_EXCHANGED:
        if (plan->steps > 0)
            find_swap(selftest, &plan->axis, plan->subject);
        core->pair++;
        return core->pair < count_lines(selftest) ? STAGE_PAIR_SIMILAR : STAGE_GAINS;
    case STAGE_NEAREST: return end_search(selftest, plan);
    default: break;
    }
    return core->stage + 1u;
}

/*
 * Begin a stage of the self-test's evaluation. A stage that searches for the amplifier or sensor
 * with the largest difference from the model forgets the one that was found last.
 */
static void begin_stage(pzs_selftest *selftest, uint32_t stage)
{
    pzs_selftest_state *state = &selftest->state;
    const bool is_of_rows = stage == STAGE_FIRST_ROWS || stage == STAGE_ROWS;
    state->core[0].stage = stage;
    state->core[0].step = 0;
    if (!is_of_rows && stage != STAGE_FIRST_COLUMNS && stage != STAGE_COLUMNS)
        return;
    state->worst[is_of_rows] = PZS_WIRING_NONE;
    state->difference[is_of_rows] = 0;
}

/*
 * Make one step of the self-test's evaluation: a comparison of a measured with a modelled response
 * of sensors to amplifiers, or the end of the present stage. Returns the number of compared
 * entries, plus a constant for the step.
 */
static uint32_t make_step(pzs_selftest *selftest)
{
    pzs_selftest_core *core = &selftest->state.core[0];
    const stage_plan plan = plan_of(selftest);
    if (core->step < plan.steps)
        compare(selftest, &plan, core->step++);
    else
        begin_stage(selftest, end_stage(selftest, &plan));
    return plan.axis.entries + PZS_SELFTEST_STEP_WORK;
}

/*
 * The first tick of the self-test's evaluation only prepares the measured responses. The last one
 * only sets the verdict: it must be short, because without a fault the loop controls the voltages
 * in the same tick.
 */
void pzs_selftest_evaluate(pzs_selftest *selftest)
{
    pzs_selftest_core *core = &selftest->state.core[0];
    uint32_t work = 0;
    // A stage number beyond the last stage shows damaged memory; then no amplifier may pass.
    if (core->stage > STAGE_VERDICT) {
        core->disturbed = 1;
        core->stage = STAGE_VERDICT;
    }
    if (core->stage == STAGE_START) {
        begin_evaluation(selftest);
        begin_stage(selftest, STAGE_HIDDEN_COLUMNS);
    } else if (core->stage == STAGE_VERDICT) {
        give_verdict(selftest);
    } else {
        do
            work += make_step(selftest);
        while (work < selftest->settings.work_limit && core->stage < STAGE_VERDICT);
    }
    selftest->info.work = work;
}
