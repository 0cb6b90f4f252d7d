/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Voltages for a scene's target: the bounded optimum on the linear or the nonlinear structure, and
 * others for comparison. Each result contains voltages and the shape that they cause on the
 * structure that analysis->nonlinear selects.
 */
#ifndef VOLTAGES_H
#define VOLTAGES_H

#include "analysis.h"

typedef struct voltages {
    char name[SCENE_NAME + 32]; /* name of the result */
    int amplifiers;
    double *voltage;        /* [amplifiers] V */
    double *u;              /* [free_dof] displacement under the voltages and the scene's loads */
    double *shape;          /* [targets] displacement of the target rows */
    double *aligned_target; /* [targets] target with the free functions that fit the shape best */
    double error; /* |W P (shape - target)| / |W P (target - shape without voltages)| over the rows
                     that can move, P removing the free functions; the shape without voltages is the
                     linear one; NAN: no equilibrium found */
    double error_all;      /* the same error with the rows on constrained dof included */
    double rms, valley;    /* root mean square, with the weights, and peak-to-valley value of the
                              misfit, in the rows that can move */
    int fixed_off;         /* rows on constrained dof that differ from the target */
    double optimality;     /* KKT violation / largest |B'W^2 wanted|; NAN where the result is not an
                              optimum */
    double limit[2];       /* lowest and highest voltage that any amplifier may give, V */
    int held, narrowed;    /* number of held amplifiers; number of the others with a narrower range
                              than `limit` */
    double residual;       /* solver residual of the displacement */
    double regularisation; /* of voltages_regularised, relative to tr(B'W^2 B)/n; else 0 */
    int active_limits, iterations; /* amplifiers at a limit, without held ones; iterations of the
                                      optimiser */
    int relinearised;              /* how often the influence was computed anew at the last shape */
    int linear_solves;             /* linear solves on the nonlinear structure */
} voltages;

/*
 * Voltages for the scene's target, after analysis_influence. The argument `common` selects the
 * common voltage limits (design.h); the narrowest limit of an amplifier always applies.
 *
 *   voltages_optimum      The bounded optimum. On the nonlinear structure a Gauss-Newton method
 *                         with the influence at the last shape, from the linear optimum (or the
 *                         part of it that has an equilibrium), within a trust radius that shrinks
 *                         where the error does not decrease.
 *   voltages_linear       The optimum of the linear model, and its shape on the selected structure.
 *   voltages_clipped      Least squares of the linear model without limits, then clipped.
 *   voltages_regularised  The same with the one regularisation parameter that leaves the smallest
 *                         error of the linear model after clipping, chosen with knowledge of that
 *                         error.
 *   voltages_given        Given voltages, unchanged.
 *
 * Each returns 0, or -1 with error filled.
 */
int voltages_optimum(analysis *analysis, common_limits common, voltages *result, char *error);
int voltages_linear(analysis *analysis, common_limits common, voltages *result, char *error);
int voltages_clipped(analysis *analysis, common_limits common, voltages *result, char *error);
int voltages_regularised(analysis *analysis, common_limits common, voltages *result, char *error);
int voltages_given(analysis *analysis, const char *name, const double *voltage, voltages *result,
                   char *error);
void voltages_free(voltages *result);

#endif
