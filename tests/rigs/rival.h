/*
 * Rivals: control laws of the literature and of earlier designs on a modal plant, to compare the
 * library's vibration damper with. Each runs in the loop of damped_loop.h, within the same voltage
 * limits and step limits. In double only.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef RIVAL_H
#define RIVAL_H

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
                        governor; DAMPER */
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
    double *state;   /* PPF: [2][settings.modes] position and velocity of the filters; LQG: [2 modes
                        + inputs] deviations from the static optimum */
    double *fixed;   /* PPF: [inputs] voltages without those of the filters */
    double *history; /* PPF: [delay + 1][outputs] static shapes of these voltages in the last ticks
                      */
    int tick;
    double work; /* multiply-adds of the optimiser in all ticks since the rival was opened */
    long ticks;  /* number of these ticks */
} rival;

/*
 * Make a rival for a structure and put it into a loop at rest.
 *   delay  in  age of the readings for which the rival is designed (ticks)
 *   rival  out must not be moved in memory until rival_close
 */
void rival_open(rival *rival, const modal_structure *structure, double interval, double step_limit,
                int delay, const rival_settings *settings);
void rival_close(rival *rival);

/*
 * Multiply-adds of a tick of the rival's law without its optimiser, as an efficient program needs
 * them: products of matrices that do not change with vectors.
 */
double rival_work(const rival *rival);

/* Settings of a damper that only observes: the control step then moves to the static optimum. */
damper_settings rival_observer(double kick, double drift);

#endif
