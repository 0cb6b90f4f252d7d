/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Calibration on the device: recursive least squares for the influence matrix (pzs_calibrate.h).
 *
 * The influence matrix B minimises the sum of |y - B v|^2 over the records of voltages v and
 * readings y. State of the calibration:
 *   T [inputs][inputs]   triangular factor of the information matrix I = T'T, the sum of v v'
 *   Z [inputs][outputs]  readings in the same basis: T B' = Z
 *
 * Plane rotations of the rows of [T Z] add a record, without squaring the condition number. The
 * part of the readings that the rotations leave is the residual of the record; its mean square is
 * the variance of the noise.
 */
#include <string.h>
#include "pzs_calibrate.h"
#include "control.h"
#include "output_gate.h"
#include "limit_rows.h"
#include "../core/guard.h"
#include "../core/numbers.h"

/*
 * Value of state.stage by which other functions recognise a calibration that was initialised
 * without an error.
 */
#define READY 1u
/*
 * Reserve against overflow: the sum over 2^32 records must not overflow. A record (voltages and
 * readings) is therefore refused if the sum of its squared numbers, times this factor, exceeds the
 * largest real number.
 */
#define SUM_RESERVE PZS_R(4294967296.0)
/*
 * A test voltage of a calibration counts as constant if it changes in a tick by at most this
 * fraction of the voltage range of its input and at most half of its step limit. On its way to the
 * value that the test pattern demands it changes by the whole step limit.
 */
#define AT_REST PZS_R(1e-4)
/*
 * Factor of the threshold below which a diagonal entry of the triangular factor of the information
 * matrix counts as zero:
 *   ROUNDING * machine epsilon * sqrt(number of records) * norm of the entry's column
 * The information matrix is the sum of v v' over the recorded voltages v.
 */
#define ROUNDING PZS_R(8)

static pzs_status finish(pzs_calibration *calibration, pzs_status status, int32_t where)
{
    calibration->info.where = where;
    return status;
}

static size_t width_of(const pzs_calibration *calibration)
{
    return (size_t)calibration->state.problem->inputs + calibration->state.problem->outputs;
}

/*
 * Return row `index` of the matrix [inputs + 1][inputs + outputs] in which a calibration stores its
 * least-squares problem; plane rotations of its rows add a record. The first `inputs` columns are
 * the triangular factor R, where R'R is the sum of v v' over the recorded voltages v. The other
 * columns are the recorded readings after the same rotations.
 */
static pzs_real *row_of(const pzs_calibration *calibration, size_t index)
{
    return calibration->state.factor + index * width_of(calibration);
}

static pzs_real square(pzs_real number)
{
    return number * number;
}

static pzs_real energy(const pzs_real *value, size_t count)
{
    pzs_real sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += square(value[i]);
    return sum;
}

static bool is_used(const pzs_calibration *calibration, size_t output)
{
    const uint8_t *ignored = calibration->settings.ignored;
    return ignored == NULL || ignored[output] == 0;
}

/* ---- initialisation of a calibration --------------------------------- */

static uint32_t period_of(uint32_t inputs)
{
    uint32_t period = 1;
    while (period <= inputs)
        period *= 2;
    return period;
}

/*
 * Set the pointers of the calibration to its arrays in the workspace, from the address `next` on.
 */
static void place(pzs_calibration *calibration, pzs_real *next)
{
    pzs_calibration_state *state = &calibration->state;
    const size_t inputs = state->problem->inputs;
    state->factor = next, next += (inputs + 1) * width_of(calibration);
    state->direction = next, next += inputs;
    state->centre = next, next += inputs;
    state->proposal = next, next += inputs;
    state->free = next, next += inputs;
    state->least = next, next += inputs;
    for (int copy = 0; copy < 3; copy++)
        state->last[copy] = next, next += inputs;
    state->noise = next;
    calibration->info.voltage = state->last[0];
    calibration->info.noise = state->noise;
}

/*
 * Start the test voltages of a calibration at the voltages of the amplifiers, clamped to all
 * limits.
 *   voltage [inputs] in  voltages of the amplifiers (V)
 */
