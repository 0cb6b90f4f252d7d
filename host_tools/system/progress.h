/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Progress display of a long command. Where standard error is a terminal, a command that runs
 * longer than two seconds displays one line, which a timer updates twice a second and which is
 * erased before the results are printed. Otherwise nothing is displayed.
 */
#ifndef PROGRESS_H
#define PROGRESS_H

#include <stdint.h>

/* Start the timer of the progress display. */
void progress_start(void);

/*
 * Set the description of the present stage of a command and reset all counts. The text is not
 * copied and must remain valid.
 */
void progress_stage(const char *what);

/*
 * Set the number of completed parts of the present stage and the total number of its parts; total =
 * 0: the total is unknown.
 */
void progress_count(int done, int total);

/*
 * Display a counter of linear solves during the present stage. The counter must remain valid until
 * the next stage begins.
 */
void progress_solves(const uint32_t *counter);

/* Erase the displayed line and stop the progress display. */
void progress_stop(void);

#endif
