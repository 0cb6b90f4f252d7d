/*
 * What is often done instead of a bounded optimum, to compare with it: least squares without
 * limits, then each voltage cut to its limits. With Tikhonov regularisation,
 *
 *   min |W (B v - wanted)|^2 + (effort + lambda s) |v - prefer|^2,   s = tr(B'W^2 B)/n,   then cut,
 *
 * the voltages are smaller before they are cut, and lambda decides how good the result is.
 */
#ifndef CLIPPED_H
#define CLIPPED_H

#include "design.h"
#include "unconstrained.h"

typedef struct clipped {
    const design *design;
    const double *lower, *upper; /* [amplifiers] */
    const double *wanted;        /* [targets] what B v should be */
    pzs_problem problem;         /* of the amplifiers that are not held */
    double scale;                /* s, m2/V2 */
    double *arrays;              /* one allocation of the arrays below */
    double *influence;           /* [targets][amplifiers] 0 in the columns of held amplifiers */
    double *required;            /* [targets] wanted less what held amplifiers do */
    double *shape;               /* [targets] room */
    unconstrained solver;
} clipped;

/*
 * Prepare.
 *   lower, upper [amplifiers] in  limits to cut to; an amplifier whose limits are equal is held,
 *                                 the others compensate
 *   wanted [targets]          in
 * All must outlive *c. Returns 0, or -1 where memory runs out; clipped_close in either case.
 */
int clipped_open(clipped *clipped, const design *design, const double *lower, const double *upper,
                 const double *wanted);
void clipped_close(clipped *clipped);

/* Voltages for one lambda >= 0. voltage [amplifiers] out, V. Returns whether they are finite. */
bool clipped_solve(clipped *clipped, double lambda, double *voltage);

/*
 * The lambda of the smallest |W (B v - wanted)| after cutting, and its voltages: the best of 0 and
 * a logarithmic grid, refined by golden section between the neighbours of the best, to three
 * digits. It is chosen knowing the answer, and so is the best that this method can do with one
 * parameter.
 *   volt [amplifiers] out
 *   lambda            out
 */
pzs_status clipped_tune(clipped *clipped, double *voltage, double *lambda);

#endif
