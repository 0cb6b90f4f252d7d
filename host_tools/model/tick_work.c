/* SPDX-License-Identifier: BSD-2-Clause */
/* Work of the optimiser in the longest of many simulated control ticks (tick_work.h). */
#include "tick_work.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LONGEST_HOLD = 16 };

/* Pseudo-random number in [-1, 1]; the sequence is the same in every run. */
static double random_number(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-52 - 1;
}

/*
 * Compute a target shape: the shape under random voltages of up to 1.5 times half the voltage range
 * (1.5 times half a volt without limits).
 *   wanted [targets] out  the target shape
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
 * Return the largest number of multiply-adds that the optimiser needs in a tick. It is the maximum
 * over many simulated ticks with random targets.
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
        for (int tick = 0; tick < TICK_WORK_TICKS / 3; tick++) {
            if (tick % hold == 0)
                random_target(design, &seed, wanted);
            (void)pzs_tick(&control, wanted, NULL);
        }
        most = control.info.work_most > most ? control.info.work_most : most;
    }
    return most;
}

uint64_t tick_work_longest(const design *design, uint64_t limit)
{
    const size_t bytes = pzs_control_bytes(&design->problem);
    void *work = malloc(bytes);
    double *wanted = malloc((size_t)design->targets * sizeof *wanted);
    const uint64_t most = work && wanted ? longest_work(design, limit, work, bytes, wanted) : 0;
    free(wanted);
    free(work);
    return most;
}