static void set_start(pzs_calibration *calibration, const pzs_real *voltage)
{
    pzs_calibration_state *state = &calibration->state;
    const pzs_problem *problem = state->problem;
    for (uint32_t i = 0; i < problem->inputs; i++) {
        state->centre[i] = number_clamp(voltage[i], problem->lower[i], problem->upper[i]);
        state->free[i] = (pzs_real)NAN;
    }
    if (problem->limit_rows != NULL)
        (void)problem->limit_rows->call->scale_back(problem, problem->limit_rows->safe,
                                                    state->centre);
    for (int copy = 0; copy < 3; copy++)
        memcpy(state->last[copy], state->centre, problem->inputs * sizeof *state->centre);
}

pzs_status pzs_calibration_init(pzs_calibration *calibration, const pzs_problem *problem,
                                const pzs_real *influence, const pzs_real *voltage, void *work,
                                size_t bytes)
{
    if (calibration == NULL)
        return PZS_E_ARGUMENT;
    calibration->state.stage = 0;
    if (problem == NULL || work == NULL)
        return PZS_E_ARGUMENT;
    *calibration = (pzs_calibration){
        .settings = {(pzs_real)INFINITY, PZS_R(0.25), 8, (pzs_real)INFINITY, NULL},
        .info.where = -1,
        .state.problem = problem,
        .state.influence = influence != NULL ? influence : problem->influence};
    int32_t where = -1;
    /*
     * A calibration is refused for a sparse influence matrix, which has no room for entries that
     * the calibration could find.
     */
    if (calibration->state.influence == NULL)
        return finish(calibration, PZS_E_ARGUMENT, where);
    const pzs_status status =
        pzs_control_check_problem(problem, calibration->state.influence, &where);
    if (status != PZS_OK)
        return finish(calibration, status, where);
    const pzs_real *start = voltage != NULL ? voltage : problem->reference_voltage;
    where = pzs_guard_nonfinite(start, problem->inputs);
    if (where >= 0)
        return finish(calibration, PZS_E_NONFINITE, where);
    const size_t need = PZS_CALIBRATION_BYTES(problem->inputs, problem->outputs);
    where = guard_missing_bytes(work, bytes, need);
    if (where >= 0)
        return finish(calibration, PZS_E_WORKSPACE, where);
    memset(work, 0, need);
    place(calibration, work);
    set_start(calibration, start);
    calibration->state.limit_sum = pzs_output_limit_sum(problem);
    calibration->info.period = period_of(problem->inputs);
    calibration->state.stage = READY;
    return PZS_OK;
}

static pzs_status check_ready(const pzs_calibration *calibration, const void *one,
                              const void *other)
{
    if (calibration == NULL || one == NULL || other == NULL)
        return PZS_E_ARGUMENT;
    return calibration->state.stage == READY ? PZS_OK : PZS_E_STAGE;
}

/* ---- test voltages of a calibration ---------------------------------- */

/*
 * Return the sign of the test voltage of an input (1 or -1) in a test pattern: -1 if the numbers of
 * the pattern and of the input, counted from 1, have an odd number of binary ones in common. Over a
 * period of patterns these Walsh functions are orthogonal to each other and to a constant.
 */
static pzs_real sign_of(uint32_t pattern, uint32_t input)
{
    uint32_t common = pattern & (input + 1u);
    common ^= common >> 16;
    common ^= common >> 8;
    common ^= common >> 4;
    common ^= common >> 2;
    common ^= common >> 1;
    return (common & 1u) != 0 ? PZS_R(-1) : PZS_R(1);
}

/* Return half of the voltage range of an input (V), computed without overflow. */
static pzs_real half_range(const pzs_problem *problem, uint32_t input)
{
    return problem->upper[input] / 2 - problem->lower[input] / 2;
}

/*
 * Whether the test voltages of a calibration after a tick are equal to those before the tick, up to
 * a small part of the voltage range.
 */
