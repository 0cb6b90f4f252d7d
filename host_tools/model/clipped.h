/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Clipped least squares, for comparison with the bounded optimum: least squares without limits,
 * then each voltage clipped to its limits. With Tikhonov regularisation,
 *
 *   min |W (B v - wanted)|^2 + (r + lambda s) |v - v0|^2,   s = tr(B'W^2 B)/n,   then clipped,
 *
 * the voltages are smaller before they are clipped, and lambda determines the error of the result;
 * r is the regularisation of the scene and v0 the reference voltages.
 */
#ifndef CLIPPED_H
#define CLIPPED_H

#include "design.h"
#include "unconstrained.h"

typedef struct clipped {
    const design *design;
    const double *lower, *upper; /* [amplifiers] V */
    const double *wanted;        /* [targets] target of B v */
    pzs_problem problem;         /* voltage problem of the amplifiers that are not held */
    double scale;                /* s, m2/V2 */
    double *arrays;              /* one allocation of the three arrays below */
    double *influence; /* [targets][amplifiers] B with columns of zeros for held amplifiers */
    double *required;  /* [targets] wanted less the effect of held amplifiers */
    double *shape;     /* [targets] work */
    unconstrained solver;
} clipped;

/*
 * Prepare the least-squares problem.
 *   lower, upper [amplifiers] in  limits; an amplifier with equal limits is held at that voltage
 *   wanted [targets]          in
 * All arguments must outlive the result. Returns 0, or -1 where memory runs out; call clipped_close
 * in either case.
 */
int clipped_open(clipped *clipped, const design *design, const double *lower, const double *upper,
                 const double *wanted);
void clipped_close(clipped *clipped);

/*
 * Clipped voltages for one lambda >= 0. voltage [amplifiers] out, V. Returns whether they are
 * finite.
 */
bool clipped_solve(clipped *clipped, double lambda, double *voltage);

/*
 * Find the lambda with the smallest |W (B v - wanted)| after clipping: the best of 0 and a
 * logarithmic grid, refined by a golden-section search between the neighbours of the best, to three
 * digits. The choice uses the error itself, so no choice of one parameter gives a better result.
 *   voltage [amplifiers]  out  clipped voltages, V
 *   lambda                out
 * Errors: WORKSPACE, NONFINITE.
 */
pzs_status clipped_tune(clipped *clipped, double *voltage, double *lambda);

#endif
