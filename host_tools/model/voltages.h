/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Voltages for a scene's target: the optimum within the limits, and other voltages for comparison.
 * Each result has the voltages and their shape on the linear or nonlinear structure, as
 * analysis->is_nonlinear says.
 */
#ifndef VOLTAGES_H
#define VOLTAGES_H

#include "analysis.h"

typedef struct voltages {
    char name[SCENE_NAME + 32]; /* name of the method that computed the voltages, for reports */
    int amplifiers;
    double *voltage; /* [amplifiers] computed voltages (V) */
    bool *at_limit;  /* [amplifiers] whether the voltage of each amplifier is at one of its limits;
                        false for an amplifier that is held at one voltage */
    double *bounds;  /* [2][amplifiers] lower, then upper voltage limits of the amplifiers for which
                        the voltages were computed; infinite for given voltages (V) */
    double *displacement; /* [free_dof] displacement vector under the voltages and the scene's loads
                           */
    double *shape; /* [targets] controlled displacements (target rows) under the voltages and the
                      scene's loads */
    double *aligned_target; /* [targets] target plus that combination of its free functions (shapes
                               that may be added at no cost) which is nearest to the shape reached
                             */
    double error; /* relative shape error: weighted norm of (shape - target) over that of (target -
                     linear shape without voltages). Constrained displacements and the free
                     functions of the target (shapes that may be added at no cost) do not count.
                     NAN: no equilibrium was found */
    double error_all; /* relative shape error over all controlled displacements (target rows), those
                         on constrained dof included */
    double rms, valley; /* weighted root mean square and peak-to-valley value of shape minus target,
                           over the controlled displacements that can move */
    int fixed_off; /* number of controlled displacements that differ from their target although a
                      support prescribes them, so that no voltage can help */
    double optimality; /* violation of the optimality (KKT) conditions relative to the largest entry
                          of the gradient at zero voltage; NAN where the result is not an optimum */
    double limit[2];   /* lowest and highest voltage that any amplifier may give (V) */
    int held, narrowed; /* held: number of amplifiers held at one voltage. narrowed: number of the
                           other amplifiers that have a narrower range than limit[0] to limit[1]. */
    double residual; /* relative residual of the linear equations whose solution is the displacement
                        vector */
    double regularisation; /* regularisation parameter of least squares that are regularised and
                              then clipped, as a multiple of the mean diagonal entry of the Hessian;
                              0 for other methods */
    int active_limits, iterations; /* number of amplifiers at a voltage limit (amplifiers held at
                                      one voltage do not count), and number of iterations of the
                                      optimiser */
    int active_rows; /* number of limits of weighted sums of voltages that bind; 0 unless the result
                        is an optimum within limits */
    int dependent;   /* number of amplifiers whose columns of the influence matrix are linear
                        combinations of those of others, so that without regularisation their
                        voltages are not unique. Amplifiers held at one voltage are not counted.
                        Computed only for clipped least squares, otherwise 0 */
    int relinearised;  /* number of times that the influence matrix was computed again in the
                          nonlinear optimisation, each time at the deformed shape reached until then
                        */
    int linear_solves; /* number of linear solves that the equilibrium of the nonlinear structure
                          has needed */
} voltages;

/*
 * Compute voltages for the scene's target within `common` limits of all amplifiers (design.h) and
 * the limits of each. The influence matrix must be computed before. Each returns 0, or -1 with
 * error filled.
 *   voltages_optimum      optimum within the limits; for analysis->is_nonlinear a Gauss-Newton
 *       method with a trust radius, from the linear optimum (halved until an equilibrium exists)
 *   voltages_linear       optimum of the linear model; its shape as analysis->is_nonlinear says
 *   voltages_clipped      least squares of the linear model without limits, then clipped
 *   voltages_regularised  regularised least squares of the linear model, then clipped, with the
 *       regularisation of the smallest error
 *   voltages_given        given voltages, unchanged
 */
int voltages_optimum(analysis *analysis, common_limits common, voltages *result, char *error);
int voltages_linear(analysis *analysis, common_limits common, voltages *result, char *error);
int voltages_clipped(analysis *analysis, common_limits common, voltages *result, char *error);
int voltages_regularised(analysis *analysis, common_limits common, voltages *result, char *error);
int voltages_given(analysis *analysis, const char *name, const double *voltage, voltages *result,
                   char *error);
void voltages_free(voltages *result);

/*
 * Compute the relative RMS error of the shape that the optimum of the linear model within the
 * limits leaves. The shape is that of the influence matrix in design->problem; no equilibrium is
 * computed, and the analysis is unchanged. Returns 0, or -1.
 *   shape_error out  relative RMS error
 *   error       out  filled where the limits of an amplifier allow no voltage
 */
int voltages_linear_error(const design *design, common_limits common, double *shape_error,
                          char *error);

/*
 * Compute the influence matrix of the nonlinear structure at the optimum that voltages_optimum has
 * found. If the last step of that search was rejected, the equilibrium at the optimum is computed
 * again, which improves result->displacement within the tolerance.
 *   influence [outputs][inputs] out  influence matrix
 * Returns 0, or -1 with error filled.
 */
int voltages_influence_at(analysis *analysis, voltages *optimum, double *influence, char *error);

#endif
