/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The control loop: a list of blocks, all laid out in one workspace and run in the order of the
 * list.
 *
 * The workspace holds, each part aligned to 8 bytes: a pointer to each block, the voltages to give
 * out, the blocks.
 */
#include <string.h>
#include "pzs_loop.h"
#include "control.h"
#include "../core/guard.h"

#define READY 1u

static pzs_status finish(pzs_loop *loop, pzs_status status, const pzs_block_type *block,
                         int32_t where)
{
    loop->info.block = block;
    loop->info.where = where;
    return status;
}

/* ---- the list --------------------------------------------------------- */

static bool is_complete(const pzs_block *block)
{
    return block->type != NULL && block->tables != NULL && block->type->block_bytes != NULL &&
           block->type->block_init != NULL && block->type->block_tick != NULL;
}

/*
 * Whether a list cannot hold both blocks: two blocks of one type, two step blocks or two blocks
 * that make the measured shape.
 */
static bool excludes(const pzs_block_type *one, const pzs_block_type *other)
{
    const bool is_single = one->phase == PZS_PHASE_STEP || one->phase == PZS_PHASE_SHAPE;
    return one == other || (is_single && one->phase == other->phase);
}

/*
 * Check block k: whether it is complete, fits the blocks before it and stands in the order of
 * phases.
 */
static pzs_status check_block(const pzs_block *blocks, size_t k)
{
    if (!is_complete(&blocks[k]))
        return PZS_E_ARGUMENT;
    for (size_t i = 0; i < k; i++)
        if (excludes(blocks[i].type, blocks[k].type))
            return PZS_E_ARGUMENT;
    return k > 0 && blocks[k].type->phase < blocks[k - 1].type->phase ? PZS_E_STAGE : PZS_OK;
}

/* Index of the step block in a list, or `count` if the list has none. */
static size_t find_step(const pzs_block *blocks, size_t count)
{
    size_t k = 0;
    while (k < count && blocks[k].type->phase != PZS_PHASE_STEP)
        k++;
    return k;
}

static pzs_status check_list(pzs_loop *loop, const pzs_block *blocks, size_t count)
{
    for (size_t k = 0; k < count; k++) {
        const pzs_status status = check_block(blocks, k);
        if (status != PZS_OK)
            return finish(loop, status, blocks[k].type, (int32_t)k);
    }
    const bool has_step = find_step(blocks, count) < count;
    return has_step ? PZS_OK : finish(loop, PZS_E_ARGUMENT, NULL, (int32_t)count);
}

/* ---- layout ----------------------------------------------------------- */

static const pzs_problem *problem_of(const pzs_loop *loop)
{
    const size_t step = find_step(loop->state.blocks, loop->state.count);
    return loop->state.blocks[step].tables;
}

static size_t bytes_of(const pzs_loop *loop, size_t k)
{
    const pzs_block *block = &loop->state.blocks[k];
    return PZS_ALIGNED(block->type->block_bytes(block->tables, problem_of(loop)));
}

static size_t bytes_needed(const pzs_loop *loop)
{
    size_t need = PZS_LOOP_BYTES(loop->state.count, problem_of(loop)->inputs);
    for (size_t k = 0; k < loop->state.count; k++)
        need += bytes_of(loop, k);
    return need;
}

/* Place the pointers of the loop in the workspace, from its first multiple of 8 bytes on. */
static void lay_out(pzs_loop *loop, void *work)
{
    uint8_t *next = (uint8_t *)work + (8u - (uintptr_t)work % 8u) % 8u;
    loop->state.self = (void *)next;
    next += PZS_ALIGNED(loop->state.count * sizeof(void *));
    loop->state.voltage = (void *)next;
    next += PZS_ALIGNED(problem_of(loop)->inputs * sizeof(pzs_real));
    for (size_t k = 0; k < loop->state.count; k++) {
        loop->state.self[k] = next;
        next += bytes_of(loop, k);
    }
}

/* ---- init ------------------------------------------------------------- */

static pzs_status init_block(pzs_loop *loop, size_t k, pzs_loop_signals *signals)
{
    const pzs_block *block = &loop->state.blocks[k];
    signals->where = -1;
    const pzs_status status = block->type->block_init(loop->state.self[k], block->tables, signals);
    return status == PZS_OK ? PZS_OK : finish(loop, status, block->type, signals->where);
}

/*
 * Initialise all blocks but the step block, from the last to the first, because each block takes
 * the readings that the next one needs.
 */
static pzs_status init_others(pzs_loop *loop)
{
    pzs_loop_signals signals = {.control = loop->info.control,
                                .sensors = problem_of(loop)->outputs};
    const size_t step = find_step(loop->state.blocks, loop->state.count);
    for (size_t k = loop->state.count; k-- > 0;) {
        const pzs_status status = k == step ? PZS_OK : init_block(loop, k, &signals);
        if (status != PZS_OK)
            return status;
    }
    loop->state.sensors = signals.sensors;
    memcpy(loop->state.voltage, loop->info.control->info.voltage,
           problem_of(loop)->inputs * sizeof(pzs_real));
    loop->state.stage = READY;
    return finish(loop, PZS_OK, NULL, -1);
}

