/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Results for each shape of a target that is given as a list of alternative shapes (modes of the
 * target). Each shape is taken as the only target, and its error is computed without voltage
 * limits, at the optimum within limits, and for clipped least squares.
 */
#ifndef MODES_H
#define MODES_H

#include "voltages.h"

/*
 * Shape errors for one target shape within one pair of voltage limits, if the scene gives a list of
 * target shapes: errors of the optimal voltages, and of other voltages for comparison.
 */
typedef struct mode_left {
    double limit[2];    /* lowest and highest voltage that any amplifier may give (V) */
    double optimum;     /* relative shape error of the optimal voltages within the voltage limits
                           (member `limit`) */
    double clipped;     /* relative shape error of least-squares voltages, clipped to the lowest and
                           highest voltage */
    double regularised; /* relative shape error of regularised and then clipped least squares, with
                           the regularisation parameter that is best for this target shape */
    int active_limits;  /* number of amplifiers whose optimal voltage is at one of its voltage
                           limits */
} mode_left;

typedef struct mode {
    double size; /* root mean square of the target shape's displacements at the target nodes */
    double unconstrained_error; /* relative shape error that the optimal voltages without limits
                                   leave for the target shape */
    double largest_voltage; /* largest absolute value of the optimal voltages without limits for the
                               target shape (V) */
} mode;

typedef struct modes {
    int count, limits;
    mode *mode; /* [count] results of each target shape, in the order in which the scene file lists
                   the shapes */
    mode_left *left; /* [count][limits] results of each target shape that the scene file lists,
                        within each pair of voltage limits */
} modes;

/*
 * Compute the results of every target shape of a scene that lists several as alternatives, linear
 * or nonlinear as analysis->is_nonlinear says. Needs the influence matrix. Afterwards the analysis
 * has the same target as before.
 *   limit  [limits] in  pairs of voltage limits that are tried one after the other. Each pair
 *       applies to all amplifiers, in addition to their own limits
 * Returns 0, or -1 with error filled; call modes_free in either case.
 */
int modes_run(modes *modes, analysis *analysis, const common_limits *limit, int limits,
              char *error);
void modes_free(modes *modes);

#endif
