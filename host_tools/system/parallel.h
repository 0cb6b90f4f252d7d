/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Independent parts of a computation in several threads. The results do not depend on the number of
 * threads: parts begin in their order, and their results are accepted in their order, by the
 * calling thread, until one of them ends the work.
 */
#ifndef PARALLEL_H
#define PARALLEL_H

#include <stdbool.h>

/* Largest number of threads. */
enum { PARALLEL_LIMIT = 64 };

typedef struct parallel_work {
    void *context;
    /*
     * Compute one part of the work that several threads share; called from any thread. The function
     * writes nothing that another part reads or writes; errors are stored with the results of the
     * part.
     */
    void (*run)(void *context, int part);
    /*
     * Accept the result of one part of the work that several threads share, after the results of
     * all parts before it. Returns whether the work goes on; if not, the parts behind this one, of
     * which some may have run, are not accepted.
     */
    bool (*accept)(void *context, int part);
} parallel_work;

/*
 * Number of threads that a computation uses: the value of the environment variable PZS_THREADS, if
 * it is a number from 1 to PARALLEL_LIMIT, otherwise the number of available processors.
 */
int parallel_threads(void);

/*
 * Run all parts of a work, numbered from 0. Signals are left to the calling thread. Where the
 * system refuses threads or memory, fewer threads run the same parts.
 */
void parallel_run(const parallel_work *work, int parts);

#endif
