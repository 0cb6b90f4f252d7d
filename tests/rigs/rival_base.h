/*
 * Kinds and settings of the rivals (rival.h), and what their laws share.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef RIVAL_BASE_H
#define RIVAL_BASE_H

#include "../../host_tools/simulate/laws.h"
#include "damped_loop.h"

typedef enum rival_kind {
    RIVAL_STEP,        /* the library's control step without vibration damper */
    RIVAL_LEAKY,       /* leaky integrator of adaptive optics */
    RIVAL_CLIPPED,     /* least squares by the pseudo-inverse, clipped */
    RIVAL_LQG,         /* linear quadratic Gaussian control about the static optimum without limits,
                          clipped */
    RIVAL_LQG_BOUNDED, /* the same about the static optimum within the limits */
    RIVAL_PPF,         /* positive position feedback of the first modes, beside an integrator */
    RIVAL_WISH,        /* control step towards the target minus damping factors times the modes'
                          velocities */
    RIVAL_DAMPER       /* the library's vibration damper */
} rival_kind;

/* Settings of a rival. Members that its kind does not use are 0. */
typedef struct rival_settings {
    rival_kind kind;
    damper_settings damper; /* observer of the kinds that observe modes; all of RIVAL_DAMPER */
    double share;          /* part of the way to the static optimum that a tick goes; STEP, CLIPPED,
                              PPF */
    double regularisation; /* of the pseudo-inverse, relative to the mean diagonal entry of the
                              normal matrix; CLIPPED */
    double gain, leak;     /* of the integrator: LEAKY; gain alone: PPF */
    double weight; /* weight of the squared voltage changes, relative to the mean diagonal entry of
                      the normal matrix; LQG */
    size_t modes;  /* number of modes with feedback; PPF */
    double feedback, filter_ratio, filter_frequency; /* loop gain, damping ratio of the filters and
                       their frequencies relative to the modes'; PPF */
    double damping;  /* factor of the best damping factor of each mode; WISH */
    double cut;      /* phase angle in a tick (rad) up to which modes are damped in full, to twice
                        this angle less and less; 0: no such limit; WISH */
    double governor; /* part of the step limit that the governor uses for moving targets; 0: no
                        governor; DAMPER, LQG_BOUNDED */
} rival_settings;

typedef struct rival {
    law law; /* the first member, as a block's tables begin with the problem; law.next: the voltages
                before they are clipped */
    rival_settings settings;
    damped_loop loop;
    pzs_control bounded; /* finds the static optimum within the voltage limits, without step limits
                          */
    pzs_problem bounded_problem;
    void *bounded_work;
    double *memory;
    double *wide;     /* [inputs] infinite step limits of `bounded` */
    double *gradient; /* [inputs] zero: no damping gradient */
    double *feedback; /* LQG: [inputs][2 modes + inputs] feedback of position and velocity of the
                         modes and of the voltages; PPF: [inputs][settings.modes] voltages per modal
                         coordinate of the filters; WISH: [modes] damping factors */
    double *turn;     /* PPF: [settings.modes][4] propagators of the filters */
    double *state; /* PPF: [2][settings.modes] position and velocity of the filters; LQG: [2 modes
                      + inputs] deviations from the static optimum */
    double *reference; /* LQG with governor: [inputs] voltages that approach the optimum of the
                          target alone */
    double *aim;       /* LQG with governor: [inputs] this optimum */
    double *fixed;   /* [inputs] LQG: static optimum; PPF: voltages without those of the filters */
    double *history; /* PPF: [delay + 1][outputs] static shapes of these voltages in the last ticks
                      */
    int tick;
    double work; /* multiply-adds of the optimiser in all ticks since the rival was opened */
    long ticks;  /* number of these ticks */
} rival;

/* Estimates of the vibration damper of the rival's loop in the present tick. */
const pzs_damper_info *rival_estimates(const rival *rival);

/* Compute law.next: the static optimum without limits for law.required [outputs]. */
void rival_solve(rival *rival);

/* Compute and return the static optimum [inputs] within the voltage limits for law.required. */
const double *rival_solve_bounded(rival *rival);

/* Mean diagonal entry of the normal matrix of the influence matrix (m2/V2). */
double rival_scale(const rival *rival);

#endif
