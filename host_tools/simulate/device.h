/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The controller of a simulation as firmware: built from firmware_demo with the tables of the
 * simulation, run by QEMU on a board's processor, or as a program of this computer, with the plant
 * at the other end of a pipe. firmware_demo/demos/demo_loop.c says what goes over it.
 */
#ifndef DEVICE_H
#define DEVICE_H

#include "pzs.h"

typedef struct device_board {
    const char *name;
    const char *machine; /* QEMU's name of the board; NULL: a program of this computer */
    int bits;            /* of its reals */
    const char *twin;    /* the same C in the same precision on this computer */
} device_board;

/* Board of a name, or NULL. name may be NULL */
const device_board *device_find(const char *name);

/* Room for a path, and for a message: one line. */
enum { DEVICE_PATH = 256, DEVICE_ERROR = 400 };

/*
 * A folder for the firmware: write the tables into folder/loop.h (prefix demo), then build.
 * Return 0, or -1 with error filled; the compiler's own words are on standard error.
 */
int device_folder(char folder[DEVICE_PATH], char error[DEVICE_ERROR]);
int device_build(const device_board *board, const char *folder, char error[DEVICE_ERROR]);
void device_remove(const char *folder);

/* A firmware that runs. All zero: none does, and orders to it are left out. */
typedef struct device {
    const device_board *board;
    int process, to, from;            /* its pipe */
    size_t inputs, outputs, readings; /* readings: length of measured */
    unsigned char *frame;
} device;

/* Start it. readings: length of its readings; volt [inputs] out: those it starts with (V). Returns
 * 0, or -1 with error filled. */
int device_start(device *d, const device_board *board, const char *folder,
                 const pzs_problem *problem, int readings, double *voltage,
                 char error[DEVICE_ERROR]);
void device_stop(device *d);

/* pzs_hold, pzs_release. What goes wrong shows in the next tick. */
void device_hold(device *d, int input, double voltage);
void device_release(device *d, int input);

/* Known loads of the tables: amounts at the next measurement, and to come. then, coming [loads] in
 */
void device_know(device *d, const double *then, const double *coming, size_t loads);

/*
 * pzs_loop_tick. wanted [outputs], measured [readings] in; volt, state [inputs], passes out: state
 * of the electrodes, 0 where no block tells it. Returns its status, or -1 with error filled: the
 * device no longer answers.
 */
int device_tick(device *d, const double *wanted, const double *measured, double *voltage,
                uint8_t *state, int *passes, char error[DEVICE_ERROR]);

#endif
