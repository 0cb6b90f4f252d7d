/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The control loop: a list of blocks, which are the stages of a control tick. Every tick runs them
 * in the order of the list, followed by a last check of all voltages. Parts of the workspace:
 *   - two arrays of output voltages that are used in turn;
 *   - three copies of the voltages of the last tick;
 *   - the memory of the blocks.
 */
#include <string.h>
#include "pzs_loop.h"
#include "control.h"
#include "output_gate.h"
#include "problem.h"
#include "scrub.h"
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
 * Whether two blocks (stages of a control tick) must not be in the same loop, because they are of
 * the same type, or of a phase of the tick in which a loop may have one block only.
 */
static bool excludes(const pzs_block_type *one, const pzs_block_type *other)
{
    const bool is_single = one->phase == PZS_PHASE_COMMISSION || one->phase == PZS_PHASE_STEP ||
                           one->phase == PZS_PHASE_SHAPE || one->phase == PZS_PHASE_SUPERVISE;
    return one == other || (is_single && one->phase == other->phase);
}

/*
 * Check block k (a stage of the control tick) in the list of a loop: the block must be complete,
 * must be allowed together with the blocks before it, and must follow them in the order of the
 * phases of a tick.
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

/*
 * Return the index of pzs_step_block, the stage of the control tick that computes the voltages, in
 * a list of `count` blocks, or `count` if the list has none.
 */
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

/*
 * Return that part of the state of a control loop which stays constant from tick to tick (pointers
 * and sizes), after a majority vote over its three copies, which protect it against damaged memory.
 */
static pzs_loop_core *voted_core(pzs_loop *loop)
{
    pzs_loop_core *core = loop->state.core;
    pzs_guard_vote(&core[0], &core[1], &core[2], sizeof core[0]);
    return core;
}

/*
 * Make the second and third copy of the pointers and sizes of a control loop, which protect them
 * against damaged memory, equal to the first one, which was changed.
 */
static void copy_core(pzs_loop *loop)
{
    loop->state.core[1] = loop->state.core[0];
    loop->state.core[2] = loop->state.core[0];
}

static const pzs_problem *problem_of(const pzs_loop_core *core)
{
    return core->blocks[find_step(core->blocks, core->count)].tables;
}

static size_t bytes_of(const pzs_block *block, const pzs_problem *problem)
{
    return PZS_ALIGNED(block->type->block_bytes(block->tables, problem));
}

/*
 * Return the address of the memory that block k (a stage of the control tick) has in the workspace
 * of the loop.
 */
static void *memory_of(const pzs_loop_core *core, const pzs_problem *problem, size_t k)
{
    uint8_t *memory = core->memory + PZS_LOOP_BYTES(core->count, problem->inputs) -
                      PZS_LOOP_BYTES(core->count, 0);
    for (size_t i = 0; i < k; i++)
        memory += bytes_of(&core->blocks[i], problem);
    return memory;
}

static size_t bytes_needed(const pzs_loop_core *core)
{
    const pzs_problem *problem = problem_of(core);
    size_t need = PZS_LOOP_BYTES(core->count, problem->inputs);
    for (size_t k = 0; k < core->count; k++)
        need += bytes_of(&core->blocks[k], problem);
    return need;
}

/*
 * Return the address of output array 0 or 1. The loop writes its voltages to two arrays in turn, so
 * that the program can read one array while the loop fills the other.
 */
static pzs_real *frame_of(const pzs_loop_core *core, const pzs_problem *problem, uint32_t number)
{
    return (pzs_real *)(void *)core->memory + (number & 1u) * (size_t)problem->inputs;
}

/*
 * Return the data of the output gate, which checks the voltages before they go to the amplifiers,
 * and the array in which the gate stores the checked voltages.
 */
static output_gate gate_of(const pzs_loop *loop, const pzs_loop_core *core)
{
    const pzs_problem *problem = problem_of(core);
    output_gate gate = {.problem = problem,
                        .held = core->control->state.held,
                        .frame = frame_of(core, problem, loop->info.frames + 1u)};
    for (uint32_t copy = 0; copy < 3; copy++)
        gate.last[copy] = frame_of(core, problem, 0) + (2u + copy) * (size_t)problem->inputs;
    return gate;
}

/*
 * Make the output array that has just been filled with voltages the one that the program reads for
 * its amplifiers (pzs_loop.info.voltage).
 */
static void publish(pzs_loop *loop, const pzs_loop_core *core)
{
    const uint32_t frames = loop->info.frames + 1u;
    loop->info.voltage = frame_of(core, problem_of(core), frames);
    loop->info.frames = frames;
}

