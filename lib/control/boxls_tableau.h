/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The tableau (pivoted Hessian) of the voltage optimiser: one symmetric matrix that replaces the
 * Hessian H. With the columns of F on the left and those of A on the right, it is
 *
 *   rows F:  -H_FF^-1        H_FF^-1 H_FA
 *   rows A:  H_AF H_FF^-1    H_AA - H_AF H_FF^-1 H_FA
 *   F     free set: inputs whose voltages may change
 *   A     active set: inputs whose voltages are kept
 *   H_FA  rows of F and columns of A in H, and so on
 *
 *   - A pivot exchange moves one input between F and A by a symmetric rank-one update.
 *   - Up to PZS_PENDING updates are applied together, which reads and writes the matrix only once,
 *     with the same bits as one by one.
 *   - The tableau times the gradient of F is the search direction: for F the step to the minimum
 *     over F, for A the change of the gradient by this step.
 */
#ifndef PZS_LIB_BOXLS_TABLEAU_H
#define PZS_LIB_BOXLS_TABLEAU_H

#include "optimiser.h"

/*
 * Return the pivot of input k, whose voltage is kept at a bound, divided by its diagonal entry of
 * the Hessian: 1 if the effect of the input on the shape is independent of the effects of the
 * inputs whose voltages are free, 0 if it is a linear combination of these.
 */
pzs_real pzs_tableau_independence(const pzs_optimiser *optimiser, uint32_t k);

/*
 * Read the pivots of all inputs from the diagonal of the tableau, the optimiser's pivoted Hessian.
 * While pivot exchanges are collected, nothing is read: each exchange has updated the pivots.
 */
void pzs_tableau_read_pivots(pzs_optimiser *optimiser);

/*
 * Compute row k of the tableau (the optimiser's pivoted Hessian), including the pivot exchanges
 * that are collected but not yet applied to the matrix. The width is the number of inputs, rounded
 * up for vector loops.
 *   row [width] out  row k of the tableau
 */
void pzs_tableau_row(pzs_optimiser *optimiser, uint32_t k, pzs_real *restrict row);

/*
 * Make one pivot exchange in the tableau (the optimiser's pivoted Hessian), which makes the voltage
 * of input k free (positive pivot) or keeps it at a bound (negative pivot).
 *   row [width] in/out  row k of the tableau before and after the exchange
 */
void pzs_tableau_exchange(pzs_optimiser *optimiser, uint32_t k, pzs_real *restrict row);

/*
 * Apply the collected pivot exchanges to all entries of the tableau, the optimiser's pivoted
 * Hessian. On hosts with the vector unit AVX2, while the tableau is computed anew, only the entries
 * up to the diagonal are kept up to date.
 */
void pzs_tableau_apply(pzs_optimiser *optimiser);

/*
 * Apply the collected pivot exchanges to the tableau (pivoted Hessian), as pzs_tableau_apply does.
 * At the start and the end of a tick usually no exchange is collected; this function then avoids a
 * call.
 */
static inline void tableau_apply_collected(pzs_optimiser *optimiser)
{
    if (optimiser->pending_count > 0)
        pzs_tableau_apply(optimiser);
}

/*
 * End a recomputation of the tableau (the optimiser's pivoted Hessian), so that all of its entries
 * are up to date. All collected pivot exchanges must have been applied before.
 */
void pzs_tableau_complete(pzs_optimiser *optimiser);

/*
 * Begin to recompute the tableau (pivoted Hessian): copy the Hessian into it, which is the tableau
 * without any free input. The inputs that were free (with the dual active-set method: all) are
 * marked, so that pzs_tableau_rebuild makes them free again.
 */
void pzs_tableau_reset(pzs_optimiser *optimiser);

/*
 * Prepare the optimiser to collect up to PZS_PENDING pivot exchanges before it applies them to its
 * tableau (pivoted Hessian).
 *   pending [PZS_PENDING][width] in  memory for the rank-one updates of the exchanges
 */
void pzs_tableau_collect(pzs_optimiser *optimiser, pzs_real *pending);

/*
 * Continue to recompute the tableau (the optimiser's pivoted Hessian): move the inputs that were
 * free before pzs_tableau_reset back into the free set, the most independent first, as far as the
 * work limit allows. Linearly dependent inputs stay active. Returns whether the tableau is
 * complete. Overwrites next_voltage.
 */
bool pzs_tableau_rebuild(pzs_optimiser *optimiser);

/*
 * Return the trace of the inverse of the Hessian, restricted to the free inputs (V2/m2), with which
 * the optimiser bounds by how much a small gradient can raise the objective. An active input that
 * depends linearly on the free ones counts as free, with the smallest accepted pivot.
 */
pzs_real pzs_tableau_inverse_trace(pzs_optimiser *optimiser);

#endif
