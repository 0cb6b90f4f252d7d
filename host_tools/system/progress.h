/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * What a long command is doing, on standard error where that is a terminal: from the third second
 * on one line, renewed twice a second by a timer and wiped out before the results. Nothing anywhere
 * else.
 */
#ifndef PROGRESS_H
#define PROGRESS_H

#include <stdint.h>

/* Arm the timer. */
void progress_start(void);

/* What is being done now; a constant string. Counts are forgotten. */
void progress_stage(const char *what);

/* Parts of the stage that are done; total 0: not known. */
void progress_count(int done, int total);

/* Show a counter of linear solves that runs during the stage; it must live until the next stage. */
void progress_solves(const uint32_t *counter);

/* Wipe the line out and show nothing more. */
void progress_stop(void);

#endif
