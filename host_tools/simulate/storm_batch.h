/* SPDX-License-Identifier: BSD-2-Clause */
/* Many independent simulations of a loop with a vibrating structure, in several threads. */
#ifndef STORM_BATCH_H
#define STORM_BATCH_H

#include "storm.h"

/* Largest number of simulations of a batch. */
enum { STORM_BATCH_LIMIT = 64 };

/*
 * One of several simulations that run in parallel: a storm (fast jumps of the target), or the
 * growth of a small vibration.
 */
typedef struct storm_task {
    storm_plant plant;
    int growth_ticks; /* number of ticks over which the growth of a small vibration is measured; 0:
                         the simulation is a storm (fast jumps of the target) */
} storm_task;

/*
 * Function that gets the results of the simulations of a batch in their order, from the calling
 * thread. Returns whether the batch goes on; if not, later results are discarded.
 */
typedef bool storm_visit(void *context, const storm_task *task, const storm_result *result);

/*
 * Run the simulations of a batch in several threads, which share the tables of the loop's blocks
 * (stages of the control tick). Blocks that store values in their tables, as those of laws.h do,
 * are therefore not permitted. Results do not depend on the number of threads.
 *   count in  number of simulations, at most STORM_BATCH_LIMIT
 * Returns 0, or -1 with the error of the first simulation that failed; the function `visit` has
 * then been called for those before it.
 */
int storm_batch_run(const storm_rig *rig, const storm_task *task, int count, storm_visit *visit,
                    void *context, char *error);

#endif
