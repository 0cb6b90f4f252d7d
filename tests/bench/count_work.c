/*
 * Instructions of control ticks that are made as long as possible, on a Cortex-M under QEMU: the
 * plate with 25 pairs of patches, targets that jump every HOLD ticks to shapes that random voltages
 * reach, a plant that is weaker than the tables. LIMIT is the limit of the work, 0 the default.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include "../../firmware_demo/boards/board.h"
#include "../../firmware_demo/demos/print.h"
#include DEMO_TABLES

enum { TICKS = 1500, LONGEST_HOLD = 64 };

#define AMPLITUDE PZS_R(200) /* V */
#define GAIN PZS_R(0.95)

static pzs_real control_work[DEMO_CONTROL_BYTES / sizeof(pzs_real) + 1];
static pzs_real wanted[DEMO_OUTPUTS], measured[DEMO_OUTPUTS];
static pzs_control control;
static uint32_t seed = 1;

/* From -1 to 1. */
static pzs_real uniform(void)
{
    seed = seed * 1664525u + 1013904223u;
    return (pzs_real)(int32_t)(seed & ~0xFFu) / PZS_R(2147483648.0);
}

static void jump(void)
{
    for (int i = 0; i < DEMO_OUTPUTS; i++)
        wanted[i] = 0;
    for (int j = 0; j < DEMO_INPUTS; j++) {
        const pzs_real voltage = AMPLITUDE * uniform();
        for (int i = 0; i < DEMO_OUTPUTS; i++)
            wanted[i] += voltage * demo_influence[i * DEMO_INPUTS + j];
    }
}

static int run(int hold)
{
    uint32_t total = 0, most = 0, work_of_most = 0, warnings = 0, rebuilds = 0;
    pzs_status worst =
        pzs_control_init(&control, &demo_problem, NULL, control_work, sizeof control_work);
    if (LIMIT > 0)
        control.settings.work_limit = LIMIT;
    for (int tick = 0; tick < TICKS && !PZS_IS_ERROR(worst); tick++) {
        if (tick % hold == 0)
            jump();
        for (int i = 0; i < DEMO_OUTPUTS; i++)
            measured[i] = GAIN * control.info.predicted[i];
        const uint32_t start = board_count();
        const pzs_status status = pzs_tick(&control, wanted, measured);
        const uint32_t spent = board_instructions(start, board_count());
        worst = status > worst ? status : worst;
        warnings += status != PZS_OK;
        rebuilds += control.state.optimiser.rebuilds;
        total += spent;
        if (spent > most) {
            most = spent;
            work_of_most = (uint32_t)control.info.work;
        }
    }
    print_text("count");
    print_count("hold", (uint32_t)hold);
    print_count("mean", total / TICKS);
    print_count("worst", most);
    print_count("work", work_of_most);
    print_count("most_work", (uint32_t)control.info.work_most);
    print_count("continued", warnings);
    print_count("rebuilds", rebuilds);
    print_text("\n");
    return PZS_IS_ERROR(worst);
}

int main(void)
{
    int failed = 0;
    board_start();
    for (int hold = 1; hold <= LONGEST_HOLD; hold *= 4)
        failed |= run(hold);
    return failed;
}
