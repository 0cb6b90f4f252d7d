/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Computing work of a control tick: upper bound, and work of the longest of many simulated ticks
 * (tick_work.h).
 */
#include "tick_work.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TICKS = 2000, LONGEST_HOLD = 16 };

/* Number of multiply-adds with the influence matrix in one tick. */
static double products(const design *design)
{
    return 2.0 * design->amplifiers * design->targets;
}

/* Number of instructions of a tick in which the optimiser makes `work` multiply-adds. */
static double instructions(const design *design, double work)
{
    return TICK_WORK_PER_PRODUCT * products(design) + TICK_WORK_PER_OUTPUT * design->targets +
           TICK_WORK_PER_OPTIMISER * work;
}

uint64_t tick_work_limit(const design *design)
{
    const scene_control *control = &design->control;
    const uint32_t inputs = (uint32_t)design->amplifiers;
    const uint32_t rows = (uint32_t)design->limits.rows;
    const uint64_t least =
        rows > 0 ? PZS_LIMIT_ROW_WORK_LEAST(inputs, rows) : PZS_WORK_LEAST(inputs);
    if (!(control->clock > 0) || !(control->rate > 0))
        return 0;
    const double allowed = control->clock / control->rate / TICK_WORK_CYCLES - TICK_WORK_OTHERS;
    const int steps = control->moving_target ? 2 : 1; /* with a governor, each tick also computes
                                                         the static optimum for the moving target,
                                                         which is a second voltage problem */
    const double left = (allowed / steps - instructions(design, 0)) / TICK_WORK_PER_OPTIMISER;
    const double most = fmin(left, (double)PZS_WORK_LIMIT(inputs + rows));
    return most > (double)least ? (uint64_t)most : least;
}

/* Pseudo-random number in [-1, 1]; the sequence is the same in every run. */
static double random_number(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-52 - 1;
}

/*
 * Compute a target that is the shape under random voltages of up to 1.5 times the limits.
 *   wanted [targets] out
 */
static void random_target(const design *design, uint64_t *seed, double *wanted)
{
    memset(wanted, 0, (size_t)design->targets * sizeof *wanted);
    for (int k = 0; k < design->amplifiers; k++) {
        const double lower = design->problem.lower[k], upper = design->problem.upper[k];
        const double room = isfinite(upper - lower) ? upper - lower : 1;
        const double voltage = .75 * room * random_number(seed);
        for (int i = 0; i < design->targets; i++)
            wanted[i] += voltage * design->problem.influence[i * design->amplifiers + k];
    }
}

/*
 * Largest number of multiply-adds that the optimiser needs in one of many ticks with random
 * targets.
 */
static uint64_t longest_work(const design *design, uint64_t limit, void *work, size_t bytes,
                             double *wanted)
{
    pzs_problem problem = design->problem;
    pzs_control control;
    uint64_t most = 0, seed = 1;
    for (int hold = 1; hold <= LONGEST_HOLD; hold *= 4) {
        if (pzs_problem_seal(&problem) != PZS_OK ||
            pzs_control_init(&control, &problem, NULL, work, bytes) != PZS_OK)
            return 0;
        control.settings.work_limit = limit;
        for (int tick = 0; tick < TICKS / 3; tick++) {
            if (tick % hold == 0)
                random_target(design, &seed, wanted);
            (void)pzs_tick(&control, wanted, NULL);
        }
        most = control.info.work_most > most ? control.info.work_most : most;
    }
    return most;
}

void tick_work_make(tick_work *result, const design *design)
{
    const uint32_t amplifiers = (uint32_t)design->amplifiers, targets = (uint32_t)design->targets;
    const scene_control *control = &design->control;
    memset(result, 0, sizeof *result);
    if (amplifiers == 0 || targets == 0 || design->problem.influence == NULL)
        return;
    const size_t bytes = pzs_control_bytes(&design->problem);
    void *work = malloc(bytes);
    double *wanted = malloc(targets * sizeof *wanted);
    if (work && wanted) {
        const uint64_t given = tick_work_limit(design);
        result->is_made = true;
        result->is_limited = given > 0;
        result->limit =
            given > 0 ? given : PZS_WORK_LIMIT((size_t)amplifiers + (size_t)design->limits.rows);
        result->bound = PZS_STEP_WORK(amplifiers, targets, result->limit);
        result->measured = longest_work(design, result->limit, work, bytes, wanted);
        result->ticks = TICKS / 3 * 3;
        result->instructions = instructions(design, (double)result->limit);
        result->longest = instructions(design, (double)result->measured);
        const double all = TICK_WORK_CYCLES * (result->instructions + TICK_WORK_OTHERS);
        result->rate = control->clock / all;
        result->holds = !(control->clock > 0) || result->rate >= control->rate * (1 - 1e-9);
    }
    free(wanted);
    free(work);
}
