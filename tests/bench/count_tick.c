/*
 * Instructions of a control tick and of what stands beside it, on a Cortex-M under QEMU, or on the
 * host to compare the bits. The plate with 25 pairs of patches, eleven displacement sensors along
 * its tip, a known pressure, converter steps of 50 mV; the plant is a little weaker than the tables
 * say; the target moves, a load comes, two electrodes die, a sensor is lost.
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
#define STEP PZS_R(0.05)

/* Multiply-adds that no tick can exceed. Of the fault detector: see lib/control/faults.c. */
#define TICK_MOST ((uint32_t)PZS_STEP_WORK(DEMO_INPUTS, DEMO_OUTPUTS, PZS_WORK_LIMIT(DEMO_INPUTS)))
#define WATCH_MOST                                                                                 \
    ((DEMO_OUTPUTS + DEMO_INPUTS) * DEMO_INPUTS + DEMO_OUTPUTS * DEMO_INPUTS * DEMO_INPUTS / 16u + \
     DEMO_INPUTS * DEMO_INPUTS * DEMO_INPUTS / 6u)

enum {
    TICKS = 600,
    PERIOD = 120,
    LOADED = 200,
    DEAD = 300,
    LOST = 400,
    ONE = 0,
    OTHER = 11,
    FIRST_SENSOR = DEMO_OUTPUTS - DEMO_SENSORS
};
enum { ESTIMATE, FEED, TICK, QUANTISE, WATCH, PARTS };

static const char *const part_name[PARTS] = {"estimate", "feed_forward", "tick", "quantise",
                                             "watch"};
static pzs_real control_work[REALS(DEMO_CONTROL_BYTES)];
static pzs_real watch_work[REALS(PZS_FAULT_DETECTOR_BYTES(DEMO_INPUTS, DEMO_OUTPUTS, 0))];
static pzs_real estimate_work[REALS(PZS_ESTIMATE_BYTES(DEMO_SENSORS))];
static pzs_real wanted[DEMO_OUTPUTS], shape[DEMO_OUTPUTS], measured[DEMO_OUTPUTS],
    sensed[DEMO_SENSORS];
static pzs_real given[DEMO_INPUTS], voltage[DEMO_INPUTS];

typedef struct cost {
    uint32_t total, most;
} cost;

static void add(cost *c, uint32_t spent)
{
    c->total += spent;
    c->most = spent > c->most ? spent : c->most;
}

/* 1 to -1 and back over a period. */
static pzs_real wave(int tick)
{
    const int phase = tick % PERIOD;
    return (pzs_real)(phase < PERIOD / 2 ? PERIOD / 4 - phase : phase - PERIOD * 3 / 4) /
           (PERIOD / 4);
}

/* The shape that the structure has. The sensors stand on its last nodes. */
static void act(const pzs_control *control, int tick)
{
    for (int j = 0; j < DEMO_INPUTS; j++)
        voltage[j] = tick >= DEAD && (j == ONE || j == OTHER) ? 0 : GAIN * control->info.voltage[j];
    for (int i = 0; i < DEMO_OUTPUTS; i++) {
        const pzs_real place = (pzs_real)(2 * i + 1 - DEMO_OUTPUTS) / DEMO_OUTPUTS;
        measured[i] = tick < LOADED ? 0 : demo_shape_per_load[i] + PZS_R(1e-6) * place * place;
        for (int j = 0; j < DEMO_INPUTS; j++)
            measured[i] += demo_influence[i * DEMO_INPUTS + j] * voltage[j];
        wanted[i] = wave(tick) * demo_target[i];
    }
    for (int s = 0; s < DEMO_SENSORS; s++)
        sensed[s] = measured[FIRST_SENSOR + s];
    if (tick >= LOST)
        measured[7] = (pzs_real)HUGE_VAL;
}

/*
 * One tick with everything on. The estimate is made and paid for, but every node is measured
 * besides, or nobody could watch over the electrodes.
 */
static pzs_status run(pzs_control *control, pzs_fault_detector *detector, pzs_estimate *estimate,
                      int tick, cost *part)
{
    const pzs_real load = tick < LOADED ? 0 : 1;
    uint32_t at[PARTS + 1];
    at[ESTIMATE] = board_count();
    pzs_status worst = pzs_estimate_tick(estimate, sensed, shape);
    at[FEED] = board_count();
    (void)pzs_feed_forward(&demo_shape_feed_forward, &load, measured);
    (void)pzs_feed_forward(&demo_shape_feed_forward, &load, wanted);
    at[TICK] = board_count();
    const pzs_status ticked = pzs_tick(control, wanted, measured);
    at[QUANTISE] = board_count();
    const pzs_status rounded = pzs_quantise(control, given, STEP, 0);
    at[WATCH] = board_count();
    const pzs_status watched = pzs_fault_detector_tick(detector, measured);
    at[PARTS] = board_count();
    for (int k = 0; k < PARTS; k++)
        add(&part[k], board_instructions(at[k], at[k + 1]));
    add(&part[PARTS], board_instructions(at[0], at[PARTS]));
    worst = ticked > worst ? ticked : worst;
    worst = rounded > worst ? rounded : worst;
    return watched > worst ? watched : worst;
}

int main(void)
{
    pzs_control control = {0};
    pzs_fault_detector detector = {0};
    pzs_estimate estimate = {0};
    cost part[PARTS + 1] = {{0, 0}};
    uint32_t crc = GUARD_CRC_START;
    pzs_status worst;

    board_start();
    worst = pzs_control_init(&control, &demo_problem, NULL, control_work, sizeof control_work);
    if (worst == PZS_OK)
        worst = pzs_fault_detector_init(&detector, &control, 0, watch_work, sizeof watch_work);
    if (worst == PZS_OK)
        worst = pzs_estimate_init(&estimate, &control, &demo_estimator, estimate_work,
                                  sizeof estimate_work);
    for (int tick = 0; tick < TICKS && !PZS_IS_ERROR(worst); tick++) {
        act(&control, tick);
        const pzs_status status = run(&control, &detector, &estimate, tick, part);
        worst = status > worst ? status : worst;
        crc = pzs_guard_crc(crc, control.info.voltage, sizeof voltage);
        crc = pzs_guard_crc(crc, shape, sizeof shape);
    }
    for (int k = 0; k <= PARTS; k++) {
        print_text("count ");
        print_text(k < PARTS ? part_name[k] : "all");
        print_count("mean", part[k].total / TICKS);
        print_count("worst", part[k].most);
        print_text("\n");
    }
    print_text("count bytes");
    print_count("control", sizeof control_work);
    print_count("watch", sizeof watch_work);
    print_count("estimate", sizeof estimate_work);
    print_count("stack", board_stack_used());
    print_text("\ncount most_multiply_adds");
    print_count("tick", TICK_MOST);
    print_count("watch", WATCH_MOST);
    print_text("\nbits");
    print_hex("voltages", ~crc);
    print_count("found", detector.info.found);
    print_count("iterations", control.info.iterations_most);
    print_count("status", worst);
    print_text("\n");
    return PZS_IS_ERROR(worst) || detector.info.found != 2;
}
