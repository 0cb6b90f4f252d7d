/*
 * The shapes that a target lists as modes, each asked for alone: what is left of it without limits
 * on the volts, at best within limits, and where the volts without limits are simply cut.
 */
#ifndef MODES_H
#define MODES_H

#include "voltages.h"

/* One mode within one pair of limits. */
typedef struct mode_left {
    double limit[2];    /* V, lowest and highest that any amplifier may give */
    double optimum;     /* shape error of the best volts within them */
    double clipped;     /* of clipped least squares, */
    double regularised; /* and regularised before with the best parameter of this mode */
    int active_limits;  /* amplifiers at a limit at the optimum */
} mode_left;

typedef struct mode {
    double size;                /* root mean square of what is wanted */
    double unconstrained_error; /* shape error without limits, */
    double largest_voltage;     /* and the largest volt it takes */
} mode;

typedef struct modes {
    int count, limits;
    mode *mode;      /* [count] in the order of the scene */
    mode_left *left; /* [count][limits] */
} modes;

/*
 * After analysis_influence, on the structure asked about (a->nonlinear); the design's target is as
 * before afterwards. limit  in  [limits] as in voltages_optimum Returns 0, or -1 with error filled;
 * modes_free in either case.
 */
int modes_run(modes *modes, analysis *analysis, const common_limits *limit, int limits,
              char *error);
void modes_free(modes *modes);

#endif
