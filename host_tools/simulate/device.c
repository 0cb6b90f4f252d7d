/* SPDX-License-Identifier: BSD-2-Clause */
/* Firmware in the closed loop (device.h). */
#define _XOPEN_SOURCE 700
#include "device.h"
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#include "../system/interrupt.h"
#include "../system/shipped.h"

enum { TICK, HOLD, RELEASE, KNOW }; /* orders to the firmware, sent as the first word of a frame */
enum { PATIENCE = 20000 /* time limit of an answer (ms) */, MOST_ARGUMENTS = 16 };

static const device_board boards[] = {{"netduinoplus2", "netduinoplus2", 32, "host-32"},
                                      {"mps2-an386", "mps2-an386", 32, "host-32"},
                                      {"mps2-an500", "mps2-an500", 64, "host-64"},
                                      {"host-32", NULL, 32, NULL},
                                      {"host-64", NULL, 64, NULL}};

const device_board *device_find(const char *name)
{
    for (size_t k = 0; name && k < sizeof boards / sizeof *boards; k++)
        if (strcmp(boards[k].name, name) == 0)
            return &boards[k];
    return NULL;
}

/* ---- programs --------------------------------------------------------- */

/*
 * Start a program, either with its standard input and output connected to pipes, or without pipes
 * and as leader of a process group. Returns its process number, or -1.
 */
static int begin(const char *const *argument, int *to, int *from)
{
    int in[2] = {-1, -1}, out[2] = {-1, -1};
    if (to && (pipe(in) != 0 || pipe(out) != 0))
        return -1;
    const pid_t process = fork();
    if (process >= 0 && !to)
        setpgid(process, process); /* in parent and child, because either may run first */
    if (process == 0) {
        if (to) {
            dup2(in[0], 0);
            dup2(out[1], 1);
            close(in[0]), close(in[1]), close(out[0]), close(out[1]);
        }
        unsetenv("MAKEFLAGS"); /* variables of an enclosing make, which would share its job slots
                                  with the build */
        execvp(argument[0], (char *const *)(uintptr_t)argument);
        perror(argument[0]);
        _exit(127);
    }
    if (to) {
        close(in[0]), close(out[1]);
        *to = in[1];
        *from = out[0];
        fcntl(*to, F_SETFD, FD_CLOEXEC); /* The next program that is started must not inherit these
                                            pipes. */
        fcntl(*from, F_SETFD, FD_CLOEXEC);
    }
    return (int)process;
}

static int run(const char *const *argument)
{
    int status = -1;
    const int process = begin(argument, NULL, NULL);
    interrupt_group(process > 0 ? process : 0);
    const int ended = process < 0 ? -1 : (int)waitpid((pid_t)process, &status, 0);
    interrupt_group(0);
    if (ended < 0)
        return -1;
    return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? 0 : -1;
}

/* ---- build ------------------------------------------------------------ */

int device_folder(char folder[DEVICE_PATH], char error[DEVICE_ERROR])
{
    const char *base = getenv("TMPDIR");
    const int length =
        snprintf(folder, DEVICE_PATH, "%s/pzs-loop-XXXXXX", base && *base ? base : "/tmp");
    if (length < DEVICE_PATH && mkdtemp(folder)) {
        interrupt_folder(folder);
        return 0;
    }
    snprintf(error, DEVICE_ERROR,
             "cannot make a folder for the firmware: %.200s; set TMPDIR to one that can be written",
             folder);
    folder[0] = '\0';
    return -1;
}

