/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Vibration modes from the free vibration that follows steps of the voltages. While the voltages
 * are constant, each reading is a constant plus a sum of decaying sinusoids. Estimates of their
 * frequencies and damping ratios come from the shift invariance of the signal subspace (ESPRIT,
 * which is the eigensystem realisation of a free vibration); least squares over all samples then
 * refine them.
 */
#ifndef IDENTIFY_MODES_H
#define IDENTIFY_MODES_H

#include "calibrate.h"

/* Vibration modes found in a record. */
typedef struct identified_modes {
    int modes;         /* number of modes found, in the order of their frequencies */
    int steps;         /* number of intervals of constant voltages that were used */
    double *frequency; /* [modes] natural frequencies (Hz) */
    double *damping;   /* [modes] damping ratios */
    double *frequency_error, *damping_error; /* [modes] standard errors of both */
    double *shape; /* [modes][outputs] displacement of each output, with a root mean square of 1 */
    double noise;  /* standard deviation of what the modes leave of a reading, in the unit of the
                      readings */
    double left;   /* root mean square of what the modes leave, relative to that of the vibration */
} identified_modes;

enum { IDENTIFIED_MODES = 20 }; /* largest number of modes that can be identified together */

/*
 * Identify vibration modes.
 *   samples in  voltages and readings, a line for each sample: steps of the voltages, each followed
 *       by constant voltages for several periods of the lowest mode
 *   rate    in  samples a second
 *   most    in  largest number of modes, from 1 to IDENTIFIED_MODES
 * Modes that the noise hides are left out. Returns 0, or -1 with error filled; call
 * identified_modes_free in either case.
 */
int identify_modes(identified_modes *result, const pokes *samples, double rate, int most,
                   char *error);
void identified_modes_free(identified_modes *result);

#endif
