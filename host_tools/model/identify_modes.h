/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Identification of vibration modes from the free vibration after steps of the voltages, which is a
 * constant plus decaying sinusoids. The method ESPRIT (shift invariance of the signal subspace)
 * estimates frequencies and damping ratios; least squares over all samples refine them.
 */
#ifndef IDENTIFY_MODES_H
#define IDENTIFY_MODES_H

#include "identify_responses.h"

/* Vibration modes identified from a record of voltages and readings. */
typedef struct identified_modes {
    int modes; /* number of vibration modes found, which are in the order of their frequencies */
    int twins; /* number of pairs of modes of equal frequency and damping among them, such as those
                  of a round mirror; their shapes are orthogonal */
    int steps; /* number of intervals of constant voltages that the identification used */
    double *frequency; /* [modes] natural frequencies of the vibration modes (Hz) */
    double *damping;   /* [modes] damping ratios of the vibration modes */
    double *frequency_error, *damping_error; /* [modes] standard errors of the natural frequencies
                                                (Hz) and of the damping ratios */
    double *shape; /* [modes][outputs] displacement of each output in each vibration mode, scaled to
                      a root mean square of 1 */
    double noise;  /* standard deviation of the part of a reading that the vibration modes do not
                      explain (unit of the readings) */
    double shown[2]; /* lowest and highest frequency that the longest interval of constant voltages
                        and the samples a second can show (Hz) */
    mode_responses responses; /* static responses of the vibration modes to the voltages */
    double left; /* root mean square of the part of the readings that the vibration modes do not
                    explain, relative to that of the vibration */
} identified_modes;

enum {
    IDENTIFIED_MODES = 20
}; /* largest number of vibration modes that can be identified together; a pair of equal frequency
      counts once */

/*
 * Identify the vibration modes in a record of voltages and readings, without those that noise
 * hides.
 *   samples  in  a line for each sample: steps of the voltages, each followed by constant voltages
 *       for several periods of the lowest mode
 *   rate     in  number of samples in a second
 *   most     in  largest number of modes, from 1 to IDENTIFIED_MODES
 * Returns 0, or -1 with error filled; call identified_modes_free in either case.
 */
int identify_modes(identified_modes *result, const pokes *samples, double rate, int most,
                   char *error);
void identified_modes_free(identified_modes *result);

#endif
