/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Correction of late sensor readings, a stage of the control tick for a loop without vibration
 * damper. To readings taken `delay` ticks ago it adds the change that the model predicts from the
 * voltage changes since then. Without this, the controller would compensate a deviation several
 * times and oscillate.
 *
 *   - The voltage of an electrode found faulty counts as unchanged.
 *   - Work of a tick: sensors * inputs multiply-adds, and `delay` times as many after missed ticks.
 */
#include <string.h>
#include "control.h"
#include "effect_range.h"
#include "estimate.h"
#include "scrub.h"
#include "../core/guard.h"
#include "../core/numbers.h"
#include "../core/product.h"
#include "sensor_check.h"

/* List the arrays that the checksum of the tables of late readings covers. Returns their number. */
static uint32_t list_parts(const pzs_reading_delay *tables, pzs_table_part part[PZS_TABLE_PARTS])
{
    part[0] = (pzs_table_part){&tables->inputs, 3u * sizeof tables->inputs};
    part[1] = scrub_reals(tables->direct, (size_t)tables->sensors * tables->inputs);
    return 2;
}

static uint32_t checksum(const pzs_reading_delay *tables)
{
    pzs_table_part part[PZS_TABLE_PARTS];
    return pzs_scrub_crc(part, list_parts(tables, part));
}

pzs_status pzs_reading_delay_seal(pzs_reading_delay *tables)
{
    if (tables == NULL || tables->inputs == 0 || tables->sensors == 0)
        return PZS_E_ARGUMENT;
    tables->format = PZS_TABLE_FORMAT;
    tables->crc = checksum(tables);
    return PZS_OK;
}

static pzs_status check(const pzs_reading_delay *tables, const pzs_problem *problem,
                        uint16_t sensors)
{
    if (tables->format != PZS_TABLE_FORMAT || tables->scene != problem->scene)
        return PZS_E_FORMAT;
    const bool fits = tables->inputs == problem->inputs && tables->sensors == sensors &&
                      tables->delay <= PZS_DELAY_LIMIT;
    if (!fits || (tables->direct == NULL && sensors != problem->outputs))
        return PZS_E_ARGUMENT;
    if (checksum(tables) != tables->crc)
        return PZS_E_CRC;
    const uint32_t count = (uint32_t)tables->sensors * tables->inputs;
    const bool is_finite = tables->direct == NULL || pzs_guard_nonfinite(tables->direct, count) < 0;
    return is_finite ? PZS_OK : PZS_E_NONFINITE;
}

/* ---- ring buffer of the voltages of the last ticks ------------------- */

/*
 * Set the pointers of the correction of late readings to its tables, the controller and its arrays.
 */
static void place(pzs_reading_delay_state *state, const pzs_reading_delay *tables,
                  pzs_control *control)
{
    const size_t rows = tables->delay + 1u, sensors = tables->sensors;
    state->tables = tables;
    state->control = control;
    state->voltage = (void *)((uint8_t *)state + PZS_ALIGNED(sizeof *state));
    state->expected = state->voltage + rows * tables->inputs;
    state->sensed = state->expected + rows * sensors;
    state->difference = state->sensed + sensors;
    state->corrected = state->difference + sensors;
    state->repeats = (uint8_t *)(state->corrected + sensors);
    state->newest = (uint16_t)(state->newest % rows);
}

/*
 * Return the matrix [sensors][inputs] with which the model predicts readings: change of each
 * reading per volt on each input.
 */
static const pzs_real *direct_of(const pzs_reading_delay_state *state)
{
    return state->tables->direct != NULL ? state->tables->direct : state->control->state.influence;
}

/*
 * Store the voltages of a tick, and the readings that the model predicts for them, each as the
 * newest row of a ring buffer of the last delay + 1 ticks (delay: age of the readings in ticks).
 *   voltage [inputs] in  voltages (V); in a loop with actuator curves their effects, values to
 *                        which the displacements of the actuators are proportional
 */
static void push_voltages(pzs_reading_delay_state *state, const pzs_real *voltage)
{
    const size_t inputs = state->tables->inputs, sensors = state->tables->sensors;
    state->newest = (uint16_t)((state->newest + 1u) % (state->tables->delay + 1u));
    memcpy(state->voltage + state->newest * inputs, voltage, inputs * sizeof *state->voltage);
    pzs_product_matrix(state->expected + state->newest * sensors, direct_of(state), voltage,
                       sensors, inputs);
}

/*
 * Return the index of the oldest row in the ring buffer of the voltages of the last delay + 1
 * ticks. This row belongs to the time at which the present readings were taken.
 */
