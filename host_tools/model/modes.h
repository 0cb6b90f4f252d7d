/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Results for each of the shapes that a target lists as modes, taken as the target alone: its error
 * without voltage limits, at the optimum within limits, and for clipped least squares.
 */
#ifndef MODES_H
#define MODES_H

#include "voltages.h"

/* Results for one mode within one pair of limits. */
typedef struct mode_left {
    double limit[2];    /* lowest and highest voltage that any amplifier may give, V */
    double optimum;     /* shape error of the optimum within these limits */
    double clipped;     /* shape error of clipped least squares */
    double regularised; /* shape error of regularised, then clipped least squares, with the best
                           parameter for this mode */
    int active_limits;  /* number of amplifiers at a limit at the optimum */
} mode_left;

typedef struct mode {
    double size;                /* root mean square of the mode's target */
    double unconstrained_error; /* shape error without limits */
    double largest_voltage;     /* largest voltage without limits, V */
} mode;

typedef struct modes {
    int count, limits;
    mode *mode;      /* [count] in the order of the scene */
    mode_left *left; /* [count][limits] */
} modes;

/*
 * Compute the results of every mode, on the structure that analysis->nonlinear selects, after
 * analysis_influence. The design's target is unchanged afterwards.
 *   limit [limits]  in  as in voltages_optimum
 * Returns 0, or -1 with error filled; call modes_free in either case.
 */
int modes_run(modes *modes, analysis *analysis, const common_limits *limit, int limits,
              char *error);
void modes_free(modes *modes);

#endif
