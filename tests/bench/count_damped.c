/*
 * Instructions of a damped tick on a Cortex-M under QEMU, or on the host to compare the bits: the
 * damper and the control step, with the plate of count_tick.c at 1 kHz, all nodes measured. The
 * plant vibrates in the modes of the tables and responds a little more weakly than they say; the
 * target is thrown, then moves slowly (the warm ticks are the last hundred).
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include "../../firmware_demo/boards/board.h"
#include "../../lib/core/guard.h"
#include "../../firmware_demo/demos/print.h"
#include DEMO_TABLES

#define REALS(bytes) (((bytes) + sizeof(pzs_real) - 1u) / sizeof(pzs_real))
#define GAIN PZS_R(0.9)
#define DAMPER_BYTES PZS_DAMPER_BYTES(DEMO_MODES, DEMO_INPUTS, DEMO_READINGS, DEMO_DELAY)

enum { TICKS = 600, THROWN = 400, EVERY = 40 };
enum { DAMPER, TICK, PARTS };

static const char *const part_name[PARTS] = {"damper", "tick"};
static pzs_real control_work[REALS(DEMO_CONTROL_BYTES)], damper_work[REALS(DAMPER_BYTES)];
static pzs_real wanted[DEMO_OUTPUTS], measured[DEMO_OUTPUTS], shape[DEMO_OUTPUTS];
static pzs_real position[DEMO_MODES], velocity[DEMO_MODES];

typedef struct cost {
    uint32_t total, most, warm;
} cost;

static void add(cost *c, uint32_t spent, int tick)
{
    c->total += spent;
    c->most = spent > c->most ? spent : c->most;
    c->warm += tick >= THROWN + 100 ? spent : 0;
}

/* One tick of the plant under the present voltages: readings and the target. */
static void act(const pzs_control *control, int tick)
{
    pzs_real deviation[DEMO_MODES];
    for (int k = 0; k < DEMO_MODES; k++) {
        pzs_real rest = 0;
        for (int j = 0; j < DEMO_INPUTS; j++)
            rest += GAIN * demo_modal[k * DEMO_INPUTS + j] * control->info.voltage[j];
        const pzs_real d = position[k] - rest, speed = velocity[k];
        deviation[k] = demo_turn[k] * d + demo_turn[DEMO_MODES + k] * speed;
        position[k] = rest + deviation[k];
        velocity[k] = demo_turn[2 * DEMO_MODES + k] * d + demo_turn[3 * DEMO_MODES + k] * speed;
    }
    const pzs_real thrown = tick / EVERY % 2 == 1 ? -1 : 1;
    const pzs_real factor = tick < THROWN ? thrown : 1 - PZS_R(0.001) * (pzs_real)(tick - THROWN);
    for (int i = 0; i < DEMO_OUTPUTS; i++) {
        measured[i] = 0;
        for (int j = 0; j < DEMO_INPUTS; j++)
            measured[i] += GAIN * demo_influence[i * DEMO_INPUTS + j] * control->info.voltage[j];
        for (int k = 0; k < DEMO_MODES; k++)
            measured[i] += demo_mode_shape[i * DEMO_MODES + k] * deviation[k];
        wanted[i] = factor * demo_target[i];
    }
}

static pzs_status run(pzs_control *control, pzs_damper *damper, int tick, cost *part)
{
    uint32_t at[PARTS + 1];
    at[DAMPER] = board_count();
    const pzs_status damped = pzs_damper_tick(damper, measured, shape);
    at[TICK] = board_count();
    const pzs_status ticked = pzs_tick(control, wanted, shape);
    at[PARTS] = board_count();
    for (int k = 0; k < PARTS; k++)
        add(&part[k], board_instructions(at[k], at[k + 1]), tick);
    add(&part[PARTS], board_instructions(at[0], at[PARTS]), tick);
    return ticked > damped ? ticked : damped;
}

int main(void)
{
    static pzs_control control;
    static pzs_damper damper;
    cost part[PARTS + 1] = {{0, 0, 0}};
    uint32_t crc = GUARD_CRC_START;
    board_start();
    pzs_status worst =
        pzs_control_init(&control, &demo_problem, NULL, control_work, sizeof control_work);
    if (worst == PZS_OK)
        worst =
            pzs_damper_init(&damper, &control, &demo_vibration, damper_work, sizeof damper_work);
    for (int tick = 0; tick < TICKS && !PZS_IS_ERROR(worst); tick++) {
        act(&control, tick);
        const pzs_status status = run(&control, &damper, tick, part);
        worst = status > worst ? status : worst;
        crc = pzs_guard_crc(crc, control.info.voltage, DEMO_INPUTS * sizeof(pzs_real));
    }
    for (int k = 0; k <= PARTS; k++) {
        print_text("count ");
        print_text(k < PARTS ? part_name[k] : "all");
        print_count("mean", part[k].total / TICKS);
        print_count("worst", part[k].most);
        print_count("warm", part[k].warm / (TICKS - THROWN - 100));
        print_text("\n");
    }
    print_text("count bytes");
    print_count("control", sizeof control_work);
    print_count("damper", sizeof damper_work);
    print_count("stack", board_stack_used());
    print_text("\nbits");
    print_hex("voltages", ~crc);
    print_count("iterations", control.info.iterations_most);
    print_count("status", worst);
    print_text("\n");
    return PZS_IS_ERROR(worst);
}
