/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Free functions of the target: shapes, such as a piston or a tilt, along which the structure may
 * move as it likes. The influence matrix of the controller lacks them, but the readings have them,
 * so that a healthy structure deviates from its prediction along free functions without any bound.
 * The block gives the blocks after it a function that removes the free functions from shapes: of a
 * shape x
 *
 *     x - F F'x, and 0 at outputs of weight 0
 *
 * is left, where the rows of `value` are F', F'F = 1. What is left of the difference of two shapes
 * does not depend on the free functions in either.
 */
#include <string.h>
#include "pzs_loop.h"
#include "scrub.h"
#include "../core/guard.h"
#include "../core/product.h"

/* List the arrays that the checksum of the tables covers. Returns their number. */
static uint32_t list_parts(const pzs_free_functions *tables, pzs_table_part part[PZS_TABLE_PARTS])
{
    part[0] = (pzs_table_part){&tables->outputs, 2u * sizeof tables->outputs};
    part[1] = scrub_reals(tables->value, (size_t)tables->count * tables->outputs);
    return 2;
}

static uint32_t crc_of(const pzs_free_functions *tables)
{
    pzs_table_part part[PZS_TABLE_PARTS];
    return pzs_scrub_crc(part, list_parts(tables, part));
}

pzs_status pzs_free_functions_seal(pzs_free_functions *tables)
{
    if (tables == NULL || tables->value == NULL || tables->outputs == 0 || tables->count == 0)
        return PZS_E_ARGUMENT;
    tables->format = PZS_TABLE_FORMAT;
    tables->crc = crc_of(tables);
    return PZS_OK;
}

static pzs_status check(const pzs_free_functions *tables, const pzs_problem *problem)
{
    if (tables->format != PZS_TABLE_FORMAT || tables->scene != problem->scene)
        return PZS_E_FORMAT;
    if (tables->value == NULL || tables->count == 0 || tables->outputs != problem->outputs)
        return PZS_E_ARGUMENT;
    if (crc_of(tables) != tables->crc)
        return PZS_E_CRC;
    const uint32_t entries = (uint32_t)tables->count * tables->outputs;
    return pzs_guard_nonfinite(tables->value, entries) < 0 ? PZS_OK : PZS_E_NONFINITE;
}

/* ---- shapes without free functions --------------------------------------- */

/*
 * Remove from a shape its components along the free functions, shapes that may be added to the
 * target at no cost (pzs_loop_signals.without_free).
 */
static const pzs_real *without_free(const pzs_loop_signals *signals, const pzs_real *shape,
                                    uint32_t place)
{
    pzs_free_functions_state *state = signals->free_functions;
    const pzs_free_functions *tables = state->tables;
    const uint32_t outputs = tables->outputs;
    const pzs_real *weight = signals->control->state.problem->weight;
    pzs_real *left = state->shape + place * (size_t)outputs;
    for (uint32_t k = 0; k < tables->count; k++)
        state->coordinate[k] = pzs_product_dot(tables->value + k * (size_t)outputs, shape, outputs);
    pzs_product_sum_rows(left, tables->value, outputs, state->coordinate, tables->count, outputs);
    for (uint32_t i = 0; i < outputs; i++)
        left[i] = weight[i] > 0 ? shape[i] - left[i] : 0;
    return left;
}

/* ---- block of the control loop ------------------------------------------- */

static size_t block_bytes(const void *tables, const pzs_problem *problem)
{
    const pzs_free_functions *functions = tables;
    return PZS_FREE_FUNCTIONS_BLOCK_BYTES(problem->outputs, functions->count);
}

/* Set the pointers of the block to its tables and to its arrays. */
static void place(pzs_free_functions_state *state, const pzs_free_functions *tables)
{
    state->tables = tables;
    state->coordinate = (void *)((uint8_t *)state + PZS_ALIGNED(sizeof *state));
    state->shape = state->coordinate + PZS_FOURS(tables->count);
}

static pzs_status block_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    const pzs_status status = check(tables, signals->control->state.problem);
    if (status != PZS_OK)
        return status;
    memset(self, 0, block_bytes(tables, signals->control->state.problem));
    place(self, tables);
    return PZS_OK;
}

static pzs_status block_tick(void *self, pzs_loop_signals *signals)
{
    place(self, signals->tables);
    signals->free_functions = self;
    signals->without_free = without_free;
    return PZS_OK;
}

static uint32_t block_parts(const void *tables, uint32_t number,
                            pzs_table_part part[PZS_TABLE_PARTS], uint32_t *crc)
{
    const pzs_free_functions *table = tables;
    *crc = table->crc;
    return number == 0 ? list_parts(table, part) : 0;
}

const pzs_block_type pzs_free_functions_block = {"free_functions", PZS_PHASE_READINGS, block_bytes,
                                                 block_init,       block_tick,         block_parts};
