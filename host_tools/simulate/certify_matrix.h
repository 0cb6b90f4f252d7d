/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Margin of the control loop of a scene against errors of its influence matrix (matrix_errors.h),
 * and the regularisation of the voltages that gives a margin which is too small. The margin is
 * found on the structure with its vibration modes where the tick damps them; otherwise on the
 * structure in equilibrium, so that the scene needs neither densities nor a tick rate.
 */
#ifndef CERTIFY_MATRIX_H
#define CERTIFY_MATRIX_H

#include "../model/analysis.h"

/*
 * Fill analysis->certificate.matrix, unless it is filled. Nothing is done for a scene without a
 * target, and for a loop that is unstable with the exact matrix.
 *   analysis in/out  analysis with the influence matrix and the result of certify_loop
 * Returns 0, or -1 with error filled.
 */
int certify_matrix(analysis *analysis, char *error);

#endif
