/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * What a signal that ends the program (SIGINT, SIGTERM, SIGHUP) must not leave behind: temporary
 * files, a temporary folder, a running program. The one place of the host tools with global state,
 * as a signal handler has no other.
 */
#ifndef INTERRUPT_H
#define INTERRUPT_H

/* Most temporary files at a time; room for a path. */
enum { INTERRUPT_FILES = 8, INTERRUPT_PATH = 4096 };

/* Clean up on a signal, then end by it. A signal that is ignored stays ignored. */
void interrupt_install(void);

/* Remove a file on a signal, from before it is made until it is forgotten. Returns its slot, or -1
 * where none is free. */
int interrupt_file(const char *path);
void interrupt_forget_file(int slot);

/* Remove a folder with all its contents; NULL: none. */
void interrupt_folder(const char *path);

/* End a program that was started as the leader of a process group, with all of its group; 0: none.
 */
void interrupt_group(int process);

#endif
