/* SPDX-License-Identifier: BSD-2-Clause */
/* Start and run other programs. */
#ifndef PROGRAM_H
#define PROGRAM_H

/*
 * Start a program, either with its standard input and output connected to pipes, or without pipes
 * and as the leader of a process group.
 *   argument in   name and arguments of the program, ended by NULL
 *   to, from out  file descriptors of the pipes to the program and from the program; NULL: no pipes
 * Returns the process number, or -1 on failure.
 */
int program_begin(const char *const *argument, int *to, int *from);

/*
 * Run a program to its end. A signal that ends pzs also ends the program and its children. Returns
 * 0 where the program ends with exit code 0, otherwise -1.
 */
int program_run(const char *const *argument);

#endif
