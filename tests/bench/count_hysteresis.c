/*
 * Instructions of the two blocks that compensate hysteresis and creep, in a tick of the plate with
 * 25 electrodes, on a Cortex-M under QEMU, or on the host to compare the bits. The targets jump
 * beyond the stroke, so that most electrodes move by their step limit or stand at a limit.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include "../../firmware_demo/boards/board.h"
#include "../../firmware_demo/demos/print.h"
#include "../../lib/core/guard.h"
#include DEMO_TABLES

#define REALS(bytes) (((bytes) + sizeof(pzs_real) - 1u) / sizeof(pzs_real))

enum { TICKS = 600, PERIOD = 60 };

/* Instructions of one block. */
typedef struct cost {
    uint32_t total, most;
} cost;

static cost effect_cost, inverse_cost;
static pzs_real loop_work[REALS(DEMO_LOOP_BYTES)];
static pzs_real wanted[DEMO_OUTPUTS], measured[DEMO_OUTPUTS];
static pzs_loop loop;

static void add(cost *cost, uint32_t from, uint32_t until)
{
    const uint32_t count = board_instructions(from, until);
    cost->total += count;
    cost->most = count > cost->most ? count : cost->most;
}

static size_t effect_bytes(const void *tables, const pzs_problem *problem)
{
    return pzs_effect_block.block_bytes(tables, problem);
}

static pzs_status effect_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    return pzs_effect_block.block_init(self, tables, signals);
}

static pzs_status effect_tick(void *self, pzs_loop_signals *signals)
{
    const uint32_t from = board_count();
    const pzs_status status = pzs_effect_block.block_tick(self, signals);
    add(&effect_cost, from, board_count());
    return status;
}

static size_t inverse_bytes(const void *tables, const pzs_problem *problem)
{
    return pzs_inverse_block.block_bytes(tables, problem);
}

static pzs_status inverse_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    return pzs_inverse_block.block_init(self, tables, signals);
}

static pzs_status inverse_tick(void *self, pzs_loop_signals *signals)
{
    const uint32_t from = board_count();
    const pzs_status status = pzs_inverse_block.block_tick(self, signals);
    add(&inverse_cost, from, board_count());
    return status;
}

static const pzs_block_type counted_effect = {"effect", PZS_PHASE_READINGS, effect_bytes,
                                              effect_init, effect_tick};
static const pzs_block_type counted_inverse = {"inverse", PZS_PHASE_VOLTAGE, inverse_bytes,
                                               inverse_init, inverse_tick};
static const pzs_block blocks[] = {{&counted_effect, &demo_hysteresis},
                                   {&pzs_step_block, &demo_problem},
                                   {&counted_inverse, &demo_hysteresis}};

/* Target and measured shape of a tick; the plant is weaker than the model. */
static void act(int tick)
{
    const pzs_real sign = tick % PERIOD < PERIOD / 2 ? 1 : -1;
    const pzs_real *voltage = loop.info.voltage;
    for (int i = 0; i < DEMO_OUTPUTS; i++) {
        measured[i] = 0;
        for (int j = 0; j < DEMO_INPUTS; j++)
            measured[i] += PZS_R(0.9) * demo_influence[i * DEMO_INPUTS + j] * voltage[j];
        wanted[i] = sign * demo_target[i];
    }
}

static void print_cost(const char *name, const cost *cost)
{
    print_text("count ");
    print_text(name);
    print_count("mean", cost->total / TICKS);
    print_count("worst", cost->most);
    print_text("\n");
}

int main(void)
{
    uint32_t crc = GUARD_CRC_START;
    board_start();
    pzs_status worst = pzs_loop_init(&loop, blocks, sizeof blocks / sizeof *blocks, NULL, loop_work,
                                     sizeof loop_work);
    for (int tick = 0; tick < TICKS && !PZS_IS_ERROR(worst); tick++) {
        act(tick);
        const pzs_status status = pzs_loop_tick(&loop, wanted, measured);
        worst = status > worst ? status : worst;
        crc = pzs_guard_crc(crc, loop.info.voltage, DEMO_INPUTS * sizeof(pzs_real));
    }
    print_cost("effect", &effect_cost);
    print_cost("inverse", &inverse_cost);
    print_text("bits");
    print_hex("voltages", ~crc);
    print_count("status", worst);
    print_text("\n");
    return PZS_IS_ERROR(worst);
}