static pzs_status init_step(pzs_loop *loop, const pzs_real *influence)
{
    pzs_loop_signals signals = {.influence = influence};
    const size_t step = find_step(loop->state.blocks, loop->state.count);
    const pzs_status status = init_block(loop, step, &signals);
    if (status != PZS_OK)
        return status;
    loop->info.control = signals.control;
    return signals.control != NULL ? PZS_OK
                                   : finish(loop, PZS_E_STAGE, loop->state.blocks[step].type, -1);
}

pzs_status pzs_loop_init(pzs_loop *loop, const pzs_block *blocks, size_t count,
                         const pzs_real *influence, void *work, size_t bytes)
{
    if (loop == NULL)
        return PZS_E_ARGUMENT;
    memset(loop, 0, sizeof *loop);
    if (blocks == NULL || count == 0 || count > PZS_BLOCK_LIMIT || work == NULL)
        return finish(loop, PZS_E_ARGUMENT, NULL, -1);
    pzs_status status = check_list(loop, blocks, count);
    if (status != PZS_OK)
        return status;
    loop->state.blocks = blocks;
    loop->state.count = (uint8_t)count;
    const int32_t missing = guard_missing_bytes(work, bytes, bytes_needed(loop));
    if (missing >= 0)
        return finish(loop, PZS_E_WORKSPACE, NULL, missing);
    lay_out(loop, work);
    status = init_step(loop, influence);
    if (status != PZS_OK)
        return status;
    loop->info.voltage = loop->state.voltage;
    return init_others(loop);
}

pzs_status pzs_loop_start(pzs_loop *loop, const pzs_real *voltage)
{
    if (loop == NULL)
        return PZS_E_ARGUMENT;
    if (loop->state.stage != READY)
        return PZS_E_STAGE;
    if (voltage == NULL)
        return finish(loop, PZS_E_ARGUMENT, NULL, -1);
    const uint16_t inputs = problem_of(loop)->inputs;
    const int32_t bad = pzs_guard_nonfinite(voltage, inputs);
    if (bad >= 0)
        return finish(loop, PZS_E_NONFINITE, NULL, bad);
    for (uint16_t j = 0; j < inputs; j++) /* also those that a test signal holds */
        (void)pzs_release(loop->info.control, j);
    (void)pzs_control_start(loop->info.control, voltage);
    return init_others(loop);
}

/* ---- tick ------------------------------------------------------------- */

/*
 * After an error: return the controller to the voltages last given out, if a block may have changed
 * them.
 */
static pzs_status fail(pzs_loop *loop, pzs_status status, const pzs_block_type *block,
                       int32_t where)
{
    pzs_control *control = loop->info.control;
    if (block->phase >= PZS_PHASE_STEP) {
        memcpy(control->state.voltage, loop->state.voltage,
               control->state.problem->inputs * sizeof *control->state.voltage);
        pzs_control_moved(control);
    }
    return finish(loop, status, block, where);
}

/* Run all blocks. Returns the status that takes precedence, and stores its block and index. */
static pzs_status run(pzs_loop *loop, pzs_loop_signals *signals)
{
    pzs_status result = finish(loop, PZS_OK, NULL, -1);
    for (size_t k = 0; k < loop->state.count; k++) {
        const pzs_block_type *type = loop->state.blocks[k].type;
        signals->where = -1;
        const pzs_status status = type->block_tick(loop->state.self[k], signals);
        if (PZS_IS_ERROR(status))
            return fail(loop, status, type, signals->where);
        const bool takes_precedence = result == PZS_OK || type->phase == PZS_PHASE_STEP;
        if (status != PZS_OK && takes_precedence)
            result = finish(loop, status, type, signals->where);
    }
    return result;
}

pzs_status pzs_loop_tick(pzs_loop *loop, const pzs_real *wanted, const pzs_real *readings)
{
    if (loop == NULL || wanted == NULL)
        return PZS_E_ARGUMENT;
    if (loop->state.stage != READY)
        return PZS_E_STAGE;
    pzs_loop_signals signals = {.control = loop->info.control,
                                .wanted = wanted,
                                .readings = readings,
                                .measured = readings,
                                .known_now = loop->settings.known_now,
                                .known_next = loop->settings.known_next,
                                .sensors = loop->state.sensors};
    const pzs_status status = run(loop, &signals);
    loop->info.measured = signals.measured;
    loop->info.electrode = signals.electrode;
    if (PZS_IS_ERROR(status))
        return status;
    const pzs_control *control = loop->info.control;
    memcpy(loop->state.voltage, control->info.voltage,
           control->state.problem->inputs * sizeof *loop->state.voltage);
    return status;
}

void *pzs_loop_find(const pzs_loop *loop, const pzs_block_type *type)
{
    if (loop == NULL || loop->state.stage != READY)
        return NULL;
    for (size_t k = 0; k < loop->state.count; k++)
        if (loop->state.blocks[k].type == type)
            return loop->state.self[k];
    return NULL;
}
