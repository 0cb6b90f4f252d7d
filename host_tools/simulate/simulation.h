/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * A closed loop on the host: the library's controller with the tables of the scene, a plant it does
 * not quite know, sensors and amplifiers with their faults, and the scene's schedule. Quasi-static,
 * one shape a tick:
 *
 *   events, shape under the voltages of the tick before, measurement, controller, amplifiers
 *
 * The controller is the library's own here, or a firmware with the same tables on a board
 * (simulate_device). The same scene gives the same bits in every run. Beside the controller the
 * same loop runs with what is often done instead: least squares without limits, cut to limits and
 * step limit; and the same with the regularisation parameter that is the best one for the scene's
 * target and limits on the controller's own model.
 */
#ifndef SIMULATION_H
#define SIMULATION_H

#include "device.h"
#include "../model/estimator.h"
#include "plant.h"

struct loop_blocks;

/* LAW_CLAMP: clipped least squares; LAW_REGULARISED: the same, regularised. */
typedef enum simulate_law { LAW_CONTROLLER, LAW_CLAMP, LAW_REGULARISED, LAWS } simulate_law;

/* What a tick came to. */
typedef struct simulate_sample {
    simulate_law law;
    int tick;
    double error;  /* of the shape at its start: |W (shape - wanted)| / |W target of the scene| */
    double missed; /* |W (shape - what the controller takes it for)| / the same */
    const double *command;  /* [amplifiers] voltages asked for */
    const double *voltage;  /* [amplifiers] voltages that the amplifiers give */
    int active, iterations; /* voltages at a limit; iterations of the optimiser */
    pzs_status status;
    int lost; /* the controller did not run */
} simulate_sample;

typedef void simulate_watch(void *context, const simulate_sample *sample);

/* What one law came to in one phase. */
typedef struct simulate_course {
    double steady; /* error: root mean square over the last ticks */
    double worst;  /* largest error */
    double missed; /* root mean square over the last ticks of what the controller does not see */
    int settled;   /* ticks until the shape stays within 5 % of its way to the last one; -1: it does
                      not */
    int step_limit_ticks; /* what the step limit alone needs from the voltages before to those at
                             the end */
    double *voltage;      /* [amplifiers] at the end */
    double *shape;        /* [targets] */
    double *u;            /* [dof] */
} simulate_course;

/* From one tick with events to the next. */
typedef struct simulate_phase {
    int from, until;
    int first, events; /* of the scene, that begin it */
    double optimum;    /* error of the best voltages for this plant in the same limits; NAN before
                          simulate_optima */
    simulate_course course[LAWS];
    double *target; /* [targets] conditions at its end: wanted, */
    double *amount; /* [loads] amounts of the plant's loads, its temperature the last, */
    double *held;   /* [amplifiers] voltages of electrodes that do not follow, else NAN */
} simulate_phase;

/* Counts over all ticks. */
typedef struct simulate_count {
    long beyond;     /* voltages beyond limit or step limit, commanded or given */
    long not_finite; /* voltages */
    long iterations; /* of all ticks */
    int iterations_most;
    long status[PZS_W_UNSTABLE + 1]; /* ticks that ended with each */
    long missed;
    long found, wrong; /* electrodes the controller found; those of them that had no fault */
    int search;        /* ticks of the longest search */
    long same;         /* ticks in which the device and its twin gave the same bits */
    double seconds;
} simulate_count;

typedef struct simulation {
    const analysis *nominal;
    plant plant;
    const pzs_problem *problem;      /* the controller's tables: the nominal design's */
    struct loop_blocks *blocks;      /* the list that a firmware of the scene has */
    estimator estimator;             /* its gains and known loads, where `estimates` or `feeds` */
    int estimates, feeds, quantises; /* the shape from few sensors; known loads; amplifiers with
                                        steps or a dead band */
    double reference;                /* |W target of the scene| */
    pzs_problem regularised;   /* `problem` with the parameter of LAW_REGULARISED in its effort */
    double regularisation;     /* that parameter, over tr(B'W^2 B)/n */
    const device_board *board; /* the controller runs on it; NULL: here */
    char folder[DEVICE_PATH];  /* of its firmware */
    int phases;
    simulate_phase *phase;
    simulate_count count[LAWS];
} simulation;

/*
 * Read the plant, lay out the phases.
 *   nominal in  after analysis_influence, of a scene with a simulate section; must outlive the
 * simulation Returns 0, or -1 with error filled and *s empty.
 */
int simulate_open(simulation *simulation, analysis *nominal, char *error);
void simulate_close(simulation *simulation);

/*
 * Make the tables of an analysis those of its scene's controller: nothing to do, or where the scene
 * asks for it the influence of all inputs at the nonlinear optimum that it believes in. Returns 0,
 * or -1 with error filled.
 */
int simulate_tables(analysis *nominal, char *error);

/*
 * The firmware of a board in place of the controller: built now, run by QEMU in simulate_run. Its
 * twin, the same C in the same precision on this computer, answers beside it, and every bit is
 * compared. Returns 0, or -1 with error filled.
 */
int simulate_device(simulation *simulation, const device_board *board, char *error);

/* Run all ticks under a law. watch may be NULL. Returns 0, or -1 with error filled. */
int simulate_run(simulation *simulation, simulate_law law, simulate_watch *watch, void *context,
                 char *error);

/* The optimum of each phase, after simulate_run. Returns 0, or -1 with error filled. */
int simulate_optima(simulation *simulation, char *error);

/* Ticks in which the law ran. */
long simulate_ran(const simulate_count *count);

#endif
