/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Progress display of a long command. It needs a terminal as standard error; otherwise nothing is
 * displayed. A command that runs longer than two seconds displays one line, which a timer updates
 * twice a second. The line is erased before the results are printed.
 */
#ifndef PROGRESS_H
#define PROGRESS_H

#include <stdint.h>

/* Start the timer of the progress display. */
void progress_start(void);

/*
 * Set the text that describes what the command does at present, such as "solving", and reset all
 * counts. The text is not copied and must remain valid.
 */
void progress_stage(const char *what);

/*
 * Set how many parts of its present work a command has completed, and how many parts there are in
 * total; total = 0: the total number is unknown.
 */
void progress_count(int done, int total);

/*
 * Display the present value of a counter of linear solves. The counter must remain valid until the
 * next call of progress_stage, which begins another part of the command.
 */
void progress_solves(const uint32_t *counter);

/* Erase the displayed line and stop the progress display. */
void progress_stop(void);

#endif
