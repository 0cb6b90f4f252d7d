/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Computing work of a control tick on a device: the upper bound that follows from the limit of the
 * optimiser's work, and the work of the longest of many simulated ticks in which the target jumps.
 */
#ifndef TICK_WORK_H
#define TICK_WORK_H

#include "analysis.h"

/*
 * Instructions of a Cortex-M4F in single precision, compiled with -Os, counted by
 * tests/bench/count_work.sh under QEMU: for each multiply-add with the influence matrix, for each
 * multiply-add of the optimiser, and for each output in all other loops. A tick takes no more
 * instructions than their sum.
 */
#define TICK_WORK_PER_PRODUCT 3.0
#define TICK_WORK_PER_OPTIMISER 7.0
#define TICK_WORK_PER_OUTPUT 50.0
#define TICK_WORK_CYCLES 2.0 /* assumed number of clock cycles per instruction */
#define TICK_WORK_OTHERS                                                                           \
    20000 /* instructions per tick that are reserved for all but the control step */

typedef struct tick_work {
    bool is_made;
    bool is_limited;     /* true where the limit of the optimiser's work follows from clock and tick
                            rate of the scene; false where it is the default of the library */
    uint64_t limit;      /* limit of the optimiser's work in one tick (multiply-adds) */
    uint64_t bound;      /* largest possible number of multiply-adds in one tick (PZS_STEP_WORK) */
    uint64_t measured;   /* multiply-adds of the optimiser in the longest tick that was computed */
    int ticks;           /* number of ticks that were computed to find the longest one */
    double instructions; /* upper bound of the number of instructions in one tick */
    double longest;      /* number of instructions in the longest tick that was computed */
    double rate; /* highest tick rate that the scene's clock allows (1/s); 0 where the scene file
                    gives no clock */
    bool holds;  /* true where the scene's tick rate is at most `rate`, or the scene file lacks the
                    clock or the tick rate */
} tick_work;

/*
 * Limit of the optimiser's work in one tick (multiply-adds) that processor clock and tick rate of
 * the scene allow, at least PZS_WORK_LEAST; 0 where the scene file does not give both. With a
 * governor, each tick also computes the static optimum for the moving target; the optimisation for
 * this static optimum and the control step may each take half of the tick.
 */
uint64_t tick_work_limit(const design *design);

/*
 * Fill `work` with the computing work of a tick. The member is_made is false where the scene has no
 * amplifiers or no targets.
 */
void tick_work_make(tick_work *work, const design *design);

#endif
