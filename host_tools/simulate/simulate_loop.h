/* SPDX-License-Identifier: BSD-2-Clause */
/* One closed loop of a simulation, tick by tick: schedule, sensors, controller, amplifiers,
 * electrodes. */
#ifndef SIMULATE_LOOP_H
#define SIMULATE_LOOP_H

#include "../model/unconstrained.h"
#include "simulation.h"

enum { PLAYS = 4 };

typedef enum electrode_fault { ELECTRODE_GOOD, ELECTRODE_DEAD, ELECTRODE_STUCK } electrode_fault;

/*
 * An electrode between its amplifier and the ceramic.
 * Hysteresis (Prandtl-Ishlinskii): a share of the voltages passes plays of half widths 1/8, 2/8,
 * 3/8, 4/8 of the half range A of the voltages. A full cycle's loop is `hysteresis` times the range
 * wide; no volt is off by more than hysteresis A.
 */
typedef struct electrode {
    electrode_fault fault;
    double held;          /* V while it does not follow */
    double play[PLAYS];   /* V behind each play */
    int failed_at;        /* tick of its last fault */
    int told_at, good_at; /* tick in which the controller is told; in which it recovers by itself;
                             -1: never */
    int is_told; /* the controller holds it, since this tick or before: it was told or has found it
                  */
    int out_since; /* first tick whose readings it takes for those without it */
} electrode;

/* A sensor: until which tick it gives NaN or stands still. */
typedef struct sensor {
    int nan_until, frozen_until;
} sensor;

/* Tables of a step block of the simulation: the problem, which the library asks for, and the loop
 * that it belongs to. */
typedef struct law_tables {
    pzs_problem problem;
    struct loop *loop;
} law_tables;

typedef struct loop {
    const design *design; /* what the controller knows */
    simulation *simulation;
    simulate_law law;
    pzs_block block[PZS_BLOCK_LIMIT]; /* of the law */
    law_tables tables;                /* of its step block, where that is none of the library */
    unconstrained solver;             /* of LAW_CLAMP and LAW_REGULARISED */
    pzs_loop controller;              /* the library's, in double */
    device board, twin;               /* in place of its step, where the simulation has a board */
    char *message;                    /* [SCENE_ERROR] of a board that does not answer */
    int is_silent;                    /* the board did not answer */
    uint64_t random;                  /* state of the generator */
    int next_event, lost_until;
    double factor, scheduled_factor; /* of the target */
    double *memory;                  /* all vectors below */
    double *goal;   /* [targets] target of the scene or the schedule, without its factor */
    double *wanted; /* [targets] */
    double *load, *scheduled_load; /* [loads + 1] amounts, the temperature last */
    double *shape;                 /* [targets] of the plant */
    double *wish;                  /* [targets] error for the clamped law; room before that */
    double *disturbance;           /* [targets] of the clamped law */
    double *command;               /* [amplifiers] of the controller */
    double *given;                 /* [amplifiers] by the amplifiers */
    double *effect;                /* [amplifiers] what the ceramic makes of them */
    double *next, *last;           /* [amplifiers] room; before the tick */
    electrode *electrode;          /* [amplifiers] */
    int sensors;                   /* one for each target, or those of the scene's estimate */
    sensor *sensor;                /* [sensors] */
    double *sense_memory;          /* the vectors down to coming */
    double *noise;                 /* [sensors] standard deviation */
    double *reading;               /* [sensors] last ones */
    double *sensed; /* [sensors] handed on: what the model has moved by since is added to late ones
                     */
    double *expected, *said; /* [sensors] by the model under the command, and under that of late
                                readings */
    double *late_reading;    /* [delay + 1][sensors] without noise, of the last ticks */
    double *late_command;    /* [delay + 1][amplifiers] */
    double *late_known;      /* [delay + 1][loads] */
    double *predicted;       /* [targets] the model's shape under the command */
    double *known, *coming;  /* [loads] amounts that the controller knows of, now and in the next
                                tick */
    double missed;           /* of the last shape by the measurement, over the scene's target */
    uint8_t *state, *twin_state; /* [amplifiers] of the watch */
    void *work;                  /* of the controller */
    double error;                /* of the last shape */
    pzs_status status;           /* of the last tick */
    int iterations;
    int same;                 /* board and twin agree in every bit */
    int found, wrong, search; /* electrodes found in the last tick; those of them that had no fault;
                                 longest search, ticks */
    int is_lost, beyond, not_finite; /* of the last tick */
} loop;

/* Start: plant at rest, voltages as the controller's. Returns 0, or -1 with error filled; close it
 * in either case. */
int loop_open(loop *loop, simulation *simulation, simulate_law law, char *error);
void loop_close(loop *loop);

/* One tick. Returns 0, or -1 with error filled: the plant has no equilibrium or the controller
 * refuses. */
int loop_tick(loop *loop, int tick, char *error);

/* Voltages given that are at a limit. */
int loop_active(const loop *loop);

/* ---- simulate_sense.c: what the controller gets to know --------------- */

/* Room for it. Returns whether memory was there; close it in either case. */
int sense_open(loop *loop);
void sense_close(loop *loop);

/* The model's shape under the command, which the tables alone make. */
void sense_predict(loop *loop);

/* Readings of the plant in its last shape, late and noisy as they are: `sensed`. Returns 0, or -1
 * with error filled. */
int sense_tick(loop *loop, int tick, char *error);

/* What the controller's measured shape misses of the plant's: `missed`. */
void sense_missed(loop *loop);

/* Amounts of known loads at the readings of a tick. [loads] */
const double *sense_known(const loop *loop, int tick);

/*
 * An electrode is held from a tick on: what late readings show since then was made with the
 * voltages it is held at, whatever its amplifier was told. Otherwise its leaving would count as a
 * motion that the readings are yet to show.
 */
void sense_taken_out(loop *loop, int amplifier, int since, int tick);

/* From 0 to 1, 1 left out: the loop's random numbers. */
double loop_draw(loop *loop);

#endif