static bool have_settled(const pzs_calibration *calibration, const pzs_real *before)
{
    const pzs_calibration_state *state = &calibration->state;
    for (uint32_t i = 0; i < state->problem->inputs; i++) {
        const pzs_real part = AT_REST * half_range(state->problem, i),
                       step = state->problem->step_limit[i] / 2;
        if (number_absolute(state->last[0][i] - before[i]) > (part < step ? part : step))
            return false;
    }
    return true;
}

/* Return the first input whose voltage range is not finite, or -1. */
static int32_t unbounded_input(const pzs_problem *problem)
{
    for (uint32_t i = 0; i < problem->inputs; i++)
        if (!number_is_finite(half_range(problem, i)))
            return (int32_t)i;
    return -1;
}

pzs_status pzs_calibration_excite(pzs_calibration *calibration)
{
    const pzs_status status = check_ready(calibration, calibration, calibration);
    if (status != PZS_OK)
        return status;
    pzs_calibration_state *state = &calibration->state;
    const pzs_problem *problem = state->problem;
    const pzs_calibration_settings *settings = &calibration->settings;
    if (!(settings->amplitude > 0) || settings->amplitude > 1 || settings->settle == 0)
        return finish(calibration, PZS_E_ARGUMENT, -1);
    int32_t where = unbounded_input(problem);
    if (where >= 0)
        return finish(calibration, PZS_E_LIMITS, where);
    state->pattern += calibration->info.is_settled ? 1u : 0u;
    for (uint32_t i = 0; i < problem->inputs; i++) {
        const pzs_real amplitude = settings->amplitude * half_range(problem, i);
        state->proposal[i] = state->centre[i] + sign_of(state->pattern, i) * amplitude;
        state->direction[i] = state->last[0][i];
    }
    pzs_real *const held[3] = {state->free, state->free, state->free};
    const output_gate gate = {
        problem, held, {state->last[0], state->last[1], state->last[2]}, state->proposal};
    if (pzs_output_gate(&gate, state->proposal, state->limit_sum, &where) == PZS_E_CRC)
        return finish(calibration, PZS_E_CRC, -1);
    const bool continues = !calibration->info.is_settled;
    state->rest = have_settled(calibration, state->direction) && continues ? state->rest + 1u : 0;
    calibration->info.is_settled = state->rest >= settings->settle;
    return finish(calibration, PZS_OK, -1);
}

/* ---- records of voltages and readings -------------------------------- */

/*
 * Return the threshold, relative to the norm of its column, below which a diagonal entry (pivot) of
 * the triangular factor of the information matrix is only a rounding error. The information matrix
 * is the sum of v v' over the recorded voltages v.
 */
static pzs_real negligible(const pzs_calibration *calibration)
{
    const pzs_real count =
        (pzs_real)calibration->info.records + (pzs_real)calibration->state.problem->inputs;
    return ROUNDING * PZS_EPSILON * PZS_SQRT(count);
}

/*
 * Rotate two matrix rows in their plane, from column `from` on, by the angle with the given cosine
 * and sine.
 *   first, second [count] in/out  the two rows
 */
static void turn(pzs_real *restrict first, pzs_real *restrict second, size_t from, size_t count,
                 pzs_real cosine, pzs_real sine)
{
    for (size_t j = from; j < count; j++) {
        const pzs_real one = first[j], other = second[j];
        first[j] = cosine * one + sine * other;
        second[j] = cosine * other - sine * one;
    }
}

/*
 * Rotate two matrix rows in their plane so that entry `at` of the second row becomes 0; all entries
 * before it must be 0 in both rows. If both entries `at` are rounding errors, both become 0
 * instead. Returns the cosine of the angle.
 *   first, second [inputs + outputs] in/out  the two rows
 */
static pzs_real eliminate(const pzs_calibration *calibration, pzs_real *first, pzs_real *second,
                          size_t at)
{
    if (!(number_absolute(second[at]) > 0))
        return 1;
    const pzs_real size = PZS_SQRT(square(first[at]) + square(second[at]));
    if (!(size > calibration->state.least[at])) {
        first[at] = second[at] = 0;
        return 1;
    }
    const pzs_real cosine = first[at] / size;
    turn(first, second, at, width_of(calibration), cosine, second[at] / size);
    second[at] = 0;
    return cosine;
}

