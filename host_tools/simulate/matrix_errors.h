/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Margin of a control loop against errors of the entries of its influence matrix. The controller
 * inverts the influence matrix B; the structure responds with entries
 *   B_ij (1 + s g_ij),  g_ij random, mean 0, variance 1.
 *   s  standard deviation of the relative errors of the entries
 * Errors that are larger than the weakest singular values of B reverse the sign of the loop's
 * reaction in these directions, and the voltages grow. Voltage limits bound this growth but do not
 * stop it, so that the margin is that of the loop without limits. It is found by simulation of the
 * blocks of the control tick as they run. Without a block that damps vibration, without delay and
 * without gains of modes, the voltages obey v(next) = F (t - s G v), and the loop decays if the
 * spectral radius of s F G is below 1:
 *   F     (B^T W^2 B + regularisation)^-1 B^T W^2
 *   G, t  matrix of the entries B_ij g_ij; target
 *   W     weights of the targets
 */
#ifndef MATRIX_ERRORS_H
#define MATRIX_ERRORS_H

#include "storm_rig.h"

/* A loop, and how it is tried. */
typedef struct matrix_errors {
    const storm_rig *rig; /* structure and blocks of the loop (storm_use) */
    int ticks;            /* length of a simulation */
    bool is_limited;      /* whether the loop is tried within the limits of its voltages, too */
} matrix_errors;

/*
 * Determine whether the voltages of a loop grow on a structure whose matrix entries have random
 * errors: without limits or, if they do not, whether they come to rest within the limits after
 * jumps of the target.
 *   scatter in   standard deviation of the relative errors
 *   seed    in   number of the random sequence of errors
 *   grows   out  result
 * Returns 0, or -1 with error filled.
 */
int matrix_errors_try(const matrix_errors *errors, double scatter, uint64_t seed, bool *grows,
                      char *error);

/*
 * Find by bisection the largest standard deviation of the relative errors at which the loop passes
 * matrix_errors_try with each of a fixed number of random sequences of errors. A loop that does not
 * come to rest within its limits with the exact matrix is tried without limits alone.
 *   ticks  in   length of a simulation
 *   margin out  this standard deviation; 0: the loop grows at the smallest that is tried, 1e-4;
 *       CERTIFICATE_MATRIX_MOST: it grows at none
 *   is_unstable out  whether the loop grows with the exact matrix, too
 * Returns 0, or -1 with error filled.
 */
int matrix_errors_margin(const storm_rig *rig, int ticks, double *margin, bool *is_unstable,
                         char *error);

#endif
