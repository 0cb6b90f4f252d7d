/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Least squares with bounds, by an active-set method whose intermediate results all obey the
 * bounds. It solves
 *
 *   minimise   (v - base)' H (v - base) / 2 + (r - t)' (v - base)
 *   subject to lower <= v <= upper
 *   v, base  voltages, constant base voltages
 *   H        Hessian, which may be singular
 *   r, t     gradients of the regularisation and of the target
 *            (pzs_optimiser.regularisation_gradient and target_gradient)
 *
 * Vectors have an entry for each input and are padded with zeros to the length `width`.
 */
#ifndef PZS_LIB_BOXLS_H
#define PZS_LIB_BOXLS_H

#include "optimiser.h"

/* Number of the optimiser's vectors with an entry for each input, without the voltages. */
#define BOXLS_VECTORS (16u + PZS_PENDING)
/*
 * Largest factor by which the pivot threshold for linearly dependent inputs may rise above its
 * initial value, which is 4 times the number of inputs times the machine epsilon.
 */
#define BOXLS_DEPENDENT 256

/*
 * Set the pointers of the optimiser to its vectors, except the voltages, in the memory `work`,
 * which has room for all of them (BOXLS_VECTORS vectors of length `width`). The members `inputs`
 * and `width` of the optimiser must be set before.
 */
void pzs_boxls_place(pzs_optimiser *optimiser, pzs_real *work);

/*
 * Compute half the gradient of the objective, model_gradient minus target_gradient (pzs_optimiser).
 * The array next_voltage receives a copy with 0 for the inputs whose voltages are kept: the product
 * of the tableau with this vector is the search direction (pzs_boxls_find_direction).
 */
void pzs_boxls_gradient(pzs_optimiser *optimiser);

/*
 * Compute the gradient of the objective at the present voltages from the Hessian itself, not from
 * the tableau (pivoted Hessian), whose rounding errors accumulate. Also compute its rounding-error
 * bound.
 */
void pzs_boxls_true_gradient(pzs_optimiser *optimiser);

/*
 * Compute the search direction: the product of the tableau (pivoted Hessian) with the gradient of
 * the free inputs. Before, apply the collected pivot exchanges to the tableau. Also compute the
 * voltages after a full step along the direction.
 *   rounding in  violations of the optimality (KKT) conditions up to this size do not count (m2/V)
 * Returns how many inputs prevent the full step: free ones that would exceed a bound, and active
 * ones that would violate the conditions.
 */
uint32_t pzs_boxls_find_direction(pzs_optimiser *optimiser, pzs_real rounding);

/*
 * Clamp voltages that are outside their bounds. Returns whether any voltage was outside; the caller
 * must then compute the gradient anew.
 */
bool pzs_boxls_enforce_limits(pzs_optimiser *optimiser);

/*
 * Optimise the voltages, as far as the member work_limit of the optimiser allows. Adds to
 * `iterations` and `work`; sets is_optimal, kkt_violation (of the optimality conditions) and
 * rounding_bound (its rounding-error bound). After the first iteration the voltages are inside
 * their bounds.
 */
void pzs_boxls_optimise(pzs_optimiser *optimiser);

/*
 * Return whether a round (sequence of iterations) of the optimiser lowered the objective, from the
 * voltages start_voltage with gradient start_gradient to `voltage` with `gradient`. The arrays
 * scratch and direction of the optimiser are overwritten.
 */
bool pzs_boxls_has_decreased(const pzs_optimiser *optimiser);

/*
 * Shorten a round (sequence of iterations) of the optimiser: move the voltages to the minimum of
 * the objective on the line from the start of the round to the present voltages. Returns whether
 * they have moved; the gradient must then be computed anew. Overwrites the arrays scratch and
 * direction.
 */
bool pzs_boxls_shorten(pzs_optimiser *optimiser);

/*
 * Return the largest violation of the optimality (KKT) conditions by voltages [width] with a
 * gradient [width] of the objective (m2/V). The width is the number of inputs, rounded up for
 * vector loops. The array scratch of the optimiser is overwritten.
 */
pzs_real pzs_boxls_violation(const pzs_optimiser *optimiser, const pzs_real *voltage,
                             const pzs_real *gradient);

/*
 * Return whether the present voltages should replace the base voltages, around which the gradient
 * is computed. The rounding error of the gradient grows with the difference between both. The base
 * must be replaced if this error could raise the objective by more than the machine epsilon times
 * target_energy, the scale of the objective.
 */
bool pzs_boxls_needs_new_base(pzs_optimiser *optimiser);

/*
 * pzs_boxls_optimise and pzs_boxls_needs_new_base, compiled for processors with the vector unit
 * AVX2 (boxls_wide.c). The results have the same bits. The functions exist only with the option
 * PZS_WIDE.
 */
#if PZS_WIDE
void pzs_boxls_optimise_wide(pzs_optimiser *optimiser);
bool pzs_boxls_needs_new_base_wide(pzs_optimiser *optimiser);
#else
#define pzs_boxls_optimise_wide(optimiser) ((void)0)
#define pzs_boxls_needs_new_base_wide(optimiser) false
#endif

#endif
