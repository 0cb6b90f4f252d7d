/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Hysteresis and creep of a ceramic from one measured sweep of voltage and position: least squares
 * with bounds for the numbers of the section `hysteresis` of a scene.
 *
 *   position = position at the start + g u,   u the effect of pzs_hysteresis (V)
 *
 * The slacks of the plays and the time constants of the creep are given; slopes, weights and creep
 * enter linearly. They are not negative, so that the effect rises with the voltage. The best sweep
 * is a triangle of fading amplitude, which fills the memory of the plays step by step, and then a
 * constant voltage, which shows the creep.
 */
#ifndef IDENTIFY_H
#define IDENTIFY_H

#include "../scene/scene.h"

/* A measured sweep. */
typedef struct sweep {
    size_t count;           /* number of samples, at most 60000 */
    const double *voltage;  /* [count] voltage since the sample before (V) */
    const double *position; /* [count] position */
    double rate;            /* samples a second */
} sweep;

typedef struct identification {
    scene_hysteresis hysteresis;
    double gain;     /* g, position per effect (1/V) */
    double rms;      /* root mean square of the misfit over the range of the positions */
    double largest;  /* largest misfit over the range of the positions */
    double straight; /* root mean square that a straight line leaves, over the range */
} identification;

/*
 * Fit the numbers to a sweep.
 *   plays  in  number of plays, 1 to SCENE_PLAYS; 8 are as good as more
 *   gain   in  g where it is known; 0: the g by which a full swing from the lowest to the highest
 *              voltage has an effect as large as the swing
 *   error [SCENE_ERROR] out
 * Returns 0, or -1 with error filled: memory, too few or too many samples, numbers that are not
 * finite, a voltage that does not swing, a position that does not rise with it.
 */
int identify(identification *result, const sweep *sweep, int plays, double gain, char *error);

#endif
