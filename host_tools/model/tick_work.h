/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Work of a control tick on a device: the bound that the limit of the work gives, and the longest
 * of many ticks whose targets jump.
 */
#ifndef TICK_WORK_H
#define TICK_WORK_H

#include "analysis.h"

/*
 * Instructions of a Cortex-M4F, float, compiled with -Os, as tests/bench/count_work.sh counts them
 * under QEMU: of a multiply-add with the influence matrix, of a multiply-add of the optimiser, of
 * an output in all other loops. A tick takes no more than their sum.
 */
#define TICK_WORK_PER_PRODUCT 3.0
#define TICK_WORK_PER_OPTIMISER 7.0
#define TICK_WORK_PER_OUTPUT 50.0
#define TICK_WORK_CYCLES 2.0   /* assumed cycles of an instruction */
#define TICK_WORK_OTHERS 20000 /* instructions left to the other blocks of the tick */

typedef struct tick_work {
    bool is_made;
    bool is_limited;     /* the limit follows from clock and rate, otherwise it is the default */
    uint64_t limit;      /* limit of the optimiser's work (multiply-adds) */
    uint64_t bound;      /* most multiply-adds of a tick: PZS_STEP_WORK */
    uint64_t measured;   /* multiply-adds of the optimiser in the longest tick */
    int ticks;           /* number of ticks made to find it */
    double instructions; /* bound of the instructions of a tick */
    double longest;      /* instructions of the longest tick made */
    double rate;         /* highest tick rate at the scene's clock (1/s); 0 without a clock */
    bool holds;          /* the scene's rate is not above it, or is not given */
} tick_work;

/*
 * Limit of the optimiser's work that clock and rate of the scene leave, at least PZS_WORK_LEAST; 0
 * if one of them is not given.
 */
uint64_t tick_work_limit(const design *design);

/* Fill `work`, with is_made false where the scene has no amplifiers or targets. */
void tick_work_make(tick_work *work, const design *design);

#endif
