/*
 * Instructions of a tick through pzs_loop against the same calls made by hand, on a Cortex-M under
 * QEMU, or on the host to compare the bits. The plate of count_tick.c; BLOCKS 1: the step alone,
 * otherwise feed-forward, estimator, step, amplifiers and fault detector.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include "../../firmware_demo/boards/board.h"
#include "../../lib/control/output_gate.h"
#include "../../lib/core/guard.h"
#include "../../firmware_demo/demos/print.h"
#include <string.h>
#include DEMO_TABLES

#define REALS(bytes) (((bytes) + sizeof(pzs_real) - 1u) / sizeof(pzs_real))
#define ALL_BYTES                                                                                  \
    (PZS_LOOP_BYTES(5, DEMO_INPUTS) + PZS_FEED_FORWARD_BLOCK_BYTES(DEMO_SENSORS, DEMO_OUTPUTS) +   \
     PZS_ESTIMATOR_BLOCK_BYTES(DEMO_SENSORS, DEMO_OUTPUTS) +                                       \
     PZS_STEP_BLOCK_BYTES(DEMO_INPUTS, DEMO_OUTPUTS) + PZS_AMPLIFIER_BLOCK_BYTES(DEMO_INPUTS) +    \
     PZS_FAULT_DETECTOR_BLOCK_BYTES(DEMO_INPUTS, DEMO_OUTPUTS, 0))
#define STEP PZS_R(0.05)

enum { TICKS = 600, PERIOD = 120, LOADED = 200, FIRST_SENSOR = DEMO_OUTPUTS - DEMO_SENSORS };

static const pzs_known_loads known_loads = {&demo_shape_feed_forward, &demo_reading_feed_forward};
static const pzs_amplifier amplifier = {STEP, 0};
static const pzs_fault_detection detection = {0, 0};
#if BLOCKS == 1
static const pzs_block blocks[] = {{&pzs_step_block, &demo_problem}};
#else
static const pzs_block blocks[] = {{&pzs_feed_forward_block, &known_loads},
                                   {&pzs_estimator_block, &demo_estimator},
                                   {&pzs_step_block, &demo_problem},
                                   {&pzs_amplifier_block, &amplifier},
                                   {&pzs_fault_detector_block, &detection}};
#endif

static pzs_real loop_work[REALS(ALL_BYTES)], control_work[REALS(DEMO_CONTROL_BYTES)];
static pzs_real detector_work[REALS(PZS_FAULT_DETECTOR_BYTES(DEMO_INPUTS, DEMO_OUTPUTS, 0))];
static pzs_real estimate_work[REALS(PZS_ESTIMATE_BYTES(DEMO_SENSORS))];
static pzs_real wanted[DEMO_OUTPUTS], measured[DEMO_OUTPUTS], sensed[DEMO_SENSORS];
static pzs_real asked[DEMO_OUTPUTS], shape[DEMO_OUTPUTS], readings[DEMO_SENSORS];
static pzs_real given[DEMO_INPUTS], load[1];
static pzs_loop loop;
static pzs_control control;
static pzs_estimate estimate;
static pzs_fault_detector detector;

/* 1 to -1 and back over a period. */
static pzs_real wave(int tick)
{
    const int phase = tick % PERIOD;
    const int quarters = phase < PERIOD / 2 ? PERIOD / 4 - phase : phase - PERIOD * 3 / 4;
    return (pzs_real)quarters / (PERIOD / 4);
}

static void act(int tick)
{
    load[0] = tick < LOADED ? 0 : 1;
    for (int i = 0; i < DEMO_OUTPUTS; i++) {
        measured[i] = load[0] * demo_shape_per_load[i];
        for (int j = 0; j < DEMO_INPUTS; j++)
            measured[i] +=
                PZS_R(0.9) * demo_influence[i * DEMO_INPUTS + j] * control.info.voltage[j];
        wanted[i] = wave(tick) * demo_target[i];
    }
    memcpy(sensed, measured + FIRST_SENSOR, sizeof sensed);
}

