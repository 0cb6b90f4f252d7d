/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Weighted least squares without voltage limits, for comparison with the bounded optimum:
 *
 *   min |W (B v - e)|^2 + r |v - v0|^2,   so   (B'W^2 B + r I) v = B'W^2 e + r v0.
 *
 * The normal equations are factored by Cholesky's method with pivoting and the solution is refined
 * with residuals of B itself. A voltage whose column of B depends linearly on others stays at 0 V.
 */
#ifndef UNCONSTRAINED_H
#define UNCONSTRAINED_H

#include <stdbool.h>
#include "pzs_control.h"

typedef struct unconstrained {
    const pzs_problem *problem; /* influence B, weight W and reference voltage v0 are read */
    double regularisation;      /* r of the factor, m2/V2 */
    int rank;                   /* number of linearly independent inputs */
    double *normal;             /* [inputs][inputs] B'W^2 B */
    double *factor;             /* [inputs][inputs] factor: row of an input, column of a pivot */
    double *remaining;          /* [inputs] diagonal that is not yet eliminated */
    double *gradient;           /* [inputs] negative gradient of half the objective, m2/V */
    uint16_t *pivot;            /* [inputs] input of each pivot; the first `rank` entries count */
} unconstrained;

/*
 * Allocate the arrays, form B'W^2 B and factor it with the problem's regularisation.
 *   problem in  with its influence matrix; it must outlive *solver
 * Returns whether memory sufficed; call unconstrained_close in either case.
 */
bool unconstrained_open(unconstrained *solver, const pzs_problem *problem);
void unconstrained_close(unconstrained *solver);

/* Factor the normal equations again with another regularisation r >= 0 (m2/V2). */
void unconstrained_factor(unconstrained *solver, double regularisation);

/*
 * Solve for one error.
 *   error [outputs]  in   e, m
 *   voltage [inputs] out  V
 * Returns whether every voltage is finite; `voltage` is overwritten in either case.
 */
bool unconstrained_solve(unconstrained *solver, const double *error, double *voltage);

#endif