/* ---- init ------------------------------------------------------------- */

static pzs_status init_block(pzs_loop *loop, size_t k, pzs_loop_signals *signals)
{
    const pzs_loop_core *core = loop->state.core;
    const pzs_block *block = &core->blocks[k];
    signals->where = -1;
    signals->tables = block->tables;
    const pzs_status status =
        block->type->block_init(memory_of(core, problem_of(core), k), block->tables, signals);
    return status == PZS_OK ? PZS_OK : finish(loop, status, block->type, signals->where);
}

/*
 * Store the voltages of the controller as the voltages of the last tick, from which the next step
 * limits count, and in the output array that the program reads.
 */
static void start_gate(pzs_loop *loop)
{
    const pzs_loop_core *core = loop->state.core;
    const output_gate gate = gate_of(loop, core);
    for (uint32_t i = 0; i < gate.problem->inputs; i++) {
        gate.frame[i] = core->control->state.voltage[i];
        for (int copy = 0; copy < 3; copy++)
            gate.last[copy][i] = core->control->state.voltage[i];
    }
    publish(loop, core);
}

/*
 * Initialise one of two groups of blocks, from the last of the list to the first: the fault
 * detectors (PZS_PHASE_OBSERVE), or all other blocks (stages of the control tick) except the
 * control step (pzs_step_block).
 *   observes in  true: the fault detectors; false: the others
 */
static pzs_status init_phases(pzs_loop *loop, pzs_loop_signals *signals, bool observes)
{
    const pzs_loop_core *core = loop->state.core;
    const size_t step = find_step(core->blocks, core->count);
    for (size_t k = core->count; k-- > 0;) {
        const bool is_observer = core->blocks[k].type->phase == PZS_PHASE_OBSERVE;
        const bool is_left_out = k == step || is_observer != observes;
        const pzs_status status = is_left_out ? PZS_OK : init_block(loop, k, signals);
        if (status != PZS_OK)
            return status;
    }
    return PZS_OK;
}

/* Initialise all blocks (stages of the control tick) except the control step (pzs_step_block). */
static pzs_status init_others(pzs_loop *loop)
{
    pzs_loop_core *core = loop->state.core;
    pzs_loop_signals signals = {.control = core->control, .sensors = problem_of(core)->outputs};
    // Blocks are initialised from the last to the first, because a block needs the number of
    // readings of the next one. Fault detectors need the number of readings of the whole loop and
    // are therefore initialised last.
    pzs_status status = init_phases(loop, &signals, false);
    if (status == PZS_OK)
        status = init_phases(loop, &signals, true);
    if (status != PZS_OK)
        return status;
    core->sensors = signals.sensors;
    core->stage = READY;
    copy_core(loop);
    start_gate(loop);
    return finish(loop, PZS_OK, NULL, -1);
}

/*
 * Return the checksum of the influence matrix that the device has computed, or 0 if the loop uses
 * the influence matrix of the controller's tables.
 */
static uint32_t device_influence_crc(const pzs_loop_core *core)
{
    const pzs_problem *problem = problem_of(core);
    const size_t count = (size_t)problem->inputs * problem->outputs;
    if (core->influence == NULL)
        return 0;
    return ~pzs_guard_array_crc(GUARD_CRC_START, core->influence, count, sizeof(pzs_real));
}

static pzs_status init_step(pzs_loop *loop, const pzs_real *influence)
{
    pzs_loop_core *core = loop->state.core;
    pzs_loop_signals signals = {.influence = influence};
    const size_t step = find_step(core->blocks, core->count);
    const pzs_status status = init_block(loop, step, &signals);
    if (status != PZS_OK)
        return status;
    if (signals.control == NULL)
        return finish(loop, PZS_E_STAGE, core->blocks[step].type, -1);
    core->control = signals.control;
    core->control_work = signals.control->state.work;
    core->influence = influence;
    core->influence_crc = device_influence_crc(core);
    core->limit_sum = pzs_output_limit_sum(problem_of(core));
    loop->info.control = core->control;
    return PZS_OK;
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
    pzs_loop_core *core = loop->state.core;
    core->blocks = blocks;
    core->count = (uint8_t)count;
    const int32_t missing = guard_missing_bytes(work, bytes, bytes_needed(core));
    if (missing >= 0)
        return finish(loop, PZS_E_WORKSPACE, NULL, missing);
    core->memory = (uint8_t *)work + (8u - (uintptr_t)work % 8u) % 8u;
    status = init_step(loop, influence);
    return status == PZS_OK ? init_others(loop) : status;
}

