/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Effective coupling factors of vibration modes: how far open electrodes raise their frequencies,
 *   k^2 = (f_open^2 - f_short^2)/f_open^2,
 * the share of the energy of the open mode that is electric where the shape of the mode does not
 * change. A mode with short-circuited electrodes belongs to the open mode whose shape it has.
 */
#ifndef COUPLING_H
#define COUPLING_H

#include "analysis.h"

typedef struct coupling {
    int count;               /* number of vibration modes; 0: not computed */
    double *short_frequency; /* [count] frequency with short-circuited electrodes of the mode that
                                has the same shape (Hz); NAN where no mode has it */
    double *squared; /* [count] squared effective coupling factor of each mode; NAN where the
                        frequency above is, and for rigid motions */
} coupling;

/*
 * Compute the coupling factors of vibration modes with open electrodes. Two shapes count as equal
 * if the square of their product with the mass matrix is above 1/2; for modes whose frequencies
 * agree within 1e-4 the sum of these squares counts.
 *   analysis in  design and state of the structure about which the modes were computed
 *   open     in  modes with open electrodes
 * Returns 0, or -1 with error filled; call coupling_free in either case.
 */
int coupling_find(coupling *coupling, const analysis *analysis, const vibration *open, char *error);
void coupling_free(coupling *coupling);

#endif
