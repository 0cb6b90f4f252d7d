/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Weighted least squares without voltage limits, for comparison with the optimum within the limits:
 *   (B'W^2 B + r I) v = B'W^2 e + r v0.
 *   v, v0  voltages and reference voltages
 *   W, B   weights and influence matrix
 *   e, r   error to be corrected, and regularisation
 * The matrix is factored by Cholesky's method with pivoting. Iterative refinement computes its
 * residuals from B. A voltage whose column of B depends linearly on others stays at 0 V.
 */
#ifndef UNCONSTRAINED_H
#define UNCONSTRAINED_H

#include <stdbool.h>
#include "pzs_control.h"

typedef struct unconstrained {
    const pzs_problem *problem; /* voltage optimisation problem, from which influence matrix,
                                   weights and reference voltages are read */
    double regularisation; /* regularisation weight with which the Cholesky factor of the normal
                              matrix was computed (m2/V2) */
    int rank; /* number of inputs whose columns of the influence matrix are linearly independent */
    double *normal;    /* [inputs][inputs] normal matrix B'W^2 B of influence matrix B and weights W
                          (m2/V2) */
    double *factor;    /* [inputs][inputs] Cholesky factor of the regularised normal matrix: one row
                          for each input, one column for each pivot in the order of elimination */
    double *remaining; /* [inputs] diagonal entries of the part of the normal matrix that the
                          Cholesky factorisation has not yet eliminated */
    double *gradient; /* [inputs] negative gradient of half the least-squares objective with respect
                         to the voltages (m2/V) */
    uint16_t *pivot;  /* [inputs] index of the input that is the pivot of each step of the Cholesky
                         factorisation; only the first `rank` entries are used */
} unconstrained;

/*
 * Allocate the arrays of the solver, and factor the normal matrix B'W^2 B of influence matrix B and
 * weights W with the regularisation of the problem.
 *   problem in  least-squares problem for the voltages with its influence matrix; must outlive
 *       *solver
 * Returns whether memory sufficed; call unconstrained_close in either case.
 */
bool unconstrained_open(unconstrained *solver, const pzs_problem *problem);
void unconstrained_close(unconstrained *solver);

/*
 * Factor the normal equations again with another regularisation, which must not be negative
 * (m2/V2).
 */
void unconstrained_factor(unconstrained *solver, double regularisation);

/*
 * Compute the voltages that correct one error of the shape.
 *   error   [outputs] in   displacements that the voltages are to cause (m)
 *   voltage [inputs]  out  least-squares voltages (V)
 * Returns whether every voltage is finite; `voltage` is overwritten in either case.
 */
bool unconstrained_solve(unconstrained *solver, const double *error, double *voltage);

#endif