pzs_status pzs_loop_start(pzs_loop *loop, const pzs_real *voltage)
{
    if (loop == NULL)
        return PZS_E_ARGUMENT;
    const pzs_loop_core *core = voted_core(loop);
    if (core->stage != READY)
        return PZS_E_STAGE;
    if (voltage == NULL)
        return finish(loop, PZS_E_ARGUMENT, NULL, -1);
    const uint16_t inputs = problem_of(core)->inputs;
    const int32_t bad = pzs_guard_nonfinite(voltage, inputs);
    if (bad >= 0)
        return finish(loop, PZS_E_NONFINITE, NULL, bad);
    /*
     * Every input that pzs_hold keeps at a fixed voltage is released, also one to which the fault
     * detector applies a test signal.
     */
    for (uint16_t j = 0; j < inputs; j++)
        (void)pzs_release(core->control, j);
    (void)pzs_control_start(core->control, voltage);
    loop->state.missed = 0;
    return init_others(loop);
}

pzs_status pzs_loop_know(pzs_loop *loop, const pzs_real *now, const pzs_real *next)
{
    if (loop == NULL)
        return PZS_E_ARGUMENT;
    pzs_loop_core *core = voted_core(loop);
    if (core->stage != READY)
        return PZS_E_STAGE;
    core->known_now = now;
    core->known_next = next;
    copy_core(loop);
    return PZS_OK;
}

pzs_status pzs_loop_skip(pzs_loop *loop, uint32_t ticks)
{
    if (loop == NULL)
        return PZS_E_ARGUMENT;
    if (voted_core(loop)->stage != READY)
        return PZS_E_STAGE;
    const uint32_t room = PZS_MISSED_LIMIT - loop->state.missed % (PZS_MISSED_LIMIT + 1u);
    loop->state.missed = ticks < room ? PZS_MISSED_LIMIT - room + ticks : PZS_MISSED_LIMIT;
    return PZS_OK;
}

/* ---- tick ------------------------------------------------------------- */

/*
 * Return the voltages of the last tick [inputs], after a majority vote over their three copies (V).
 */
static const pzs_real *voted_voltages(const pzs_loop *loop, const pzs_loop_core *core)
{
    const output_gate gate = gate_of(loop, core);
    pzs_guard_vote(gate.last[0], gate.last[1], gate.last[2],
                   gate.problem->inputs * sizeof(pzs_real));
    return gate.last[0];
}

/*
 * Set the present voltages of the controller to the voltages of the last tick, and return the
 * latter [inputs].
 */
static const pzs_real *restore_given(const pzs_loop *loop, const pzs_loop_core *core)
{
    const pzs_real *given = voted_voltages(loop, core);
    memcpy(core->control->state.voltage, given, problem_of(core)->inputs * sizeof *given);
    return given;
}

/* Take the voltages back that the controller has chosen in this tick. */
static void restore_voltages(const pzs_loop *loop, const pzs_loop_core *core)
{
    (void)restore_given(loop, core);
    pzs_control_moved(core->control);
}

/*
 * Choose the constant table whose checksum the loop checks next: the next table of the same block
 * (stage of the control tick), or the first table of the next block.
 */
static void go_on(pzs_loop *loop, bool is_same_block)
{
    loop->state.scrubbed_number = (uint16_t)(is_same_block ? loop->state.scrubbed_number + 1u : 0);
    loop->state.scrubbed_block = (uint16_t)(loop->state.scrubbed_block + (is_same_block ? 0u : 1u));
    loop->state.block_scrub.position = 0;
    loop->state.block_scrub.has_failed = false;
}

/*
 * Check the next slice of the constant tables of all blocks (stages of the control tick) except the
 * controller's. A table with a wrong checksum is read a second time. Returns false if a table is
 * damaged, with the type of its block in info.block.
 *   part [PZS_TABLE_PARTS]  work array
 */
static bool scrub_block(pzs_loop *loop, const pzs_loop_core *core,
                        pzs_table_part part[PZS_TABLE_PARTS])
{
    uint32_t crc = 0, parts = 0;
    guard_repair_bool(&loop->state.block_scrub.has_failed);
    if (loop->state.scrubbed_block >= core->count)
        loop->state.scrubbed_block = 0;
    const pzs_block *block = &core->blocks[loop->state.scrubbed_block];
    if (block->type->block_parts != NULL)
        parts = block->type->block_parts(block->tables, loop->state.scrubbed_number, part, &crc);
    if (parts == 0) {
        go_on(loop, false);
        return true;
    }
    if (!pzs_scrub_slice(&loop->state.block_scrub, part, parts, crc)) {
        loop->info.block = block->type;
        return false;
    }
    if (loop->state.block_scrub.position == 0 && !loop->state.block_scrub.has_failed)
        go_on(loop, true);
    return true;
}

