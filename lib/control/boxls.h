/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Least squares with bounds: an active-set method whose every iterate is feasible. It solves
 *
 *   minimise   (v - base)' H (v - base) / 2 + (r - t)' (v - base)
 *   subject to lower <= v <= upper
 *
 * for the voltages v, with the Hessian H, which may be singular, base voltages, the regularisation
 * gradient r and the target gradient t (pzs_optimiser). Vectors have the length `width`, the number
 * of inputs rounded up to a multiple of PZS_TILE; the entries beyond the inputs stay zero.
 */
#ifndef PZS_LIB_BOXLS_H
#define PZS_LIB_BOXLS_H

#include "optimiser.h"

/* Number of vectors of length `width` that the optimiser needs. */
#define BOXLS_VECTORS (16u + PZS_PENDING)
#define BOXLS_DEPENDENT                                                                            \
    256 /* largest factor by which the pivot threshold may rise above its initial value, 4 inputs  \
           epsilon */

/*
 * Let all vectors of the optimiser except the voltages point into work [BOXLS_VECTORS][width]. The
 * members inputs and width must be set.
 */
void pzs_boxls_place(pzs_optimiser *optimiser, pzs_real *work);

/*
 * Compute the gradient from the model gradient, and copy its entries of the free set to
 * next_voltage.
 */
void pzs_boxls_gradient(pzs_optimiser *optimiser);

/*
 * Compute the model gradient and its rounding-error bound from the Hessian at the present voltages,
 * and then the gradient.
 */
void pzs_boxls_true_gradient(pzs_optimiser *optimiser);

/*
 * Compute the search direction from gradient and tableau, and the voltages after the step.
 *   rounding in  KKT violations up to this size do not count (m2/V)
 * Returns the number of free inputs that would pass a bound plus the number of active inputs that
 * would have a KKT violation.
 */
uint32_t pzs_boxls_find_direction(pzs_optimiser *optimiser, pzs_real rounding);

/*
 * Clamp voltages that are outside their bounds. If there were any, compute the gradient anew and
 * return true.
 */
bool pzs_boxls_enforce_limits(pzs_optimiser *optimiser);

/*
 * Optimise the voltages, as far as work_limit allows. The function adds to iterations and work, and
 * sets kkt_violation, rounding_bound and is_optimal. From the first iteration on the voltages are
 * inside their bounds.
 */
void pzs_boxls_optimise(pzs_optimiser *optimiser);

/*
 * Return whether a round of iterations lowered the objective: from start_voltage and start_gradient
 * to voltage and gradient. The arrays scratch and direction are overwritten.
 */
bool pzs_boxls_has_decreased(const pzs_optimiser *optimiser);

/*
 * Return the largest KKT violation of given voltages [width] with a given gradient [width] (m2/V).
 * The array scratch is overwritten.
 */
pzs_real pzs_boxls_violation(const pzs_optimiser *optimiser, const pzs_real *voltage,
                             const pzs_real *gradient);

/*
 * Return whether the rounding error of the Hessian times (voltages - base voltages) may raise the
 * objective by more than the machine epsilon times its scale, target_energy.
 */
bool pzs_boxls_needs_new_base(pzs_optimiser *optimiser);

#endif
