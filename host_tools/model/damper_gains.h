/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Gains of the damper (pzs_vibration) from a modal model: propagators, observer, damping gradient.
 *
 * The observer is the stationary Kalman filter of position q, velocity p over the angular frequency
 * and static position w under loads of each mode, with (d, p) := R (d, p) in a tick, d = q - g v -
 * w, for process noise of p and w and sensor noise of variance 1. Its Riccati equation P = A P A' -
 * A P C' (C P C' + 1)^-1 C P A' + Q is solved by structured doubling. All settings are free of
 * scale: they refer to the sensors' noise and to the angle th = angular frequency times tick that a
 * mode turns in a tick.
 */
#ifndef DAMPER_GAINS_H
#define DAMPER_GAINS_H

#include <stdbool.h>
#include <stddef.h>

/* Settings of the damped tick. */
typedef struct damper_settings {
    double damping;  /* damping per radian: a mode is damped by damping * th * d in a tick */
    double cut;      /* angle up to which modes are damped in full; from twice this angle on they
                        are not damped (rad) */
    double observed; /* largest angle of an observed mode (rad) */
    double follow;   /* part of the way to the static optimum per radian of the first mode */
    double follow_limit; /* largest part of the way in one tick */
    double mix;          /* part of the deviation that comes from the change of the velocity */
    double kick;  /* RMS change of the velocity of the first mode in a tick, for one sensor */
    double drift; /* RMS change of the load on the first mode in a tick, for one sensor */
    double slow;  /* gain of the low-pass filter of what the modes do not explain */
    int later;    /* ticks by which the readings are taken to be older than the scene says; a damped
                     tick tolerates readings that are newer better than older ones */
    bool is_gradient; /* damping gradient g' k d, of which the energy decays at any limits, instead
                         of the gradient B'W^2 C d of the wanted shape C d */
} damper_settings;

/* Settings that settled on every structure of the storm tests (tests/unit/test_vibration_block.c).
 */
damper_settings damper_default_settings(void);

/* A modal model. The coordinate of a mode is scaled so that its RMS displacement is 1. */
typedef struct damper_model {
    size_t modes, inputs, sensors;
    const double *angle;   /* [modes] angular frequency times tick, ascending (rad) */
    const double *ratio;   /* [modes] damping ratio */
    const double *modal;   /* g [modes][inputs] static coordinate per volt */
    const double *overlap; /* [modes][modes] C' C of the sensors, weighted by inverse variances */
    const double *lift;    /* B'W^2 C [inputs][modes] of the outputs */
    const double *square;  /* [modes] diagonal of C'W^2 C of the outputs */
} damper_model;

/* Gains in the layout of pzs_vibration; all arrays belong to the caller. */
typedef struct damper_gains {
    double *turn;          /* [4][modes] */
    double *observer;      /* [3][modes][modes] */
    double *explain;       /* [modes][modes] */
    double *damping;       /* [modes][inputs] */
    double *inverse_angle; /* [modes] */
    double *covariance;    /* [3 modes][3 modes] solution P of the Riccati equation, or NULL */
    double share, mix, slow;
} damper_gains;

/*
 * Compute the gains. Returns 0, or -1 where memory runs out or the iteration does not converge,
 * as for numbers that are not finite.
 */
int damper_compute(damper_gains *gains, const damper_model *model, const damper_settings *settings);

#endif
