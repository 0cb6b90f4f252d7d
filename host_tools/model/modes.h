/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Results for each shape of a target that is given as a list of alternative shapes (modes of the
 * target). Each shape is taken as the only target, and its error is computed without voltage
 * limits, at the optimum within limits, and for clipped least squares.
 */
#ifndef MODES_H
#define MODES_H

#include "voltages.h"

/* Errors that remain for one alternative target shape within one pair of voltage limits. */
typedef struct mode_left {
    double limit[2]; /* lowest and highest voltage that any amplifier may give (V) */
    double optimum;  /* relative shape error of the optimal voltages within the two limits */
    double clipped;  /* relative shape error of least-squares voltages, clipped to the two limits */
    double regularised; /* relative shape error of regularised and then clipped least squares, with
                           the regularisation parameter that is best for this target shape */
    int active_limits;  /* number of amplifiers whose optimal voltage is at one of its voltage
                           limits */
} mode_left;

typedef struct mode {
    double size; /* root mean square of the target shape's displacements at the target nodes */
    double unconstrained_error; /* relative shape error of the optimum without voltage limits */
    double largest_voltage; /* largest absolute voltage of the optimum without voltage limits (V) */
} mode;

typedef struct modes {
    int count, limits;
    mode *mode; /* [count] results of each alternative target shape, in the order of the scene file
                 */
    mode_left *left; /* [count][limits] results of each alternative target shape within each pair of
                        voltage limits */
} modes;

/*
 * Compute the results of every alternative target shape, on the nonlinear structure where
 * analysis->nonlinear is 1 and on the linear one where it is 0. The influence matrix of the
 * analysis must be computed. The target of the design is restored afterwards.
 *   limit [limits] in  pairs of voltage limits that all amplifiers share; the limits of each
 *                      amplifier apply in addition
 * Returns 0, or -1 with error filled; call modes_free in either case.
 */
int modes_run(modes *modes, analysis *analysis, const common_limits *limit, int limits,
              char *error);
void modes_free(modes *modes);

#endif
