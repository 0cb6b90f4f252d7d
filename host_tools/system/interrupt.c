/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Clean-up on a signal (interrupt.h). The signal handler calls only functions that POSIX permits in
 * a signal handler.
 */
#define _POSIX_C_SOURCE 200809L
#include "interrupt.h"
#include <signal.h>
#include <stddef.h>
#include <string.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static struct {
    char path[INTERRUPT_PATH];
    volatile sig_atomic_t used;
} file[INTERRUPT_FILES];
static char folder[INTERRUPT_PATH];
static volatile sig_atomic_t folder_used, group;

static void remove_folder(void)
{
    const pid_t process = fork();
    if (process == 0) {
        execl("/bin/rm", "rm", "-rf", "--", folder, (char *)NULL);
        _exit(127);
    }
    if (process > 0)
        waitpid(process, NULL, 0);
}

/*
 * End the process group of a program that pzs runs. The program may have started other programs,
 * which may run and write files for a moment longer; the function therefore waits until the group
 * is empty.
 */
static void end_group(void)
{
    enum { TRIES = 200 };
    const struct timespec moment = {0, 10000000};
    kill(-(pid_t)group, SIGTERM);
    waitpid((pid_t)group, NULL, 0);
    for (int again = 0; again < TRIES && kill(-(pid_t)group, 0) == 0; again++)
        nanosleep(&moment, NULL);
}

static void clean_up(int signal_number)
{
    for (int k = 0; k < INTERRUPT_FILES; k++)
        if (file[k].used)
            unlink(file[k].path);
    if (group > 0)
        end_group();
    if (folder_used)
        remove_folder();
    signal(signal_number, SIG_DFL);
    raise(signal_number); /* the signal stays blocked until the signal handler returns; after that
                             it ends the program */
}

void interrupt_install(void)
{
    static const int ending[] = {SIGINT, SIGTERM, SIGHUP};
    struct sigaction action, before;
    memset(&action, 0, sizeof action);
    action.sa_handler = clean_up;
    sigemptyset(&action.sa_mask);
    for (size_t k = 0; k < sizeof ending / sizeof *ending; k++)
        sigaddset(&action.sa_mask, ending[k]);
    for (size_t k = 0; k < sizeof ending / sizeof *ending; k++)
        if (sigaction(ending[k], NULL, &before) == 0 && before.sa_handler != SIG_IGN)
            sigaction(ending[k], &action, NULL);
}

int interrupt_file(const char *path)
{
    int slot = 0;
    while (slot < INTERRUPT_FILES && file[slot].used)
        slot++;
    if (slot == INTERRUPT_FILES || strlen(path) >= INTERRUPT_PATH)
        return -1;
    strcpy(file[slot].path, path);
    file[slot].used = 1;
    return slot;
}

void interrupt_forget_file(int slot)
{
    if (slot >= 0)
        file[slot].used = 0;
}

void interrupt_folder(const char *path)
{
    folder_used = 0;
    if (!path || strlen(path) >= sizeof folder)
        return;
    strcpy(folder, path);
    folder_used = 1;
}

void interrupt_group(int process)
{
    group = process;
}