static size_t oldest_row(const pzs_reading_delay_state *state)
{
    return (state->newest + 1u) % (state->tables->delay + 1u);
}

/* ---- correction of the readings -------------------------------------- */

/*
 * Whether the fault detector has found the electrode of an input faulty and keeps its voltage
 * fixed.
 */
static bool is_faulty(const pzs_control *control, size_t input)
{
    return control->state.faulty[input] != 0 && number_is_finite(control->state.held[0][input]);
}

/*
 * Correct the readings for faulty electrodes. Since the readings were taken, the commanded voltages
 * of these electrodes may have changed, but the electrodes have not followed. The changes of the
 * readings that the model predicts for these voltage changes are subtracted from the readings.
 */
static void undo_faulty(pzs_reading_delay_state *state)
{
    const size_t inputs = state->tables->inputs;
    const pzs_real *direct = direct_of(state);
    const pzs_real *now = state->control->state.voltage;
    const pzs_real *then = state->voltage + oldest_row(state) * inputs;
    for (size_t j = 0; j < inputs; j++) {
        if (!is_faulty(state->control, j))
            continue;
        const pzs_real moved = now[j] - then[j];
        const pzs_real *effect = direct + j;
        pzs_real *corrected = state->corrected, *const end = corrected + state->tables->sensors;
        for (; corrected < end; corrected++) {
            *corrected -= *effect * moved;
            effect += inputs;
        }
    }
}

/*
 * Correct all readings for the voltage changes since they were taken. Each reading is first
 * compared with that which the model predicts for the time at which it was taken; a missing or
 * stuck reading becomes NaN.
 */
static void correct(pzs_reading_delay_state *state, const pzs_real *readings)
{
    const size_t sensors = state->tables->sensors;
    const pzs_real *now = state->expected + state->newest * sensors;
    const pzs_real *then = state->expected + oldest_row(state) * sensors;
    const sensor_check all = {(uint32_t)sensors, then, state->sensed, state->difference,
                              state->repeats};
    int32_t where;
    bool is_repeated = true;
    (void)pzs_sensor_check(&all, readings, &where, &is_repeated);
    for (size_t i = 0; i < sensors; i++)
        state->corrected[i] = sensor_is_unusable(state->repeats[i])
                                  ? (pzs_real)NAN
                                  : readings[i] + (now[i] - then[i]);
    undo_faulty(state);
}

/* ---- block of the control loop --------------------------------------- */

static size_t block_bytes(const void *tables, const pzs_problem *problem)
{
    const pzs_reading_delay *delay = tables;
    return PZS_READING_DELAY_BLOCK_BYTES(problem->inputs, delay->sensors, delay->delay);
}

static pzs_status block_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    const pzs_reading_delay *delay = tables;
    const pzs_problem *problem = signals->control->state.problem;
    pzs_reading_delay_state *state = self;
    const pzs_status status = check(delay, problem, signals->sensors);
    if (status != PZS_OK)
        return status;
    if (delay->direct == NULL && signals->control->state.influence == NULL)
        return PZS_E_ARGUMENT; /* Without a table of readings per volt in its own tables, the block
                                  that corrects late readings reads the full influence matrix. It is
                                  therefore refused if the controller has a sparse one. */
    memset(state, 0, block_bytes(tables, problem));
    place(state, delay, signals->control);
    const pzs_real *effect = effect_of_voltages(signals);
    for (uint32_t i = 0; i <= delay->delay; i++)
        push_voltages(state, effect);
    return PZS_OK;
}

static pzs_status block_tick(void *self, pzs_loop_signals *signals)
{
    pzs_reading_delay_state *state = self;
    const pzs_reading_delay *tables = signals->tables;
    place(state, tables, signals->control);
    const uint32_t missed = signals->missed < tables->delay ? signals->missed : tables->delay;
    for (uint32_t i = 0; i <= missed; i++)
        push_voltages(state, signals->control->state.voltage);
    if (signals->readings == NULL)
        return PZS_OK;
    correct(state, signals->readings);
    signals->readings = signals->measured = state->corrected;
    return PZS_OK;
}

static uint32_t block_parts(const void *tables, uint32_t number,
                            pzs_table_part part[PZS_TABLE_PARTS], uint32_t *crc)
{
    const pzs_reading_delay *table = tables;
    *crc = table->crc;
    return number == 0 ? list_parts(table, part) : 0;
}

const pzs_block_type pzs_reading_delay_block = {"reading_delay", PZS_PHASE_READINGS, block_bytes,
                                                block_init,      block_tick,         block_parts};
