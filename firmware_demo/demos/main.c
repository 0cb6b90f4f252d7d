/*
 * Hold a shape for 200 ticks: the target grows and shrinks, the simulated structure responds a
 * little less than the tables say, and a disturbance comes and goes. Then the program prints one
 * line of results, which must have the same bits on every machine, and one line of costs, which
 * depend on the machine; the fault drill follows. The exit code is 0 if all results are as
 * expected.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "demo.h"
#include "../boards/board.h"
#include "../../lib/core/guard.h"
#include "print.h"

enum { TICKS = 200, PERIOD = 80, WARM_TICKS = 100 };

#define PLANT_GAIN                                                                                 \
    PZS_R(0.95) /* response of the simulated structure, relative to that of the tables */
#define BUMP_SHARE PZS_R(0.1) /* height of the disturbance, relative to the largest target */

typedef struct loop_log {
    pzs_status worst;         /* largest status of all ticks */
    uint32_t warnings;        /* number of ticks that ended with a warning */
    uint32_t outside;         /* number of voltages found outside their limits */
    uint32_t active;          /* largest number of inputs at a limit in one tick */
    uint32_t crc;             /* checksum of the voltages of all ticks */
    uint32_t total, most;     /* instructions of all ticks, and of the longest tick */
    uint32_t warm, warm_most; /* instructions of all ticks, and of the longest tick, while the
                                 target moves slowly */
} loop_log;

/*
 * Periodic function between 0 and 1, smooth at both ends: a cubic polynomial of a triangle wave, so
 * that no mathematical library is needed.
 */
static pzs_real wave(int tick)
{
    const int phase = tick % PERIOD;
    const pzs_real time =
        (pzs_real)(phase < PERIOD / 2 ? phase : PERIOD - phase) / (pzs_real)(PERIOD / 2);
    return time * time * (3 - 2 * time);
}

static pzs_real largest(const pzs_real *vector, int count)
{
    pzs_real most = 0;
    for (int i = 0; i < count; i++) {
        const pzs_real size = vector[i] < 0 ? -vector[i] : vector[i];
        if (size > most)
            most = size;
    }
    return most;
}

/*
 * Simulate the measured shape [outputs] (m): the response of the structure to the voltages, plus a
 * disturbance.
 */
static void measure(const demo_image *image, const pzs_real *voltage, pzs_real bump)
{
    const int inputs = image->problem->inputs, outputs = image->problem->outputs;
    for (int i = 0; i < outputs; i++) {
        const pzs_real *row = image->influence + (size_t)i * (size_t)inputs;
        const pzs_real place = (pzs_real)(2 * i + 1 - outputs) / (pzs_real)outputs;
        pzs_real sum = 0;
        for (int j = 0; j < inputs; j++)
            sum += row[j] * voltage[j];
        image->measured[i] = PLANT_GAIN * sum + bump * (1 - place * place);
    }
}

static uint32_t count_active(const pzs_problem *problem, const pzs_real *voltage)
{
    uint32_t active = 0;
    for (int j = 0; j < problem->inputs; j++)
        active += !(voltage[j] > problem->lower[j] && voltage[j] < problem->upper[j]);
    return active;
}

static uint32_t count_outside(const pzs_problem *problem, const pzs_real *voltage)
{
    uint32_t outside = 0;
    for (int j = 0; j < problem->inputs; j++)
        outside += !(voltage[j] >= problem->lower[j] && voltage[j] <= problem->upper[j]);
    return outside;
}

/* Run one tick, check its voltages and record its results. Returns the number of instructions. */
static uint32_t timed_tick(pzs_control *control, const demo_image *image, loop_log *log)
{
    const uint32_t start = board_count();
    const pzs_status status = pzs_tick(control, image->wanted, image->measured);
    const uint32_t spent = board_instructions(start, board_count());

    if (status > log->worst)
        log->worst = status;
    log->warnings += status != PZS_OK;
    log->outside += count_outside(image->problem, control->info.voltage);
    log->crc = pzs_guard_crc(log->crc, control->info.voltage,
                             image->problem->inputs * sizeof *control->info.voltage);
    return spent;
}

static void want(const demo_image *image, pzs_real amplitude)
{
    for (int i = 0; i < image->problem->outputs; i++)
        image->wanted[i] = amplitude * image->target[i];
}

static loop_log run(pzs_control *control, const demo_image *image)
{
    const pzs_real bump = BUMP_SHARE * largest(image->target, image->problem->outputs);
    loop_log log = {.crc = GUARD_CRC_START};

    for (int tick = 0; tick < TICKS; tick++) {
        want(image, wave(tick));
        measure(image, control->info.voltage, bump * wave(tick + PERIOD / 4));
        const uint32_t spent = timed_tick(control, image, &log);
        log.total += spent;
        if (spent > log.most)
            log.most = spent;
        const uint32_t active = count_active(image->problem, control->info.voltage);
        if (active > log.active)
            log.active = active;
    }
    return log;
}

/*
 * Let the target move by a thousandth of itself in each tick, as in a loop that holds a shape: the
 * active set of the optimiser stays the same.
 */
static void run_warm(pzs_control *control, const demo_image *image, loop_log *log)
{
    for (int tick = -WARM_TICKS; tick < WARM_TICKS; tick++) {
        want(image, PZS_R(0.5) + PZS_R(0.02) * wave(tick < 0 ? 0 : tick));
        measure(image, control->info.voltage, 0);
        const uint32_t spent = timed_tick(control, image, log);
        if (tick < 0)
            continue; /* the voltages are still on their way to the slowly moving target */
        log->warm += spent;
        if (spent > log->warm_most)
            log->warm_most = spent;
    }
    log->crc = ~log->crc;
}

/* Relative error of the shape after the last tick. */
static pzs_real last_error(pzs_control *control, const demo_image *image)
{
    pzs_report report = {0};
    for (int i = 0; i < image->problem->outputs; i++)
        image->measured[i] = image->wanted[i] - control->info.disturbance[i];
    (void)pzs_assess(control, image->measured, &report);
    return report.relative_error;
}

static void report(pzs_control *control, const demo_image *image, const loop_log *log)
{
    print_text("result");
    print_hex("scene", control->state.problem->scene);
    print_count("bits", PZS_REAL_BITS);
    print_count("status", log->worst);
    print_count("warnings", log->warnings);
    print_count("ticks", TICKS + 2 * WARM_TICKS);
    print_count("active", log->active);
    print_count("outside", log->outside);
    print_real("error", last_error(control, image));
    print_hex("voltages", log->crc);
    print_count("iterations", control->info.iterations_most);
    print_text("\ncost tick");
    print_count("mean", log->total / TICKS);
    print_count("worst", log->most);
    print_count("warm", log->warm / WARM_TICKS);
    print_count("warm_worst", log->warm_most);
    print_text(" instructions\n");
}

int main(void)
{
    demo_image image = {0};
    pzs_control control = {0};
    pzs_status status;
    loop_log log;
    int failed;

    board_start();
    status = demo_open(&image);
    if (!PZS_IS_ERROR(status))
        status =
            pzs_control_init(&control, image.problem, image.influence, image.work, image.bytes);
    if (PZS_IS_ERROR(status)) {
        print_text("start-up FAILED:");
        print_count("status", status);
        print_text("\n");
        return 1;
    }
    log = run(&control, &image);
    run_warm(&control, &image, &log);
    report(&control, &image, &log);
    failed = drill_control(&control, &image);
    print_text("cost stack");
    print_count("used", board_stack_used());
    print_text(" bytes\n");
    return failed || log.outside || PZS_IS_ERROR(log.worst);
}
