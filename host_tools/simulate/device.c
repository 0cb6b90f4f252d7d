/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Firmware in the simulated loop: build, start, exchange of voltages and readings through pipes
 * (device.h).
 */
#define _XOPEN_SOURCE 700
#include "device.h"
#include <errno.h>
#include <ftw.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#include "../system/interrupt.h"
#include "../system/program.h"
#include "../system/shipped.h"

enum {
    TICK,
    HOLD,
    RELEASE,
    KNOW,
    SKIP
}; /* orders of the simulation to the firmware, each sent as the first word of a message */
enum {
    PATIENCE = 20000 /* longest time to wait for an answer of the firmware (ms) */,
    MOST_ARGUMENTS = 16
};

#define BOARD(name, machine, bits, twin) {name, machine, bits, twin},
static const device_board boards[] = {DEVICE_BOARDS(BOARD){"host-32", NULL, 32, NULL},
                                      {"host-64", NULL, 64, NULL}};

const device_board *device_find(const char *name)
{
    for (size_t k = 0; name && k < sizeof boards / sizeof *boards; k++)
        if (strcmp(boards[k].name, name) == 0)
            return &boards[k];
    return NULL;
}

/* ---- build of the firmware -------------------------------------------- */

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
     * Temporary files of the compilers are written to the folder of the firmware, so that they are
     * removed with that folder.
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
    if (program_run(argument) == 0)
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

/* ---- messages to and from the firmware -------------------------------- */

static size_t real_bytes(const device *device)
{
    return (size_t)device->board->bits / 8;
}

/*
 * Write floating-point numbers into a message to the firmware, in the precision of the firmware.
 * Returns the address behind them.
 */
static unsigned char *put_reals(const device *device, unsigned char *at, const double *value,
                                size_t count)
{
    for (size_t i = 0; i < count; i++, at += real_bytes(device)) {
        const float rounded = (float)value[i];
        if (device->board->bits == 32)
            memcpy(at, &rounded, sizeof rounded);
        else
            memcpy(at, &value[i], sizeof value[i]);
    }
    return at;
}

static unsigned char *put_order(device *device, uint32_t order, uint32_t input)
{
    const uint32_t word[2] = {order, input};
    memcpy(device->frame, word, sizeof word);
    return device->frame + sizeof word;
}

static void get_reals(const device *device, double *value, size_t count)
{
    const unsigned char *at = device->frame;
    for (size_t i = 0; i < count; i++, at += real_bytes(device)) {
        float rounded;
        memcpy(&rounded, at, sizeof rounded);
        if (device->board->bits == 32)
            value[i] = (double)rounded;
        else
            memcpy(&value[i], at, sizeof value[i]);
    }
}

/*
 * Allocate memory for a message to the firmware that consists of an order and a number of
 * floating-point numbers. Returns whether memory was available.
 */
static int take_frame(device *device, size_t reals)
{
    unsigned char *more = realloc(device->frame, 2 * sizeof(uint32_t) + reals * sizeof(double));
    if (more)
        device->frame = more;
    return more != NULL;
}

/* Send a message to the firmware, up to the address `end`. Returns whether all bytes were sent. */
static int send(const device *device, const unsigned char *end)
{
    for (const unsigned char *at = device->frame; at < end;) {
        const ssize_t moved = write(device->to, at, (size_t)(end - at));
        if (moved <= 0)
            return -1;
        at += moved;
    }
    return 0;
}

static int receive(const device *device, void *to, size_t bytes)
{
    for (unsigned char *at = to; bytes > 0;) {
        struct pollfd wait = {device->from, POLLIN, 0};
        errno = 0;
        const int ready = poll(&wait, 1, PATIENCE);
        if (ready < 0 && errno == EINTR)
            continue; /* a call of poll that the timer of the progress display has interrupted is
                         repeated */
        const ssize_t moved = ready > 0 ? read(device->from, at, bytes) : 0;
        if (ready == 0)
            errno = ETIMEDOUT;
        if (moved <= 0)
            return -1;
        at += moved;
        bytes -= (size_t)moved;
    }
    return 0;
}

