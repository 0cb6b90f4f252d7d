/*
 * The shape, or the readings, that known loads make: y = K a, subtracted before the controller sees
 * it. Work of a tick: (sensors + outputs) loads multiply-adds.
 */
#include <string.h>
#include "estimate.h"
#include "control.h"
#include "../core/guard.h"

uint32_t pzs_estimate_known_crc(const pzs_feed_forward_table *table)
{
    const uint16_t counts[2] = {table->inputs, table->outputs};
    const uint32_t crc = pzs_guard_crc(GUARD_CRC_START, counts, sizeof counts);
    return ~pzs_guard_crc(crc, table->sensitivity,
                          (size_t)table->outputs * table->inputs * sizeof(pzs_real));
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

pzs_status pzs_feed_forward(const pzs_feed_forward_table *table, const pzs_real *amount,
                            pzs_real *shape)
{
    if (table == NULL || amount == NULL || shape == NULL)
        return PZS_E_ARGUMENT;
    if (pzs_guard_nonfinite(amount, table->inputs) >= 0)
        return PZS_E_NONFINITE;
    for (uint32_t i = 0; i < table->outputs; i++) {
        const pzs_real *row = table->sensitivity + (size_t)i * table->inputs;
        for (uint32_t k = 0; k < table->inputs; k++)
            shape[i] -= row[k] * amount[k];
    }
    return PZS_OK;
}

/* ---- block ------------------------------------------------------------ */

/* The table for the readings: that of the shape where the readings are the shape. */
static const pzs_feed_forward_table *of_readings(const pzs_known_loads *t)
{
    return t->readings != NULL ? t->readings : t->shape;
}

static size_t block_bytes(const void *tables, const pzs_problem *problem)
{
    const pzs_feed_forward_table *readings = of_readings(tables);
    const uint16_t sensors = readings != NULL ? readings->outputs : 0;
    return PZS_FEED_FORWARD_BLOCK_BYTES(sensors, problem->outputs);
}

/* A table that is valid, of this scene, with so many rows. */
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

static pzs_status block_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    const pzs_known_loads *t = tables;
    const pzs_problem *problem = signals->control->state.problem;
    pzs_feed_forward_state *f = self;
    pzs_status status = check(t->shape, problem, problem->outputs);
    if (status == PZS_OK)
        status = check(of_readings(t), problem, signals->sensors);
    if (status != PZS_OK)
        return status;
    if (of_readings(t)->inputs != t->shape->inputs)
        return PZS_E_ARGUMENT;
    f->tables = t;
    f->readings = (void *)((uint8_t *)self + PZS_ALIGNED(sizeof *f));
    f->wanted = f->readings + signals->sensors;
    return PZS_OK;
}

/* Make *signal a copy of itself, in `room`, without the loads of values `known`. */
static pzs_status take_out(const pzs_feed_forward_table *table, const pzs_real *known,
                           const pzs_real **signal, pzs_real *room)
{
    if (known == NULL || *signal == NULL)
        return PZS_OK;
    memcpy(room, *signal, table->outputs * sizeof *room);
    *signal = room;
    return pzs_feed_forward(table, known, room);
}

/* Index of the first known value that is not finite, or -1. */
static int32_t bad_value(const pzs_loop_signals *signals, uint32_t loads)
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
    pzs_feed_forward_state *f = self;
    signals->where = bad_value(signals, f->tables->shape->inputs);
    if (signals->where >= 0)
        return PZS_E_NONFINITE;
    (void)take_out(of_readings(f->tables), signals->known_now, &signals->readings, f->readings);
    (void)take_out(f->tables->shape, signals->known_next, &signals->wanted, f->wanted);
    signals->measured = signals->readings;
    return PZS_OK;
}

const pzs_block_type pzs_feed_forward_block = {"feed_forward", PZS_PHASE_READINGS, block_bytes,
                                               block_init, block_tick};