/*
 * Check the next slice of the constant tables against their checksum. Returns whether the tables
 * are intact, as far as is known.
 */
static bool scrub_tables(pzs_loop *loop, const pzs_loop_core *core, const pzs_problem *problem)
{
    pzs_table_part part[PROBLEM_PARTS > PZS_TABLE_PARTS ? PROBLEM_PARTS : PZS_TABLE_PARTS];
    const size_t count = (size_t)problem->inputs * problem->outputs;
    const pzs_table_part device_influence = {core->influence, count * sizeof(pzs_real)};
    pzs_problem_parts(problem, part);
    loop->info.block = NULL;
    if (!pzs_scrub_slice(&loop->state.problem_scrub, part, PROBLEM_PARTS, problem->crc) ||
        (core->influence != NULL &&
         !pzs_scrub_slice(&loop->state.influence_scrub, &device_influence, 1, core->influence_crc)))
        return false;
    return scrub_block(loop, core, part);
}

/*
 * Whether the status that a block (stage of the control tick) has returned takes precedence over
 * the status that the earlier blocks of this tick have left.
 */
static bool takes_precedence(pzs_status status, const pzs_block_type *type, pzs_status result)
{
    if (status == PZS_OK)
        return false;
    return PZS_IS_ERROR(status) || result == PZS_OK || type->phase == PZS_PHASE_STEP ||
           type->phase == PZS_PHASE_SUPERVISE;
}

/*
 * Run all blocks (stages) of a control tick. Returns the status that takes precedence, and stores
 * its block and its index.
 */
static pzs_status run(pzs_loop *loop, const pzs_loop_core *core, pzs_loop_signals *signals,
                      pzs_status result)
{
    const pzs_problem *problem = problem_of(core);
    uint8_t *memory = memory_of(core, problem, 0);
    (void)finish(loop, result, PZS_IS_ERROR(result) ? loop->info.block : NULL, -1);
    for (size_t k = 0; k < core->count; k++) {
        const pzs_block_type *type = core->blocks[k].type;
        void *self = memory;
        memory += bytes_of(&core->blocks[k], problem);
        // After an error, also one found before the first block, only the supervisor runs.
        if (PZS_IS_ERROR(result) && type->phase != PZS_PHASE_SUPERVISE)
            continue;
        signals->where = -1;
        signals->tables = core->blocks[k].tables;
        signals->status = result;
        const pzs_status status = type->block_tick(self, signals);
        // The tests of the hardware have not ended: the loop does not control the voltages yet.
        if (type->phase == PZS_PHASE_COMMISSION && status != PZS_OK)
            return finish(loop, status, type, signals->where);
        if (PZS_IS_ERROR(status) && type->phase != PZS_PHASE_SUPERVISE)
            restore_voltages(loop, core);
        if (!PZS_IS_ERROR(status))
            signals->warnings |= status != PZS_OK ? 1u << status : 0u;
        if (takes_precedence(status, type, result))
            result = finish(loop, status, type, signals->where);
    }
    return result;
}

/*
 * Check the voltages of the controller against limits in flash, correct them where necessary, and
 * store them in the output array that the program reads.
 */
static pzs_status give_out(pzs_loop *loop, const pzs_loop_core *core, pzs_status status)
{
    int32_t where;
    const output_gate gate = gate_of(loop, core);
    const pzs_status passed =
        pzs_output_gate(&gate, core->control->state.voltage, core->limit_sum, &where);
    if (PZS_IS_ERROR(passed)) {
        restore_voltages(loop, core);
        return finish(loop, passed, NULL, where);
    }
    publish(loop, core);
    if (passed == PZS_OK)
        return status;
    pzs_control_recover(core->control, core->influence);
    return PZS_IS_ERROR(status) ? status : finish(loop, passed, NULL, where);
}

/*
 * Whether the list of the blocks (stages) of a control tick ends with a supervisor, which decides
 * whether the loop controls the voltages.
 */
static bool is_supervised(const pzs_loop_core *core)
{
    return core->blocks[core->count - 1u].type->phase == PZS_PHASE_SUPERVISE;
}

/*
 * Values of the member `heartbeat` of the loop's state. Any other value, which only damaged memory
 * can cause, counts as NEVER_AGAIN.
 */
#define NO_HEARTBEAT 0u
#define HEARTBEAT 0x5AC369A5u
#define NEVER_AGAIN 0xA53C965Au

/*
 * Withdraw the heartbeat of the last tick, so that a tick that hangs leaves no heartbeat. If the
 * tables are damaged, no later tick gives a heartbeat.
 */
