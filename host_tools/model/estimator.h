/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Gains by which a firmware estimates the shape from a few sensors, and how well these determine
 * the shape.
 *
 * The shape is y = B v + A a: the effect of the voltages v, and disturbances a of mean 0 and
 * variance 1. The columns of A are the effects of loads and of deviations of the electrodes'
 * voltages, times the standard deviations of the scene. The sensors read s = S v + C a + noise. The
 * best linear estimate is y = B v + G (s - S v) with G = A C' (C C' + N^2)^-1; the covariance of
 * its error is A (1 + C' N^-2 C)^-1 A'.
 */
#ifndef ESTIMATOR_H
#define ESTIMATOR_H

#include "analysis.h"

typedef struct estimator {
    int sensors, disturbances;
    int rank;         /* combinations of disturbances that the sensors distinguish from noise */
    double condition; /* largest over smallest singular value of these combinations */
    double disturbed; /* expected root mean square of |W y| under the disturbances */
    double remaining; /* expected root mean square that the estimate leaves of it */
    double worst_disturbed; /* root mean square along the direction of the largest remaining error
                             */
    double worst_remaining;
    double *worst;         /* [targets] direction of the largest remaining error, largest entry 1 */
    int worst_target;      /* target row of the largest entry of `worst` */
    double *direct, *gain; /* S [sensors][amplifiers], G [targets][sensors] */
    double *shape_per_load;   /* [targets][loads] shape per unit of each load */
    double *reading_per_load; /* [sensors][loads] reading per unit of each load */
    pzs_estimator tables;
    pzs_feed_forward_table shape_table, reading_table; /* feed-forward tables; empty without loads,
                                                          or without sensors */
} estimator;

/*
 * Gains of a scene with an estimate section, from its structure in the reference state; without
 * that section only shape_per_load.
 *   analysis  in  after analysis_influence
 * Returns 0, or -1 with error filled and the estimator empty; also where the estimate would leave
 * more than the scene's tolerance.
 */
int estimator_open(estimator *estimator, const analysis *analysis, char *error);
void estimator_close(estimator *estimator);

/* One line of text on how well the sensors determine the shape. */
void estimator_text(const estimator *estimator, const analysis *analysis, char text[SCENE_ERROR]);

#endif
