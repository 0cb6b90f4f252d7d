/*
 * The gains by which a firmware estimates the shape from a few sensors, and what they can see.
 *
 * The shape is y = B v + A a: what the volts make, and disturbances a of mean 0 and variance 1, the
 * columns of A: loads and the electrodes' own, times the standard deviations of the scene. The
 * sensors show s = S v + C a + noise. The best estimate is y = B v + G (s - S v), G = A C' (C C' +
 * N^2)^-1, and misses A (1 + C' N^-2 C)^-1 A' in the mean.
 */
#ifndef ESTIMATOR_H
#define ESTIMATOR_H

#include "analysis.h"

typedef struct estimator {
    int sensors, disturbances;
    int rank;               /* combinations of disturbances that show above the noise */
    double condition;       /* the clearest over the faintest of them */
    double disturbed;       /* |W y| expected of the disturbances, root mean square */
    double remaining;       /* what the estimate leaves of it */
    double worst_disturbed; /* the same along the direction that is missed most */
    double worst_remaining;
    double *worst;            /* [targets] that direction, its largest entry 1 */
    int worst_target;         /* where that is */
    double *direct, *gain;    /* S [sensors][amplifiers], G [targets][sensors] */
    double *shape_per_load;   /* [targets][loads] shape per unit of each load */
    double *reading_per_load; /* [sensors][loads] what the sensors show per unit of each */
    pzs_estimator tables;
    pzs_feed_forward_table shape_table, reading_table; /* none without loads, or sensors */
} estimator;

/*
 * Gains of a scene with an estimate section, from its structure at rest; of another only `known`.
 *   a in  after analysis_influence
 * Returns 0, or -1 with error filled and *e empty: also where the estimate would miss more than the
 * scene's tolerance.
 */
int estimator_open(estimator *estimator, const analysis *analysis, char *error);
void estimator_close(estimator *estimator);

/* What the sensors see, in one line for people. */
void estimator_text(const estimator *estimator, const analysis *analysis, char text[SCENE_ERROR]);

#endif
