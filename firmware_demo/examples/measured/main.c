/* A mirror without a model: tables from its measured influence matrix (mirror.yaml names the file).
 * SPDX-License-Identifier: BSD-2-Clause */
#define MIRROR_REAL_BITS 32 /* this program is for float: another library does not compile */
#include "board.h"
#include "mirror.h"

static pzs_real work[MIRROR_LOOP_BYTES / sizeof(pzs_real) + 1];
static pzs_real readings[MIRROR_READINGS];
static pzs_loop loop;

/* Stands for the sensors: the mirror is a tenth weaker than the measured matrix. */
static void read_sensors(void)
{
    for (int i = 0; i < MIRROR_READINGS; i++) {
        readings[i] = 0;
        for (int k = 0; k < MIRROR_INPUTS; k++)
            readings[i] +=
                PZS_R(0.9) * mirror_influence[i * MIRROR_INPUTS + k] * loop.info.voltage[k];
    }
}

/* Whether the voltages are inside their limits and no step is larger than the step limit. */
static int is_allowed(const pzs_real *before, const pzs_real *voltage)
{
    int allowed = 1;
    for (int k = 0; k < MIRROR_INPUTS; k++) {
        const pzs_real step =
            voltage[k] > before[k] ? voltage[k] - before[k] : before[k] - voltage[k];
        allowed &= voltage[k] >= mirror_lower[k] && voltage[k] <= mirror_upper[k];
        allowed &= step <= mirror_step_limit[k];
    }
    return allowed;
}

int main(void)
{
    pzs_real before[MIRROR_INPUTS];
    int allowed = 1;
    board_start();
    pzs_status status = pzs_loop_init(&loop, mirror_blocks, MIRROR_BLOCKS, NULL, work, sizeof work);
    for (int tick = 0; tick < 100 && !PZS_IS_ERROR(status); tick++) {
        for (int k = 0; k < MIRROR_INPUTS; k++)
            before[k] = loop.info.voltage[k];
        read_sensors();
        status = pzs_loop_tick(&loop, mirror_target, readings);
        allowed &= is_allowed(before, loop.info.voltage);
    }
    for (const char *text = pzs_status_text(status); *text; text++)
        board_put(*text);
    board_put('\n');
    const pzs_real e5 = loop.info.voltage[MIRROR_INPUT_e5]; /* the target draws it to its limit */
    return status != PZS_OK || !allowed || e5 > mirror_lower[MIRROR_INPUT_e5];
}
