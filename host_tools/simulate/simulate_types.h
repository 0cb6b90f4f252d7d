/* Types of a closed-loop simulation: laws, samples, phases, counts, and the simulation itself. */
#ifndef SIMULATE_TYPES_H
#define SIMULATE_TYPES_H

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
    const double *command; /* [amplifiers] volts asked for */
    const double *volt;    /* [amplifiers] volts that the amplifiers give */
    int active, passes;    /* volts at a limit; passes of the optimiser */
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
    int slew_ticks; /* what the slew alone needs from the volts before to those at the end */
    double *volt;   /* [amplifiers] at the end */
    double *shape;  /* [targets] */
    double *u;      /* [dof] */
} simulate_course;

/* From one tick with events to the next. */
typedef struct simulate_phase {
    int from, until;
    int first, events; /* of the scene, that begin it */
    double optimum;    /* error of the best volts for this plant in the same limits; NAN before
                          simulate_optima */
    simulate_course course[LAWS];
    double *target; /* [targets] conditions at its end: wanted, */
    double *amount; /* [loads] amounts of the plant's loads, its temperature the last, */
    double *held;   /* [amplifiers] volts of electrodes that do not follow, else NAN */
} simulate_phase;

/* Counts over all ticks. */
typedef struct simulate_count {
    long beyond;     /* volts beyond limit or slew, commanded or given */
    long not_finite; /* volts */
    long passes;     /* of all ticks */
    int passes_most;
    long status[PZS_W_UNSTABLE + 1]; /* ticks that ended with each */
    long lost;
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

#endif