static int silent(const device *device, char error[DEVICE_ERROR])
{
    snprintf(error, DEVICE_ERROR, "%s does not answer%s", device->board->name,
             device->board->machine
                 ? "; it takes qemu-system-arm, QEMU in the environment names another"
                 : "");
    return -1;
}

/* ---- start of the firmware -------------------------------------------- */

static int launch(device *child, const char *folder)
{
    char image[DEVICE_PATH + 64];
    const char *emulator = getenv("QEMU");
    const char *const qemu[MOST_ARGUMENTS] = {emulator ? emulator : "qemu-system-arm",
                                              "-M",
                                              child->board->machine,
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
    snprintf(image, sizeof image, "%s/firmware/%s-loop", folder, child->board->name);
    signal(SIGPIPE, SIG_IGN); /* SIGPIPE is ignored, so that writing to a firmware that has ended
                                 returns an error instead of ending this program. */
    return child->process =
               program_begin(child->board->machine ? qemu : program, &child->to, &child->from);
}

int device_start(device *device, const device_board *board, const char *folder,
                 const pzs_problem *problem, int readings, double *voltage,
                 char error[DEVICE_ERROR])
{
    uint32_t about[5];
    memset(device, 0, sizeof *device);
    device->board = board;
    device->inputs = problem->inputs;
    device->outputs = problem->outputs;
    device->readings = (size_t)readings;
    if (!take_frame(device, device->inputs + device->outputs + device->readings) ||
        launch(device, folder) < 0 || receive(device, about, sizeof about) < 0)
        return silent(device, error);
    if ((int)about[0] != board->bits || about[1] != device->inputs || about[2] != device->outputs ||
        about[3] != device->readings || about[4] != PZS_OK) {
        snprintf(error, DEVICE_ERROR, "%s refuses the tables: %s", board->name,
                 pzs_status_text((pzs_status)about[4]));
        return -1;
    }
    if (receive(device, device->frame, device->inputs * real_bytes(device)) < 0)
        return silent(device, error);
    get_reals(device, voltage, device->inputs);
    return 0;
}

void device_stop(device *device)
{
    if (device->process > 0) {
        char rest;
        close(device->to); /* Closing its input makes the firmware end; only a hanging firmware must
                              be killed. */
        if (receive(device, &rest, 1) < 0 && errno == ETIMEDOUT)
            kill((pid_t)device->process, SIGKILL);
        close(device->from);
        waitpid((pid_t)device->process, NULL, 0);
    }
    free(device->frame);
    memset(device, 0, sizeof *device);
}

/* ---- orders to the firmware ------------------------------------------- */

void device_hold(device *device, int input, double voltage)
{
    if (device->process > 0)
        (void)send(device,
                   put_reals(device, put_order(device, HOLD, (uint32_t)input), &voltage, 1));
}

void device_release(device *device, int input)
{
    if (device->process > 0)
        (void)send(device, put_order(device, RELEASE, (uint32_t)input));
}

void device_skip(device *device, int ticks)
{
    if (device->process > 0)
        (void)send(device, put_order(device, SKIP, (uint32_t)ticks));
}

void device_know(device *device, const double *then, const double *coming, size_t loads)
{
    if (device->process > 0 &&
        take_frame(device, device->inputs + device->outputs + device->readings + 2 * loads))
        (void)send(device,
                   put_reals(device, put_reals(device, put_order(device, KNOW, 0), then, loads),
                             coming, loads));
}

int device_tick(device *device, const double *wanted, const double *measured, double *voltage,
                uint8_t *state, int *passes, char error[DEVICE_ERROR])
{
    uint32_t about[2];
    unsigned char *end = put_reals(device, put_order(device, TICK, 0), wanted, device->outputs);
    if (send(device, put_reals(device, end, measured, device->readings)) < 0 ||
        receive(device, about, sizeof about) < 0 ||
        receive(device, device->frame, device->inputs * real_bytes(device)) < 0 ||
        receive(device, state, device->inputs) < 0)
        return silent(device, error);
    get_reals(device, voltage, device->inputs);
    *passes = (int)about[1];
    return (int)about[0];
}
