/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Box-constrained least squares: an active-set method whose every iterate is feasible.
 *
 *   min  (v - base)' H (v - base) / 2 + (r - t)' (v - base),   lower <= v <= upper
 *
 * with the regularisation gradient r and the target gradient t (pzs_optimiser). Up to a constant
 * this is half of |W (B v - e)|^2 + regularisation |v - v0|^2. H may be singular. Vectors are
 * [width], the inputs rounded up to whole tiles; the entries behind the inputs stay zero.
 */
#ifndef PZS_LIB_BOXLS_H
#define PZS_LIB_BOXLS_H

#include "optimiser.h"

/* Vectors of width entries that the optimiser needs. */
#define BOXLS_VECTORS (16u + PZS_PENDING)
#define BOXLS_DEPENDENT                                                                            \
    256 /* largest factor by which the pivot floor may grow over its start, 4 inputs epsilon */

/* Point all vectors but the voltages into work [BOXLS_VECTORS][width]; inputs and width are set. */
void pzs_boxls_place(pzs_optimiser *optimiser, pzs_real *work);

/* Gradient from the model gradient; its entries of the free set also go to next_voltage. */
void pzs_boxls_gradient(pzs_optimiser *optimiser);

/* Model gradient and its rounding bound from H at the present voltages, then the gradient. */
void pzs_boxls_true_gradient(pzs_optimiser *optimiser);

/*
 * Direction from the gradient and the tableau, next_voltage after it.
 *   rounding in  KKT violations up to this size do not count (m2/V)
 * Returns how many inputs would leave their bounds or, in the active set, would have a KKT
 * violation.
 */
uint32_t pzs_boxls_find_direction(pzs_optimiser *optimiser, pzs_real rounding);

/* Clamp voltages that are outside their bounds. If there were any, renew the gradient and return
 * true. */
bool pzs_boxls_enforce_limits(pzs_optimiser *optimiser);

/*
 * From the model gradient to the optimum, as far as work_limit allows it. Adds to iterations and
 * work; sets kkt_violation, rounding_bound and is_optimal. The voltages come inside their bounds
 * and stay there.
 */
void pzs_boxls_optimise(pzs_optimiser *optimiser);

/* Largest KKT violation at voltages voltage [width] with this gradient [width] (m2/V). Uses
 * scratch. */
pzs_real pzs_boxls_violation(const pzs_optimiser *optimiser, const pzs_real *voltage,
                             const pzs_real *gradient);

/* Whether the rounding error of H (v - base) may cost more than epsilon of the target energy. */
bool pzs_boxls_needs_new_base(pzs_optimiser *optimiser);

#endif
