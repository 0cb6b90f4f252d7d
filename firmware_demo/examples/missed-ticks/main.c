/* Damp vibration although ticks are missed. A timer counts the tick periods; the program tells the
 * loop how many it has missed. The functions before main simulate timer and structure.
 * SPDX-License-Identifier: BSD-2-Clause */
#define PLATE_REAL_BITS 32
#include "board.h"
#include "plate.h"

static pzs_real work[PLATE_LOOP_BYTES / sizeof(pzs_real) + 1];
static pzs_real wanted[PLATE_OUTPUTS], readings[PLATE_READINGS];
static pzs_real position[PLATE_MODES], velocity[PLATE_MODES]; /* vibration of each mode (m) */
static pzs_loop loop;
static volatile uint32_t timer; /* number of tick periods; a timer interrupt would count them */

/* Let one tick period pass: the modes vibrate about their equilibrium under the voltages. */
static void pass_period(void)
{
    for (int k = 0; k < PLATE_MODES; k++) {
        pzs_real still = 0;
        for (int j = 0; j < PLATE_INPUTS; j++)
            still += plate_modal[k * PLATE_INPUTS + j] * loop.info.voltage[j];
        const pzs_real away = position[k] - still, speed = velocity[k];
        position[k] = still + plate_turn[k] * away + plate_turn[PLATE_MODES + k] * speed;
        velocity[k] =
            plate_turn[2 * PLATE_MODES + k] * away + plate_turn[3 * PLATE_MODES + k] * speed;
    }
    timer++;
}

static void read_sensors(void)
{
    for (int i = 0; i < PLATE_READINGS; i++) {
        readings[i] = 0;
        for (int k = 0; k < PLATE_MODES; k++)
            readings[i] += plate_mode_shape[i * PLATE_MODES + k] * position[k];
    }
}

int main(void)
{
    uint32_t run = 0, missed = 0, handled = 0;
    board_start();
    pzs_status status = pzs_loop_init(&loop, plate_blocks, PLATE_BLOCKS, NULL, work, sizeof work);
    velocity[0] = PZS_R(1e-3); /* the first mode vibrates, for example after a blow */
    for (; run < 1000 && !PZS_IS_ERROR(status); run++) {
        for (int k = 0; k < (run % 20 == 19 ? 3 : 1); k++) /* late in each 20th tick */
            pass_period();
        const uint32_t now = timer;
        if (now - handled > 1)
            status = pzs_loop_skip(&loop, now - handled - 1); /* the important call */
        missed += now - handled - 1;
        handled = now;
        read_sensors();
        status = pzs_loop_tick(&loop, wanted, readings);
    }
    const pzs_damper *damper = pzs_loop_find(&loop, &pzs_vibration_block);
    const int is_damped = damper->info.deviation < PZS_R(1e-5) && run == 1000 && missed == 100;
    for (const char *text = is_damped ? "damped, 100 ticks missed\n" : "FAILED\n"; *text; text++)
        board_put(*text);
    return PZS_IS_ERROR(status) || !is_damped;
}
