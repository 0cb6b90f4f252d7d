/*
 * Control image of the demonstration, in a loop with a simulated structure at the other end of a
 * byte stream. The program reads one order after the other until the stream ends, and answers each
 * tick. The blocks of the loop are those of the tables. All numbers are 32-bit words, and reals in
 * the format of the processor:
 *
 *   out, once            bits of a real, inputs, outputs, readings, status of the start; unless
 *                        that is an error, voltage [inputs] (V)
 *   in   TICK, 0         wanted [outputs] (m), readings [readings]
 *   out                  status, iterations; voltage [inputs] (V); state of each electrode
 *                        [inputs], bytes, 0 where no block reports it
 *   in   HOLD, input     voltage (V)
 *   in   RELEASE, input
 *   in   KNOW, 0         load values at the time of the next readings [loads], coming load values
 *        [loads]: fed forward from now on
 *   in   SKIP, ticks     number of ticks that were missed before the next tick
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <string.h>
#include "../boards/board.h"
#include DEMO_TABLES

#define REALS(bytes) (((bytes) + sizeof(pzs_real) - 1u) / sizeof(pzs_real))

#ifndef DEMO_LOADS
#define DEMO_LOADS 1 /* size of an array that is not used: the tables know no load */
#endif

enum { TICK, HOLD, RELEASE, KNOW, SKIP };

static pzs_real work[REALS(DEMO_LOOP_BYTES)];
static pzs_real wanted[DEMO_OUTPUTS], readings[DEMO_READINGS];
static pzs_real known[2][DEMO_LOADS]; /* load values at the time of the readings, and coming load
                                         values */
static const uint8_t untold[DEMO_INPUTS];
static pzs_loop loop;

static int send_voltage(void)
{
    return board_send(loop.info.voltage, DEMO_INPUTS * sizeof *loop.info.voltage);
}

static int start(void)
{
    const pzs_status status =
        pzs_loop_init(&loop, demo_blocks, DEMO_BLOCKS, NULL, work, sizeof work);
    const uint32_t about[5] = {PZS_REAL_BITS, DEMO_INPUTS, DEMO_OUTPUTS, DEMO_READINGS, status};
    return board_send(about, sizeof about) && !PZS_IS_ERROR(status) && send_voltage();
}

static int tick(void)
{
    if (!board_receive(wanted, sizeof wanted) || !board_receive(readings, sizeof readings))
        return 0;
    const pzs_status status = pzs_loop_tick(&loop, wanted, readings);
    const uint32_t about[2] = {status, loop.info.control->info.iterations};
    const uint8_t *state = loop.info.electrode != NULL ? loop.info.electrode : untold;
    return board_send(about, sizeof about) && send_voltage() && board_send(state, DEMO_INPUTS);
}

static int know(void)
{
    return board_receive(known, sizeof known) && pzs_loop_know(&loop, known[0], known[1]) == PZS_OK;
}

static int hold(uint32_t input)
{
    pzs_real voltage;
    return board_receive(&voltage, sizeof voltage) &&
           pzs_hold(loop.info.control, (uint16_t)input, voltage) == PZS_OK;
}

static int skip(uint32_t ticks)
{
    return pzs_loop_skip(&loop, ticks) == PZS_OK;
}

static int release(uint32_t input)
{
    return pzs_release(loop.info.control, (uint16_t)input) == PZS_OK;
}

int main(void)
{
    uint32_t order[2];
    int good = start();

    while (good && board_receive(order, sizeof order)) {
        switch (order[0]) {
        case TICK: good = tick(); break;
        case HOLD: good = hold(order[1]); break;
        case RELEASE: good = release(order[1]); break;
        case KNOW: good = know(); break;
        case SKIP: good = skip(order[1]); break;
        default: good = 0;
        }
    }
    return !good;
}