static void withdraw_heartbeat(pzs_loop *loop, bool is_intact)
{
    const uint32_t word = loop->state.heartbeat;
    const bool is_known = word == NO_HEARTBEAT || word == HEARTBEAT;
    loop->state.heartbeat = is_known && is_intact ? NO_HEARTBEAT : NEVER_AGAIN;
}

/*
 * Whether a tick that ends with `status` gives a heartbeat. Without a supervisor, a tick that only
 * keeps the voltages, because its readings or target are not usable, gives none: the watchdog is
 * then the only protection against such ticks going on for ever.
 */
static bool is_in_order(const pzs_loop_core *core, const pzs_loop_signals *signals,
                        pzs_status status)
{
    const bool is_held = (signals->warnings >> PZS_W_HELD & 1u) != 0;
    return !PZS_IS_ERROR(status) && status != PZS_W_OUTPUT && (!is_held || is_supervised(core));
}

pzs_status pzs_loop_tick(pzs_loop *loop, const pzs_real *wanted, const pzs_real *readings)
{
    if (loop == NULL || wanted == NULL)
        return PZS_E_ARGUMENT;
    const pzs_loop_core *core = voted_core(loop);
    if (core->stage != READY)
        return PZS_E_STAGE;
    const pzs_problem *problem = problem_of(core);
    loop->info.control = core->control;
    pzs_control_restore(core->control, problem, core->influence, core->control_work);
    if (!is_supervised(core)) {
        // Nothing else would undo a flipped bit of these flags.
        core->control->state.is_taken_over = false;
        core->control->state.is_led = false;
    }
    const uint32_t missed = loop->state.missed;
    loop->state.missed = 0;
    const pzs_status intact = scrub_tables(loop, core, problem) ? PZS_OK : PZS_E_CRC;
    withdraw_heartbeat(loop, intact == PZS_OK);
    pzs_loop_signals signals = {.control = core->control,
                                .wanted = wanted,
                                .readings = readings,
                                .measured = readings,
                                .known_now = core->known_now,
                                .known_next = core->known_next,
                                .given = restore_given(loop, core),
                                .deviation = -1,
                                .missed = missed < PZS_MISSED_LIMIT ? missed : PZS_MISSED_LIMIT,
                                .sensors = core->sensors};
    pzs_status status = run(loop, core, &signals, intact);
    loop->info.measured = signals.measured;
    loop->info.electrode = signals.electrode;
    if (PZS_IS_ERROR(status) && !is_supervised(core))
        return status;
    status = give_out(loop, core, status);
    if (is_in_order(core, &signals, status) && loop->state.heartbeat == NO_HEARTBEAT)
        loop->state.heartbeat = HEARTBEAT;
    return status;
}

bool pzs_loop_take_heartbeat(pzs_loop *loop)
{
    if (loop == NULL || loop->state.heartbeat != HEARTBEAT)
        return false;
    loop->state.heartbeat = NO_HEARTBEAT;
    return true;
}

/* ---- for the program ---------------------------------------------------- */

/*
 * Copy the pointers and sizes of a loop, which stay constant from tick to tick, after a majority
 * vote over their three copies. The loop is not changed. Returns whether the loop is initialised.
 */
static bool read_core(const pzs_loop *loop, pzs_loop_core *core)
{
    pzs_loop_core copy[3];
    memcpy(copy, loop->state.core, sizeof copy);
    pzs_guard_vote(&copy[0], &copy[1], &copy[2], sizeof copy[0]);
    *core = copy[0];
    return core->stage == READY;
}

pzs_status pzs_loop_voltages(const pzs_loop *loop, pzs_real *voltage)
{
    pzs_loop_core core;
    if (loop == NULL || voltage == NULL)
        return PZS_E_ARGUMENT;
    if (!read_core(loop, &core))
        return PZS_E_STAGE;
    const pzs_problem *problem = problem_of(&core);
    for (int tries = 0; tries < 4; tries++) {
        const uint32_t frames = loop->info.frames;
        const volatile pzs_real *frame = frame_of(&core, problem, frames);
        for (uint32_t i = 0; i < problem->inputs; i++)
            voltage[i] = frame[i];
        if (loop->info.frames == frames)
            return PZS_OK;
    }
    return PZS_W_HELD;
}

void *pzs_loop_find(const pzs_loop *loop, const pzs_block_type *type)
{
    pzs_loop_core core;
    if (loop == NULL || !read_core(loop, &core))
        return NULL;
    for (size_t k = 0; k < core.count; k++)
        if (core.blocks[k].type == type)
            return memory_of(&core, problem_of(&core), k);
    return NULL;
}
