/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Clipped least squares, for comparison with the optimum within the voltage limits: least-squares
 * voltages without limits, each then clipped. The regularised variant (Tikhonov) minimises
 *   |W (B v - wanted)|^2 + (r + lambda s) |v - v0|^2.
 *   v, v0   voltages before clipping, and reference voltages (V)
 *   B, W    influence matrix and weights
 *   r       regularisation of the scene
 *   lambda  parameter; larger values give smaller voltages, of which fewer are clipped
 *   s       trace(B'W^2 B) divided by the number of amplifiers
 */
#ifndef CLIPPED_H
#define CLIPPED_H

#include "design.h"
#include "unconstrained.h"

typedef struct clipped {
    const design *design;
    const double *lower, *upper; /* [amplifiers] lowest and highest allowed voltage of each
                                    amplifier (V) */
    const double *wanted; /* [targets] displacements of the target nodes that the voltages are to
                             cause */
    pzs_problem problem;  /* voltage optimisation problem (least squares with voltage limits) in the
                             library's  format; amplifiers held at one voltage have columns of zeros
                           */
    double scale;   /* unit of the regularisation parameter lambda: trace(B'W^2 B) divided by the
                       number of amplifiers (m2/V2), with influence matrix B and weights W */
    double *arrays; /* one allocation that holds the arrays `influence`, `required` and `shape` */
    double *influence; /* [targets][amplifiers] influence matrix with columns of zeros for
                          amplifiers held at one voltage */
    double *required; /* [targets] wanted displacements minus those caused by amplifiers held at one
                         voltage */
    double *shape;    /* [targets] work array for displacements of the target nodes */
    unconstrained solver;
} clipped;

/*
 * Prepare the least-squares problem without voltage limits, for clipped_solve.
 *   lower, upper [amplifiers] in  voltage limits (V); equal limits hold an amplifier at that
 *       voltage
 *   wanted       [targets]    in  displacements that the voltages are to cause
 * All arguments must outlive `clipped`. Returns 0, or -1 where memory runs out; call clipped_close
 * in either case.
 */
int clipped_open(clipped *clipped, const design *design, const double *lower, const double *upper,
                 const double *wanted);
void clipped_close(clipped *clipped);

/*
 * Compute the voltages that minimise the squared error of the shape plus lambda >= 0 times the
 * squared voltages, without limits, and clip each to its limits.
 *   voltage [amplifiers] out  voltages found (V)
 * Returns whether all voltages are finite.
 */
bool clipped_solve(clipped *clipped, double lambda, double *voltage);

/*
 * Find the regularisation parameter lambda with which the clipped voltages leave the smallest
 * weighted shape error, from 0 and a logarithmic grid, refined to three digits by golden sections.
 *   voltage [amplifiers] out  clipped voltages (V)
 *   lambda               out  the parameter found
 * Returns PZS_OK, PZS_E_WORKSPACE where memory runs out, or PZS_E_NONFINITE.
 */
pzs_status clipped_tune(clipped *clipped, double *voltage, double *lambda);

#endif
