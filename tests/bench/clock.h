/*
 * Time and medians of the benches. A bench defines _POSIX_C_SOURCE 200809L before its first
 * include.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef BENCH_CLOCK_H
#define BENCH_CLOCK_H

#include <stdlib.h>
#include <time.h>

/* Microseconds of a clock. */
static inline double microseconds(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}

static inline double now(void)
{
    return microseconds(CLOCK_MONOTONIC);
}

/* Processor time of this process: what else the machine does is not in it. It costs a system call.
 */
static inline double processor_time(void)
{
    return microseconds(CLOCK_PROCESS_CPUTIME_ID);
}

static inline int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/*
 * Return the mean of the middle half of the numbers x [count], which are sorted. It is as robust as
 * the median, and finer than the resolution of the clock.
 */
static inline double middle_mean(double *x, int count)
{
    const int first = count / 4, last = count - first;
    double sum = 0;
    qsort(x, (size_t)count, sizeof *x, ascending);
    for (int k = first; k < last; k++)
        sum += x[k];
    return sum / (last - first);
}

/* Return the time between two readings of the clock that follow each other at once (us). */
static inline double clock_time(void)
{
    enum { READINGS = 4001 };
    double time[READINGS];
    for (int k = 0; k < READINGS; k++) {
        const double from = now();
        time[k] = now() - from;
    }
    return middle_mean(time, READINGS);
}

/* Sorts x [count]. */
static inline double median(double *x, int count)
{
    qsort(x, (size_t)count, sizeof *x, ascending);
    return x[count / 2];
}

#endif
