/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Gains with which a firmware estimates the shape y from the readings s of few sensors, and
 * measures of how well these determine it. Model, best linear estimate and covariance of its error:
 *   y = B v + A a,  s = S v + C a + noise,
 *   y = B v + G (s - S v) with G = A C' (C C' + N^2)^-1,
 *   A (1 + C' N^-2 C)^-1 A'.
 *   v     voltages
 *   a     disturbances (loads, voltage errors) of mean 0 and variance 1
 *   B, S  shape and readings per volt
 *   A, C  shape and readings per unit disturbance, from the scene's standard deviations
 *   N^2   covariance of the noise
 */
#ifndef ESTIMATOR_H
#define ESTIMATOR_H

#include "analysis.h"

typedef struct estimator {
    int sensors, disturbances;
    int rank; /* number of combinations of disturbances (loads and voltage errors) that the sensors
                 distinguish from noise */
    double condition; /* condition number (ratio of largest to smallest singular value) of a matrix
                         of readings: one row for each sensor, divided by its noise, and one column
                         for one standard deviation of each disturbance (load or voltage error).
                         Singular values below 1 do not stand out from the noise and are left out */
    double disturbed; /* expected root mean square of the shape, weighted with the target weights,
                         under the disturbances (loads and voltage errors), before estimation */
    double remaining; /* expected root mean square of the error of the estimated shape, weighted
                         with the target weights */
    double worst_disturbed; /* root mean squares along the shape `worst`, in which the
                               estimation error is largest. worst_disturbed: of the displacements
                               that the disturbances (loads and voltage errors) cause.
                               worst_remaining: of the estimation error */
    double worst_remaining;
    double *worst;    /* [targets] shape in which the error of the estimate is largest, scaled to a
                         largest entry of 1 */
    int worst_target; /* index of the target row (controlled displacement) with the largest entry of
                         `worst`, the shape in which the error of the estimate is largest */
    double *direct, *gain;  /* direct [sensors][amplifiers]: reading of each sensor per volt of each
                               amplifier; gain [targets][sensors]: estimated shape per unit of each
                               reading */
    double *shape_per_load; /* [targets][loads] shape that each load causes per unit of its factor
                             */
    double *reading_per_load; /* [sensors][loads] reading that each load causes per unit of its
                                 factor */
    pzs_estimator tables;
    pzs_feed_forward_table shape_table,
        reading_table; /* feed-forward tables of the shape and of the readings under known loads;
                          empty where the scene has no loads or no sensors */
} estimator;

/*
 * Compute the gains of a scene with an `estimate` section from its structure in the reference
 * state; for other scenes only shape_per_load.
 *   analysis in  analysis whose influence matrix is computed
 * Returns 0, or -1 with error filled and the estimator empty, also where the error of the estimate
 * would exceed the scene's tolerance.
 */
int estimator_open(estimator *estimator, const analysis *analysis, char *error);
void estimator_close(estimator *estimator);

/* Write one line of text on how well the sensors of the shape estimator determine the shape. */
void estimator_text(const estimator *estimator, const analysis *analysis, char text[SCENE_ERROR]);

#endif
