/* A mirror without a model: tables from its measured influence matrix (mirror.yaml names the file).
 * SPDX-License-Identifier: BSD-2-Clause */
#define MIRROR_REAL_BITS 32 /* this program is for float: it does not compile with double */
#include "board.h"
#include "mirror.h"

static pzs_real work[MIRROR_LOOP_BYTES / sizeof(pzs_real) + 1];
static pzs_real readings[MIRROR_READINGS];
static pzs_loop loop;

/* Simulate the sensors of a mirror that responds a tenth less than its measured matrix says.
 * Returns the sum of the squares of target minus reading. */
static pzs_real read_sensors(void)
{
    pzs_real misfit = 0;
    for (int i = 0; i < MIRROR_READINGS; i++) {
        readings[i] = 0;
        for (int k = 0; k < MIRROR_INPUTS; k++)
            readings[i] +=
                PZS_R(0.9) * mirror_influence[i * MIRROR_INPUTS + k] * loop.info.voltage[k];
        misfit += (mirror_target[i] - readings[i]) * (mirror_target[i] - readings[i]);
    }
    return misfit;
}

/* Return whether the voltages are inside their limits and no change exceeds the step limit. */
static int is_allowed(const pzs_real *before, const pzs_real *voltage)
{
    int allowed = 1;
    for (int k = 0; k < MIRROR_INPUTS; k++) {
        const pzs_real step = voltage[k] - before[k], most = mirror_step_limit[k];
        allowed &= voltage[k] >= mirror_lower[k] && voltage[k] <= mirror_upper[k];
        allowed &= step <= most && -step <= most;
    }
    return allowed;
}

int main(void)
{
    pzs_real before[MIRROR_INPUTS], misfit = 0, at_start = 0;
    int allowed = 1, kicks = 0;
    board_start();
    pzs_status status = pzs_loop_init(&loop, mirror_blocks, MIRROR_BLOCKS, NULL, work, sizeof work);
    for (int tick = 0; tick < 100 && !PZS_IS_ERROR(status); tick++) {
        for (int k = 0; k < MIRROR_INPUTS; k++)
            before[k] = loop.info.voltage[k];
        misfit = read_sensors();
        at_start = tick == 0 ? misfit : at_start;
        status = pzs_loop_tick(&loop, mirror_target, readings);
        allowed &= is_allowed(before, loop.info.voltage);
        kicks += board_kick(pzs_loop_take_heartbeat(&loop)); /* the hardware watchdog */
    }
    const int improved = misfit < at_start / 2;
    const char *text = improved ? pzs_status_text(status) : "the misfit did not fall below half";
    for (text = allowed ? text : "a voltage left its limits"; *text; text++)
        board_put(*text);
    board_put('\n');
    return status != PZS_OK || !allowed || !improved || kicks != 100;
}