/*
 * Compute the thresholds below which the pivots, the diagonal entries of the triangular factor,
 * count as zero. The factor is that of the information matrix, the sum of v v' over the recorded
 * voltages v.
 *   voltage [inputs] in  voltages of the record that is being added (V)
 */
static void find_least(pzs_calibration *calibration, const pzs_real *voltage)
{
    const pzs_real rounding = negligible(calibration);
    for (size_t k = 0; k < calibration->state.problem->inputs; k++) {
        pzs_real column = square(voltage[k]);
        for (size_t j = 0; j <= k; j++)
            column += square(row_of(calibration, j)[k]);
        calibration->state.least[k] = rounding * PZS_SQRT(column);
    }
}

/*
 * Remove the rows of the triangular factor of the information matrix whose diagonal entry is 0.
 * Plane rotations move the content of such a row into the rows below it, until the whole row is 0.
 */
static void clear_open_rows(pzs_calibration *calibration)
{
    const size_t inputs = calibration->state.problem->inputs;
    for (size_t k = 0; k < inputs; k++) {
        pzs_real *row = row_of(calibration, k);
        if (number_absolute(row[k]) > 0)
            continue;
        for (size_t j = k + 1; j < inputs; j++)
            (void)eliminate(calibration, row_of(calibration, j), row, j);
        memset(row, 0, width_of(calibration) * sizeof *row);
    }
}

/*
 * Forgetting of old records is directional: a new record replaces information only about the
 * direction of its voltages v; information about other directions is kept. A record changes the
 * information matrix I, the sum of v v' over the records, to
 *   J = I - f (I v)(I v)'/(v'Iv) + v v'      with   f = min(1/M, |v|^4/(v'Iv))
 *   f  part of the information in the direction of v that is forgotten
 *   M  settings.memory, number of records after which older ones are forgotten
 *
 * The covariance of the influence matrix, the variance of the noise times the inverse of J, is
 * bounded, because the eigenvalues of J are:
 *   at most   the larger one of the largest eigenvalue of I and V^2 M
 *   at least  det I/(V^2 M)^(inputs - 1), because the choice of f makes det J >= det I
 *   V         largest norm of v in all records
 */

/*
 * Return the part of the information about one direction of the voltage vector that a calibration
 * forgets when a record with voltages in this direction is added. The part is at least 0 and at
 * most 1 / settings.memory.
 *   voltage   [inputs] in  voltages of the record (V)
 *   direction [inputs] in  triangular factor of the information matrix times these voltages (V2)
 */
static pzs_real forgotten_part(const pzs_calibration *calibration, const pzs_real *voltage,
                               const pzs_real *direction)
{
    const size_t inputs = calibration->state.problem->inputs;
    const pzs_real part = 1 / calibration->settings.memory;
    const pzs_real size = energy(voltage, inputs), known = energy(direction, inputs);
    if (!(known > 0))
        return 0;
    const pzs_real most = size / known * size;
    return most < part ? most : part;
}

/*
 * R is the triangular factor of the information matrix R'R, and v the voltages of a new record.
 * Rotate the rows of R, which leaves R'R unchanged, until only the first row has a product with v
 * other than 0. Scaling the first row then forgets information about the direction of v.
 *   direction [inputs] in/out  in: R v (V2); out: overwritten
 * Afterwards every other row of R has one nonzero entry to the left of the diagonal.
 */
static void collect_direction(pzs_calibration *calibration, pzs_real *direction)
{
    for (size_t k = calibration->state.problem->inputs - 1u; k > 0; k--) {
        const pzs_real size = PZS_SQRT(square(direction[k - 1]) + square(direction[k]));
        if (!(size > 0))
            continue;
        turn(row_of(calibration, k - 1), row_of(calibration, k), k - 1, width_of(calibration),
             direction[k - 1] / size, direction[k] / size);
        direction[k - 1] = size;
    }
}

/*
 * Let a calibration forget a part of what it knows about the effect of voltages in one direction,
 * the direction of a new record's voltage vector. The knowledge is the triangular factor of the
 * information matrix, the sum of v v' over the recorded voltages v.
 *   voltage [inputs] in  voltages of the record (V)
 */