int device_build(const device_board *board, const char *folder, char error[DEVICE_ERROR])
{
    char place[DEVICE_PATH + 16], b[DEVICE_PATH + 16], tables[DEVICE_PATH + 16],
        image[DEVICE_PATH + 64], twin[DEVICE_PATH + 64];
    const char *const sources = shipped_sources();
    /*
     * Temporary files of the compilers are in the same folder, so that they are removed with the
     * folder.
     */
    const char *const argument[] = {
        "env", place,   "make", "-s",   "-j2", "--no-print-directory",
        "-C",  sources, b,      tables, image, board->twin ? twin : NULL,
        NULL};
    snprintf(place, sizeof place, "TMPDIR=%s", folder);
    snprintf(b, sizeof b, "B=%s", folder);
    snprintf(tables, sizeof tables, "LOOP=%s/loop.h", folder);
    snprintf(image, sizeof image, "%s/firmware/%s-loop", folder, board->name);
    snprintf(twin, sizeof twin, "%s/firmware/%s-loop", folder, board->twin ? board->twin : "");
    if (run(argument) == 0)
        return 0;
    snprintf(error, DEVICE_ERROR,
             "the firmware of %s could not be built from %.200s; it takes make, gcc%s; PZS_SOURCES "
             "names the folder of the sources",
             board->name, sources, board->machine ? " and arm-none-eabi-gcc" : "");
    return -1;
}

static int remove_entry(const char *path, const struct stat *there, int type, struct FTW *at)
{
    (void)there;
    (void)type;
    (void)at;
    return remove(path);
}

void device_remove(const char *folder)
{
    enum { MOST_OPEN = 16 };
    if (folder[0])
        (void)nftw(folder, remove_entry, MOST_OPEN, FTW_DEPTH | FTW_PHYS);
    interrupt_folder(NULL);
}

/* ---- frames ----------------------------------------------------------- */

static size_t real_bytes(const device *d)
{
    return (size_t)d->board->bits / 8;
}

/* Write n floating-point numbers in the device's precision. Returns the address behind them. */
static unsigned char *put_reals(const device *d, unsigned char *at, const double *x, size_t n)
{
    for (size_t i = 0; i < n; i++, at += real_bytes(d)) {
        const float rounded = (float)x[i];
        if (d->board->bits == 32)
            memcpy(at, &rounded, sizeof rounded);
        else
            memcpy(at, &x[i], sizeof x[i]);
    }
    return at;
}

static unsigned char *put_order(device *d, uint32_t order, uint32_t input)
{
    const uint32_t word[2] = {order, input};
    memcpy(d->frame, word, sizeof word);
    return d->frame + sizeof word;
}

static void get_reals(const device *d, double *x, size_t n)
{
    const unsigned char *at = d->frame;
    for (size_t i = 0; i < n; i++, at += real_bytes(d)) {
        float rounded;
        memcpy(&rounded, at, sizeof rounded);
        if (d->board->bits == 32)
            x[i] = (double)rounded;
        else
            memcpy(&x[i], at, sizeof x[i]);
    }
}

/*
 * Allocate a frame for an order and a given number of floating-point numbers. Returns whether
 * memory was available.
 */
static int take_frame(device *d, size_t reals)
{
    unsigned char *more = realloc(d->frame, 2 * sizeof(uint32_t) + reals * sizeof(double));
    if (more)
        d->frame = more;
    return more != NULL;
}

/* Send the frame up to `end` to the device. */
static int send(const device *d, const unsigned char *end)
{
    for (const unsigned char *at = d->frame; at < end;) {
        const ssize_t n = write(d->to, at, (size_t)(end - at));
        if (n <= 0)
            return -1;
        at += n;
    }
    return 0;
}

static int receive(const device *d, void *to, size_t bytes)
{
    for (unsigned char *at = to; bytes > 0;) {
        struct pollfd wait = {d->from, POLLIN, 0};
        errno = 0;
        const int ready = poll(&wait, 1, PATIENCE);
        if (ready < 0 && errno == EINTR)
            continue; /* interrupted by the timer of progress.h */
        const ssize_t n = ready > 0 ? read(d->from, at, bytes) : 0;
        if (ready == 0)
            errno = ETIMEDOUT;
        if (n <= 0)
            return -1;
        at += n;
        bytes -= (size_t)n;
    }
    return 0;
}

