/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Feed-forward of known loads: the effect of known loads on the shape and on the sensor readings is
 * subtracted from target shape and readings before the controller uses them. The work of a tick is
 * (sensors + outputs) times loads multiply-adds.
 */
#include <string.h>
#include "estimate.h"
#include "control.h"
#include "scrub.h"
#include "../core/guard.h"

/* List the arrays that the checksum of a feed-forward table covers. Returns their number. */
static uint32_t list_parts(const pzs_feed_forward_table *table,
                           pzs_table_part part[PZS_TABLE_PARTS])
{
    part[0] = (pzs_table_part){&table->inputs, 2u * sizeof table->inputs};
    part[1] = scrub_reals(table->sensitivity, (size_t)table->outputs * table->inputs);
    return 2;
}

uint32_t pzs_estimate_known_crc(const pzs_feed_forward_table *table)
{
    pzs_table_part part[PZS_TABLE_PARTS];
    return pzs_scrub_crc(part, list_parts(table, part));
}

pzs_status pzs_feed_forward_seal(pzs_feed_forward_table *table)
{
    if (table == NULL || table->sensitivity == NULL)
        return PZS_E_ARGUMENT;
    table->format = PZS_TABLE_FORMAT;
    table->crc = pzs_estimate_known_crc(table);
    return PZS_OK;
}

pzs_status pzs_feed_forward_check(const pzs_feed_forward_table *table)
{
    if (table == NULL || table->sensitivity == NULL || table->inputs == 0 || table->outputs == 0)
        return PZS_E_ARGUMENT;
    if (table->format != PZS_TABLE_FORMAT)
        return PZS_E_FORMAT;
    if (pzs_estimate_known_crc(table) != table->crc)
        return PZS_E_CRC;
    return pzs_guard_nonfinite(table->sensitivity, (uint32_t)table->outputs * table->inputs) < 0
               ? PZS_OK
               : PZS_E_NONFINITE;
}

pzs_status pzs_feed_forward(const pzs_feed_forward_table *table, const pzs_real *value,
                            pzs_real *shape)
{
    if (table == NULL || value == NULL || shape == NULL)
        return PZS_E_ARGUMENT;
    if (pzs_guard_nonfinite(value, table->inputs) >= 0)
        return PZS_E_NONFINITE;
    for (uint32_t i = 0; i < table->outputs; i++) {
        const pzs_real *row = table->sensitivity + (size_t)i * table->inputs;
        for (uint32_t k = 0; k < table->inputs; k++)
            shape[i] -= row[k] * value[k];
    }
    return PZS_OK;
}

/* ---- block of the control loop --------------------------------------- */

/*
 * Return the feed-forward table for the sensor readings: the change of each reading per unit of
 * each known load. If the readings are the measured shape itself, it is the table for the shape.
 */
static const pzs_feed_forward_table *readings_table(const pzs_known_loads *loads)
{
    return loads->readings != NULL ? loads->readings : loads->shape;
}

static size_t block_bytes(const void *tables, const pzs_problem *problem)
{
    const pzs_feed_forward_table *readings = readings_table(tables);
    const uint16_t sensors = readings != NULL ? readings->outputs : 0;
    return PZS_FEED_FORWARD_BLOCK_BYTES(sensors, problem->outputs);
}

/*
 * Check that a feed-forward table (effects of known loads) is valid, was generated from the same
 * scene file as the controller's tables, and has `rows` rows, one for each output or sensor.
 */
static pzs_status check(const pzs_feed_forward_table *table, const pzs_problem *problem,
                        uint16_t rows)
{
    const pzs_status status = pzs_feed_forward_check(table);
    if (status != PZS_OK)
        return status;
    if (table->scene != problem->scene)
        return PZS_E_FORMAT;
    return table->outputs == rows ? PZS_OK : PZS_E_ARGUMENT;
}

/*
 * Set the pointers of the feed-forward of known loads to its tables and to its arrays for corrected
 * readings and target shape.
 */
static void place(pzs_feed_forward_state *state, const pzs_known_loads *loads)
{
    state->tables = loads;
    state->readings = (void *)((uint8_t *)state + PZS_ALIGNED(sizeof *state));
    state->wanted = state->readings + readings_table(loads)->outputs;
}

static pzs_status block_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    const pzs_known_loads *loads = tables;
    const pzs_problem *problem = signals->control->state.problem;
    pzs_feed_forward_state *state = self;
    pzs_status status = check(loads->shape, problem, problem->outputs);
    if (status == PZS_OK)
        status = check(readings_table(loads), problem, signals->sensors);
    if (status != PZS_OK)
        return status;
    if (readings_table(loads)->inputs != loads->shape->inputs)
        return PZS_E_ARGUMENT;
    place(state, loads);
    return PZS_OK;
}

/*
 * Write a signal, readings or target shape, minus the effect of the known loads to `copy`, and let
 * *signal point to this array.
 */
static pzs_status subtract_known(const pzs_feed_forward_table *table, const pzs_real *known,
                                 const pzs_real **signal, pzs_real *copy)
{
    if (known == NULL || *signal == NULL)
        return PZS_OK;
    memcpy(copy, *signal, table->outputs * sizeof *copy);
    *signal = copy;
    return pzs_feed_forward(table, known, copy);
}

/* Return the index of the first value of a known load that is not finite, or -1. */
static int32_t find_nonfinite_value(const pzs_loop_signals *signals, uint32_t loads)
{
    int32_t bad = -1;
    if (signals->known_now != NULL)
        bad = pzs_guard_nonfinite(signals->known_now, loads);
    if (bad < 0 && signals->known_next != NULL)
        bad = pzs_guard_nonfinite(signals->known_next, loads);
    return bad;
}

static pzs_status block_tick(void *self, pzs_loop_signals *signals)
{
    pzs_feed_forward_state *state = self;
    place(state, signals->tables);
    signals->where = find_nonfinite_value(signals, state->tables->shape->inputs);
    if (signals->where >= 0)
        return PZS_E_NONFINITE;
    (void)subtract_known(readings_table(state->tables), signals->known_now, &signals->readings,
                         state->readings);
    (void)subtract_known(state->tables->shape, signals->known_next, &signals->wanted,
                         state->wanted);
    signals->measured = signals->readings;
    return PZS_OK;
}

/*
 * List the array that the checksum of a feed-forward table covers. Table 0 holds the effect of
 * known loads on the shape, table 1 the effect on the sensor readings if these are not the shape
 * itself. Returns the number of arrays; 0 if there is no such table.
 */
static uint32_t block_parts(const void *tables, uint32_t number,
                            pzs_table_part part[PZS_TABLE_PARTS], uint32_t *crc)
{
    const pzs_known_loads *loads = tables;
    const pzs_feed_forward_table *table = number == 0 ? loads->shape : loads->readings;
    if (number > 1 || table == NULL)
        return 0;
    *crc = table->crc;
    return list_parts(table, part);
}

const pzs_block_type pzs_feed_forward_block = {"feed_forward", PZS_PHASE_READINGS, block_bytes,
                                               block_init,     block_tick,         block_parts};
