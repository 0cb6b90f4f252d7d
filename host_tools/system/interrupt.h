/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Clean-up when a signal (SIGINT, SIGTERM, SIGHUP) ends the program: temporary files and a
 * temporary folder are removed, and a running child program is ended. This is the only global state
 * of the host tools, because a signal handler has no arguments for state.
 */
#ifndef INTERRUPT_H
#define INTERRUPT_H

/* Largest number of temporary files at a time, and size of a path (characters). */
enum { INTERRUPT_FILES = 8, INTERRUPT_PATH = 4096 };

/*
 * Install the signal handler, which cleans up and then ends the program by the same signal. An
 * ignored signal remains ignored.
 */
void interrupt_install(void);

/*
 * Register a file before it is created. It is removed on a signal until it is unregistered. Returns
 * the number of its slot, or -1 if no slot is free.
 */
int interrupt_file(const char *path);
void interrupt_forget_file(int slot);

/* Register a folder that is removed with all its contents on a signal; NULL: none. */
void interrupt_folder(const char *path);

/*
 * Register the process number of a child program that leads a process group, or 0 for none. The
 * whole group is ended on a signal.
 */
void interrupt_group(int process);

#endif