#if BLOCKS == 1
static const pzs_real *const taken = measured;

static pzs_status by_hand(void)
{
    return pzs_tick(&control, wanted, measured);
}
#else
static const pzs_real *const taken = sensed;

static pzs_status by_hand(void)
{
    memcpy(asked, wanted, sizeof asked);
    memcpy(readings, sensed, sizeof readings);
    (void)pzs_feed_forward(&demo_reading_feed_forward, load, readings);
    (void)pzs_feed_forward(&demo_shape_feed_forward, load, asked);
    pzs_status worst = pzs_estimate_tick(&estimate, readings, shape);
    const pzs_status ticked = pzs_tick(&control, asked, shape);
    const pzs_status rounded = pzs_quantise(&control, given, STEP, 0);
    const pzs_status found = pzs_fault_detector_tick(&detector, shape);
    worst = ticked > worst ? ticked : worst;
    worst = rounded > worst ? rounded : worst;
    return found > worst ? found : worst;
}
#endif

static pzs_status start(void)
{
    pzs_status status = pzs_loop_init(&loop, blocks, sizeof blocks / sizeof *blocks, NULL,
                                      loop_work, sizeof loop_work);
    (void)pzs_loop_know(&loop, load, load);
    if (status == PZS_OK)
        status = pzs_control_init(&control, &demo_problem, NULL, control_work, sizeof control_work);
    if (status == PZS_OK)
        status = pzs_estimate_init(&estimate, &control, &demo_estimator, estimate_work,
                                   sizeof estimate_work);
    if (status == PZS_OK)
        status =
            pzs_fault_detector_init(&detector, &control, 0, detector_work, sizeof detector_work);
    return status;
}

/* Instructions of the last gate on voltages that it need not correct. */
static uint32_t count_gate(void)
{
    static pzs_real last[3][DEMO_INPUTS], frame[DEMO_INPUTS];
    output_gate gate = {&demo_problem, control.state.held, {last[0], last[1], last[2]}, frame};
    const uint32_t sum = pzs_output_limit_sum(&demo_problem);
    int32_t where;
    for (int k = 0; k < 3; k++)
        memcpy(last[k], control.info.voltage, sizeof last[k]);
    const uint32_t from = board_count();
    (void)pzs_output_gate(&gate, control.state.voltage, sum, &where);
    return board_instructions(from, board_count());
}

int main(void)
{
    uint32_t hand_total = 0, hand_most = 0, loop_total = 0, loop_most = 0, different = 0;
    uint32_t crc = GUARD_CRC_START;
    board_start();
    pzs_status worst = start();
    for (int tick = 0; tick < TICKS && !PZS_IS_ERROR(worst); tick++) {
        act(tick);
        const uint32_t from = board_count();
        worst = by_hand();
        const uint32_t between = board_count();
        const pzs_status status = pzs_loop_tick(&loop, wanted, taken);
        const uint32_t until = board_count();
        const uint32_t hand = board_instructions(from, between);
        const uint32_t through = board_instructions(between, until);
        const size_t bytes = DEMO_INPUTS * sizeof(pzs_real);
        different += memcmp(loop.info.voltage, control.info.voltage, bytes) != 0;
        hand_total += hand;
        loop_total += through;
        hand_most = hand > hand_most ? hand : hand_most;
        loop_most = through > loop_most ? through : loop_most;
        worst = status > worst ? status : worst;
        crc = pzs_guard_crc(crc, loop.info.voltage, bytes);
    }
    print_text("count");
    print_count("hand", hand_total / TICKS);
    print_count("loop", loop_total / TICKS);
    print_count("hand_worst", hand_most);
    print_count("loop_worst", loop_most);
    print_count("gate", count_gate());
    print_text("\nbits");
    print_hex("voltages", ~crc);
    print_count("different", different);
    print_count("status", worst);
    print_text("\n");
    return PZS_IS_ERROR(worst) || different != 0;
}
