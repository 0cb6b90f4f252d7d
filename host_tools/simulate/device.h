/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The controller of a simulation as firmware, built from firmware_demo with the tables of the
 * simulation. It runs in QEMU on the processor of a board, or as a program on this computer. Pipes
 * connect it to the simulated plant; firmware_demo/demos/demo_loop.c describes the protocol.
 */
#ifndef DEVICE_H
#define DEVICE_H

#include "pzs.h"

typedef struct device_board {
    const char *name;
    const char *machine; /* QEMU's name of the board; NULL: the firmware is a program on this
                            computer */
    int bits;            /* bits of a floating-point number of the firmware: 32 or 64 */
    const char *twin; /* name of the board's twin, such as host-32: a program on this computer that
                         runs the C code of the firmware in the precision of the board */
} device_board;

/*
 * Table of the microcontroller boards that QEMU emulates; the targets of firmware.mk have the same
 * names. A row holds the name of the board, its name in QEMU, the bits of a floating-point number
 * of its firmware, and its twin (a program on this computer with the same code).
 */
#define DEVICE_BOARDS(ROW)                                                                         \
    ROW("netduinoplus2", "netduinoplus2", 32, "host-32")                                           \
    ROW("mps2-an386", "mps2-an386", 32, "host-32")                                                 \
    ROW("mps2-an500", "mps2-an500", 64, "host-64")

/*
 * Return the microcontroller board with a given name, or NULL if there is none. The name may be
 * NULL.
 */
const device_board *device_find(const char *name);

/* Sizes (characters) of two texts: the path of a firmware, and an error message of one line. */
enum { DEVICE_PATH = 256, DEVICE_ERROR = 400 };

/*
 * device_folder makes a temporary folder, in which the caller writes the tables of the control loop
 * as loop.h with the prefix `demo`. device_build builds the firmware there, with compiler messages
 * on standard error. Both return 0, or -1 with error filled. device_remove removes the folder.
 */
int device_folder(char folder[DEVICE_PATH], char error[DEVICE_ERROR]);
int device_build(const device_board *board, const char *folder, char error[DEVICE_ERROR]);
void device_remove(const char *folder);

/*
 * A running firmware, with which the simulation exchanges messages. Where all members of the struct
 * are zero there is no firmware, and device_hold, device_release, device_skip and device_know do
 * nothing.
 */
typedef struct device {
    const device_board *board;
    int process, to, from; /* process number of the firmware; file descriptors of the pipes to and
                              from that process */
    size_t inputs, outputs, readings; /* numbers of voltages, of target displacements and of sensor
                                         readings that the simulation and the firmware exchange in
                                         each tick */
    unsigned char *frame;
} device;

/*
 * Start a firmware.
 *   readings         in   number of readings passed in each tick
 *   voltage [inputs] out  initial voltages of the firmware (V)
 * Returns 0, or -1 with error filled.
 */
int device_start(device *device, const device_board *board, const char *folder,
                 const pzs_problem *problem, int readings, double *voltage,
                 char error[DEVICE_ERROR]);
void device_stop(device *device);

/*
 * Call pzs_hold (fix an input at a voltage) or pzs_release in the firmware. If the call fails, the
 * next device_tick reports it.
 */
void device_hold(device *device, int input, double voltage);
void device_release(device *device, int input);

/* Call pzs_loop_skip in the firmware, which informs the firmware of a number of missed ticks. */
void device_skip(device *device, int ticks);

/*
 * Pass the factors of the known loads to the firmware, for its next tick (pzs_loop_know). Known
 * loads are those of whose values the controller is informed.
 *   then   [loads] in  factors at the time at which the readings were taken that the next tick uses
 *   coming [loads] in  factors in the interval after the next tick, in which its voltages will act
 */
void device_know(device *device, const double *then, const double *coming, size_t loads);

/* Call pzs_loop_tick (one tick of the control loop) in the firmware. */
int device_tick(device *device, const double *wanted, const double *measured, double *voltage,
                uint8_t *state, int *passes, char error[DEVICE_ERROR]);

#endif
