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
 * Register a temporary file before the file is created. A signal that ends pzs removes the file
 * unless it has been unregistered. Returns the number of the slot of the file, or -1 if no slot is
 * free.
 */
int interrupt_file(const char *path);
void interrupt_forget_file(int slot);

/*
 * Register a temporary folder, which a signal that ends pzs removes with all its contents. NULL: no
 * folder.
 */
void interrupt_folder(const char *path);

/*
 * Register the process number of a child program that leads a process group, or 0 for none. A
 * signal that ends pzs also ends all processes of the group.
 */
void interrupt_group(int process);

#endif