static void forget(pzs_calibration *calibration, const pzs_real *voltage)
{
    const size_t inputs = calibration->state.problem->inputs, width = width_of(calibration);
    pzs_real *direction = calibration->state.direction, *first = row_of(calibration, 0);
    for (size_t k = 0; k < inputs; k++) {
        const pzs_real *row = row_of(calibration, k);
        direction[k] = 0;
        for (size_t j = k; j < inputs; j++)
            direction[k] += row[j] * voltage[j];
    }
    const pzs_real part = forgotten_part(calibration, voltage, direction);
    if (!(part > 0))
        return;
    collect_direction(calibration, direction);
    const pzs_real factor = PZS_SQRT(1 - part);
    for (size_t j = 0; j < width; j++)
        first[j] *= factor;
    for (size_t k = 0; k + 1 < inputs; k++)
        (void)eliminate(calibration, row_of(calibration, k), row_of(calibration, k + 1), k);
}

/*
 * Update the variance of the noise of each output from the residuals of a record, the differences
 * between its readings and those that the influence matrix explains.
 *   residual [outputs] in  residuals of the record, scaled so that their variance is that of the
 *                          noise (m)
 */
static void renew_noise(pzs_calibration *calibration, const pzs_real *residual)
{
    pzs_calibration_state *state = &calibration->state;
    state->surplus += state->surplus < UINT32_MAX ? 1u : 0u;
    const pzs_real window = calibration->settings.memory * (pzs_real)state->problem->inputs;
    const pzs_real count = (pzs_real)state->surplus < window ? (pzs_real)state->surplus : window;
    for (size_t i = 0; i < state->problem->outputs; i++)
        state->noise[i] += (square(residual[i]) - state->noise[i]) / count;
}

/*
 * Copy the readings of the outputs that the calibration uses, and set those of all others to 0.
 * Returns the index of the first used reading that is not finite or exceeds settings.reading_limit
 * in size, or -1.
 */
static int32_t take_readings(const pzs_calibration *calibration, const pzs_real *reading,
                             pzs_real *taken)
{
    int32_t unusable = -1;
    const pzs_real most = calibration->settings.reading_limit;
    for (size_t i = calibration->state.problem->outputs; i-- > 0;) {
        taken[i] = is_used(calibration, i) ? reading[i] : 0;
        if (!number_is_finite(taken[i]) || number_absolute(taken[i]) > most)
            unusable = (int32_t)i;
    }
    return unusable;
}

pzs_status pzs_calibration_record(pzs_calibration *calibration, const pzs_real *voltage,
                                  const pzs_real *reading)
{
    const pzs_status status = check_ready(calibration, voltage, reading);
    if (status != PZS_OK)
        return status;
    const size_t inputs = calibration->state.problem->inputs, width = width_of(calibration);
    if (!(calibration->settings.memory >= 2) || !(calibration->settings.reading_limit > 0))
        return finish(calibration, PZS_E_ARGUMENT, -1);
    pzs_real *record = row_of(calibration, inputs);
    const int32_t bad = pzs_guard_nonfinite(voltage, (uint32_t)inputs);
    if (bad >= 0)
        return finish(calibration, PZS_E_NONFINITE, bad);
    const int32_t unusable = take_readings(calibration, reading, record + inputs);
    if (unusable >= 0)
        return finish(calibration, PZS_W_SENSOR, unusable);
    memcpy(record, voltage, inputs * sizeof *record);
    if (!number_is_finite(energy(record, width) * SUM_RESERVE))
        return finish(calibration, PZS_E_NONFINITE, -1);
    find_least(calibration, voltage);
    forget(calibration, voltage);
    pzs_real cosine = 1;
    for (size_t k = 0; k < inputs; k++)
        cosine *= eliminate(calibration, row_of(calibration, k), record, k);
    clear_open_rows(calibration);
    calibration->info.records += calibration->info.records < UINT32_MAX ? 1u : 0u;
    if (number_absolute(cosine) > negligible(calibration))
        renew_noise(calibration, record + inputs);
    return finish(calibration, PZS_OK, -1);
}

