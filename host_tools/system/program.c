/* SPDX-License-Identifier: BSD-2-Clause */
/* Start and run other programs (program.h). */
#define _XOPEN_SOURCE 700
#include "program.h"
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>
#include "interrupt.h"

int program_begin(const char *const *argument, int *to, int *from)
{
    int in[2] = {-1, -1}, out[2] = {-1, -1};
    if (to && (pipe(in) != 0 || pipe(out) != 0))
        return -1;
    const pid_t process = fork();
    if (process >= 0 && !to)
        setpgid(process, process); /* setpgid is called both in the parent and in the child process,
                                      because either of them may run first after the fork. */
    if (process == 0) {
        if (to) {
            dup2(in[0], 0);
            dup2(out[1], 1);
            close(in[0]), close(in[1]), close(out[0]), close(out[1]);
        }
        unsetenv("MAKEFLAGS"); /* remove the variables that an outer `make` passes to pzs, because
                                  the `make` that builds a firmware would otherwise use the job
                                  slots of the outer one */
        execvp(argument[0], (char *const *)(uintptr_t)argument);
        perror(argument[0]);
        _exit(127);
    }
    if (to) {
        close(in[0]), close(out[1]);
        *to = in[1];
        *from = out[0];
        fcntl(*to, F_SETFD, FD_CLOEXEC); /* The file descriptors of the pipes are closed in any
                                            program that is started later (close-on-exec flag), so
                                            that it does not inherit them. */
        fcntl(*from, F_SETFD, FD_CLOEXEC);
    }
    return (int)process;
}

int program_run(const char *const *argument)
{
    int status = -1;
    const int process = program_begin(argument, NULL, NULL);
    interrupt_group(process > 0 ? process : 0);
    const int ended = process < 0 ? -1 : (int)waitpid((pid_t)process, &status, 0);
    interrupt_group(0);
    if (ended < 0)
        return -1;
    return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? 0 : -1;
}
