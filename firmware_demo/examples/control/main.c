/* Hold a shape with one call in each tick. The three static functions simulate the hardware.
 * SPDX-License-Identifier: BSD-2-Clause */
#define PLATE_REAL_BITS 32 /* this program is for float: it does not compile with double */
#include "board.h"
#include "plate.h"

static pzs_real work[PLATE_LOOP_BYTES / sizeof(pzs_real) + 1];
static pzs_real wanted[PLATE_OUTPUTS], readings[PLATE_READINGS];
static pzs_loop loop;

static void read_target(void)
{
    for (int i = 0; i < PLATE_OUTPUTS; i++)
        wanted[i] = plate_target[i] / 2;
}

/* Simulate a structure that responds a tenth less than the influence matrix of the tables says. */
static void read_sensors(void)
{
    for (int i = 0; i < PLATE_READINGS; i++) {
        readings[i] = 0;
        for (int k = 0; k < PLATE_INPUTS; k++)
            readings[i] +=
                PZS_R(0.9) * plate_influence[i * PLATE_INPUTS + k] * loop.info.voltage[k];
    }
}

/* Return whether all voltages are inside their limits. */
static int write_amplifiers(const pzs_real *voltage)
{
    int inside = 1;
    for (int k = 0; k < PLATE_INPUTS; k++)
        inside &= voltage[k] >= plate_lower[k] && voltage[k] <= plate_upper[k];
    return inside;
}

static void print(const char *text)
{
    while (*text)
        board_put(*text++);
}

int main(void)
{
    int inside = 1, kicks = 0;
    board_start();
    pzs_status status = pzs_loop_init(&loop, plate_blocks, PLATE_BLOCKS, NULL, work, sizeof work);
    for (int tick = 0; tick < 100 && !PZS_IS_ERROR(status); tick++) {
        read_target();
        read_sensors();
        status = pzs_loop_tick(&loop, wanted, readings);
        inside &= write_amplifiers(loop.info.voltage);
        kicks += board_kick(pzs_loop_take_heartbeat(&loop)); /* the hardware watchdog */
    }
    print(loop.info.block ? loop.info.block->name : "loop");
    print(": ");
    print(pzs_status_text(status));
    print(inside ? ", every voltage inside its limits\n" : ", a voltage OUTSIDE its limits\n");
    return PZS_IS_ERROR(status) || !inside || kicks != 100;
}