/* ---- result: the influence matrix ------------------------------------ */

/*
 * Compute the reciprocals of the pivots, the diagonal entries of the triangular factor of the
 * information matrix (sum of v v' over the recorded voltages v). For an input that the records do
 * not determine the result is 0. Returns the first such input, or -1.
 *   inverse [inputs] out  reciprocals (1/V)
 */
static int32_t invert_pivots(const pzs_calibration *calibration, pzs_real *inverse)
{
    int32_t open = -1;
    for (size_t k = calibration->state.problem->inputs; k-- > 0;) {
        const pzs_real pivot = row_of(calibration, k)[k];
        const bool is_known = number_absolute(pivot) > 0;
        inverse[k] = is_known ? 1 / pivot : 0;
        open = is_known ? open : (int32_t)k;
    }
    return open;
}

/*
 * Compute one row of the influence matrix of a calibration by back substitution with the triangular
 * factor T of the information matrix.
 *   inverse [inputs] in      reciprocals of the diagonal entries of T (1/V)
 *   row     [inputs] in/out  row of the influence matrix (m/V); the entry of an input that the
 *                            records do not determine stays unchanged
 */
static void solve_row(const pzs_calibration *calibration, size_t output, const pzs_real *inverse,
                      pzs_real *row)
{
    const size_t inputs = calibration->state.problem->inputs;
    for (size_t k = inputs; k-- > 0;) {
        const pzs_real *factor = row_of(calibration, k);
        pzs_real sum = factor[inputs + output];
        for (size_t j = k + 1; j < inputs; j++)
            sum -= factor[j] * row[j];
        row[k] = number_absolute(inverse[k]) > 0 ? sum * inverse[k] : row[k];
    }
}

/*
 * Return the standard error of the influence of one input, divided by the standard deviation of the
 * noise: the square root of diagonal entry `input` of the inverse information matrix (1/V). It is
 * computed as |x| from T' x = unit vector, with the triangular factor T of the information matrix.
 *   inverse  [inputs] in   reciprocals of the diagonal entries of T (1/V)
 *   solution [inputs] out  work array for x; the result is infinite if x needs an input that the
 *                          records do not determine
 */
static pzs_real spread_of(const pzs_calibration *calibration, size_t input, const pzs_real *inverse,
                          pzs_real *solution)
{
    const pzs_calibration_state *state = &calibration->state;
    const size_t inputs = state->problem->inputs;
    pzs_real squares = 0;
    for (size_t k = input; k < inputs; k++) {
        pzs_real sum = k == input ? PZS_R(1) : 0;
        for (size_t j = input; j < k; j++)
            sum -= row_of(calibration, j)[k] * solution[j];
        const bool is_zero =
            k > input && number_absolute(sum) <= state->least[k] * PZS_SQRT(squares);
        if (!(number_absolute(inverse[k]) > 0) && !is_zero)
            return (pzs_real)INFINITY;
        solution[k] = sum * inverse[k];
        squares += square(solution[k]);
    }
    return PZS_SQRT(squares);
}

pzs_status pzs_calibration_solve(pzs_calibration *calibration, pzs_real *influence,
                                 pzs_real *spread)
{
    const pzs_status status = check_ready(calibration, influence, spread);
    if (status != PZS_OK)
        return status;
    const pzs_calibration_state *state = &calibration->state;
    const size_t inputs = state->problem->inputs;
    pzs_real *inverse = state->proposal;
    const int32_t open = invert_pivots(calibration, inverse);
    for (size_t i = 0; i < state->problem->outputs; i++) {
        memmove(influence + i * inputs, state->influence + i * inputs, inputs * sizeof *influence);
        if (is_used(calibration, i))
            solve_row(calibration, i, inverse, influence + i * inputs);
    }
    for (size_t k = 0; k < inputs; k++)
        spread[k] = spread_of(calibration, k, inverse, state->direction);
    return finish(calibration, open < 0 ? PZS_OK : PZS_W_UNOBSERVABLE, open);
}