static int silent(const device *d, char error[DEVICE_ERROR])
{
    snprintf(error, DEVICE_ERROR, "%s does not answer%s", d->board->name,
             d->board->machine ? "; it takes qemu-system-arm, QEMU in the environment names another"
                               : "");
    return -1;
}

/* ---- start ------------------------------------------------------------ */

static int launch(device *d, const char *folder)
{
    char image[DEVICE_PATH + 64];
    const char *emulator = getenv("QEMU");
    const char *const qemu[MOST_ARGUMENTS] = {emulator ? emulator : "qemu-system-arm",
                                              "-M",
                                              d->board->machine,
                                              "-kernel",
                                              image,
                                              "-display",
                                              "none",
                                              "-monitor",
                                              "none",
                                              "-serial",
                                              "none",
                                              "-semihosting-config",
                                              "enable=on,target=native",
                                              NULL};
    const char *const program[] = {image, NULL};
    snprintf(image, sizeof image, "%s/firmware/%s-loop", folder, d->board->name);
    signal(SIGPIPE, SIG_IGN); /* A write to a device that has ended must fail and not end this
                                 program. */
    return d->process = begin(d->board->machine ? qemu : program, &d->to, &d->from);
}

int device_start(device *d, const device_board *board, const char *folder,
                 const pzs_problem *problem, int readings, double *voltage,
                 char error[DEVICE_ERROR])
{
    uint32_t about[5];
    memset(d, 0, sizeof *d);
    d->board = board;
    d->inputs = problem->inputs;
    d->outputs = problem->outputs;
    d->readings = (size_t)readings;
    if (!take_frame(d, d->inputs + d->outputs + d->readings) || launch(d, folder) < 0 ||
        receive(d, about, sizeof about) < 0)
        return silent(d, error);
    if ((int)about[0] != board->bits || about[1] != d->inputs || about[2] != d->outputs ||
        about[3] != d->readings || about[4] != PZS_OK) {
        snprintf(error, DEVICE_ERROR, "%s refuses the tables: %s", board->name,
                 pzs_status_text((pzs_status)about[4]));
        return -1;
    }
    if (receive(d, d->frame, d->inputs * real_bytes(d)) < 0)
        return silent(d, error);
    get_reals(d, voltage, d->inputs);
    return 0;
}

void device_stop(device *d)
{
    if (d->process > 0) {
        char rest;
        close(d->to); /* A working firmware ends when its input is closed. */
        if (receive(d, &rest, 1) < 0 && errno == ETIMEDOUT)
            kill((pid_t)d->process, SIGKILL);
        close(d->from);
        waitpid((pid_t)d->process, NULL, 0);
    }
    free(d->frame);
    memset(d, 0, sizeof *d);
}

/* ---- orders ----------------------------------------------------------- */

void device_hold(device *d, int input, double voltage)
{
    if (d->process > 0)
        (void)send(d, put_reals(d, put_order(d, HOLD, (uint32_t)input), &voltage, 1));
}

void device_release(device *d, int input)
{
    if (d->process > 0)
        (void)send(d, put_order(d, RELEASE, (uint32_t)input));
}

void device_know(device *d, const double *then, const double *coming, size_t loads)
{
    if (d->process > 0 && take_frame(d, d->inputs + d->outputs + d->readings + 2 * loads))
        (void)send(d,
                   put_reals(d, put_reals(d, put_order(d, KNOW, 0), then, loads), coming, loads));
}

int device_tick(device *d, const double *wanted, const double *measured, double *voltage,
                uint8_t *state, int *passes, char error[DEVICE_ERROR])
{
    uint32_t about[2];
    unsigned char *end = put_reals(d, put_order(d, TICK, 0), wanted, d->outputs);
    if (send(d, put_reals(d, end, measured, d->readings)) < 0 ||
        receive(d, about, sizeof about) < 0 ||
        receive(d, d->frame, d->inputs * real_bytes(d)) < 0 || receive(d, state, d->inputs) < 0)
        return silent(d, error);
    get_reals(d, voltage, d->inputs);
    *passes = (int)about[1];
    return (int)about[0];
}
