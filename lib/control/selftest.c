/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Self-test of amplifiers, cables and sensors before the loop controls the voltages (pzs_loop.h).
 * test_pulse.h has the shape of the pulses and the weights of the readings, selftest_evaluation.c
 * the evaluation.
 *
 *   - The amplifiers are moved one after the other: the response to a single electrode can be
 *     recognised even if gains, natural frequencies and hysteresis differ much from the model.
 *   - Before these pulses of single amplifiers, all amplifiers make one slow pulse together. It
 *     brings the ceramic of every electrode into the minor hysteresis loop of the later pulses, so
 *     that the gains of the electrodes can be compared.
 */
#include <string.h>
#include "pzs_loop.h"
#include "control.h"
#include "scrub.h"
#include "selftest.h"
#include "test_pulse.h"
#include "../core/guard.h"
#include "../core/numbers.h"

/*
 * A sensor reading whose absolute value exceeds this limit counts as missing, so that no sum of
 * squares overflows.
 */
#define READING_LIMIT PZS_R(1e12)
/*
 * CONDITIONING_WINDOWS: number of pulse durations at the start of the self-test in which all
 * amplifiers move together. WINDOWS_BEFORE: number of pulse durations before the first pulse of a
 * single amplifier; in the last of these durations no amplifier moves.
 */
#define CONDITIONING_WINDOWS 2u
#define WINDOWS_BEFORE 3u

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
    /*
     * The self-test is refused where actuators have curves: it compares its pulses with the
     * response to voltages, not to the effects to which the displacements are proportional.
     */
    if (signals->curves != NULL)
        return PZS_E_STAGE;
    const bool has_sizes =
        tables->inputs == problem->inputs && tables->sensors == signals->sensors &&
        (tables->direct != NULL ||
         (tables->sensors == problem->outputs && signals->control->state.influence != NULL));
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
    const uint32_t position = core->position < all ? core->position : all - 1u;
    const bool is_running = core->verdict == PZS_SELFTEST_RUNNING;
    selftest->info.verdict = (pzs_selftest_verdict)core->verdict;
    selftest->info.remaining = is_running ? all - position : 0;
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

bool pzs_selftest_moves(const pzs_selftest *selftest, uint32_t j)
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
        if ((is_for_all || window == j + WINDOWS_BEFORE) && pzs_selftest_moves(selftest, j))
            voltage += height_of(selftest, j) * pulse;
        control->voltage[j] = number_clamp(voltage, control->lower[j], control->upper[j]);
    }
    pzs_control_moved(selftest->state.control);
}

/* ---- sensor readings ---------------------------------------------------- */

/*
 * Add a reading of sensor i to the two weighted sums of its readings during a test pulse. A missing
 * reading is replaced by the last one.
 *   even, odd in  weights of the reading in the two sums (dimensionless): `even` is symmetric,
 *                 `odd` antisymmetric in time about the middle of the pulse
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
 * noise and vibration.
 */
static void end_window(pzs_selftest *selftest, uint32_t window)
{
    pzs_selftest_state *state = &selftest->state;
    const uint32_t inputs = state->tables->inputs, sensors = state->tables->sensors;
    const bool has_pulse = window >= WINDOWS_BEFORE && window - WINDOWS_BEFORE < inputs;
    const uint32_t j = has_pulse ? window - WINDOWS_BEFORE : 0;
    const pzs_real height =
        has_pulse && pzs_selftest_moves(selftest, j) ? height_of(selftest, j) : 1;
    for (uint32_t i = 0; i < sensors; i++) {
        const pzs_real response = state->even[i] / (state->pulse * height);
        const pzs_real energy = square(response) + square(state->odd[i] / state->pulse);
        if (has_pulse)
            state->response[(size_t)j * sensors + i] = state->tables->scale[i] * response;
        else if (window >= CONDITIONING_WINDOWS && !(energy <= state->null[i]))
            state->null[i] = energy;
        state->even[i] = 0;
        state->odd[i] = 0;
        // The variance of the noise is measured only after the last pulse, because high modes may
        // still vibrate at the beginning.
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
     * The self-test is refused where weighted sums of voltages are limited, because a test pulse of
     * a single input could violate such a limit.
     */
    if (signals->control->state.problem->limit_rows != NULL)
        return PZS_E_ARGUMENT;
    memset(selftest, 0, sizeof *selftest);
    selftest->settings.work_limit = PZS_SELFTEST_WORK;
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
        pzs_selftest_evaluate(selftest);
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
