/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Dual active-set method of the voltage optimiser for many inputs (Goldfarb and Idnani 1983). The
 * tableau (pivoted Hessian) stays the negative inverse of the whole Hessian. An active input is one
 * whose voltage is kept at a bound by its multiplier, which is the gradient of the objective there.
 * The multipliers follow from a Cholesky factor of the inverse of the Hessian restricted to the
 * active inputs.
 */
#ifndef PZS_LIB_BOXLS_DUAL_H
#define PZS_LIB_BOXLS_DUAL_H

#include "optimiser.h"

/*
 * Functions of the dual active-set method that the optimiser calls through pzs_problem.dual_method,
 * so that a program with few inputs does not link them.
 */
struct pzs_dual_calls {
    uint32_t (*predict_step)(pzs_optimiser *optimiser, pzs_real rounding);
    bool (*is_at_bounds)(const pzs_optimiser *optimiser);
    bool (*run_round)(pzs_optimiser *optimiser, pzs_real rounding);
    void (*check_active)(pzs_optimiser *optimiser);
};

/*
 * Set the pointers of the dual active-set method to its arrays in the memory `work` of
 * PZS_DUAL_REALS(inputs) reals. The member `inputs` of the optimiser must be set before.
 */
void pzs_dual_place(pzs_optimiser *optimiser, pzs_real *work);

/*
 * At the start of a control tick, make the voltages of all inputs free if the list of the inputs
 * whose voltages are at a bound is damaged, or if such a bound is not finite.
 */
void pzs_check_active_dual(pzs_optimiser *optimiser);

/*
 * Return the number of multiply-adds by which a round (sequence of iterations) of the dual active-
 * set method exceeds PZS_ROUND_WORK, the work of a round of the primal method.
 */
uint64_t pzs_dual_round_work(const pzs_optimiser *optimiser);

/*
 * Return whether the voltage of each active input (one that is kept at a bound) is equal to this
 * bound.
 */
bool pzs_is_at_bounds_dual(const pzs_optimiser *optimiser);

/*
 * Predict the full step to the minimum of the objective over the free voltages, with the voltages
 * of the active inputs at their bounds.
 *   rounding in  multipliers of the wrong sign up to this size do not count (m2/V)
 * The function uses three arrays [inputs] of the optimiser:
 *   direction    in   product of the tableau, the negative inverse of the Hessian, with the vector
 *                     that holds the gradient for the free inputs and 0 for the others (V)
 *                out  for a free input the step of its voltage (V), for an active input the
 *                     multiplier of its bound (m2/V)
 *   next_voltage out  voltages after the step (V)
 *   scratch      out  voltages after the step minus the base voltages, around which the gradient is
 *                     computed (V)
 * Returns the number of inputs that would be outside their bounds or have a multiplier of the wrong
 * sign.
 */
uint32_t pzs_predict_step_dual(pzs_optimiser *optimiser, pzs_real rounding);

/* Make the voltages of all inputs free, so that none is kept at a bound. */
void pzs_dual_free_all(pzs_optimiser *optimiser);

/* Make the voltage of input i free if it is kept at a bound. */
void pzs_dual_free(pzs_optimiser *optimiser, uint32_t i);

/*
 * Make the free input i active: keep its voltage at a bound from now on, with the multiplier zero.
 * The function changes nothing if the voltage of input i depends linearly on the voltages of the
 * active inputs, and therefore cannot be prescribed.
 *   side in  -1 for the lower bound, +1 for the upper one
 */
void pzs_dual_join(pzs_optimiser *optimiser, uint32_t i, pzs_real side);

/*
 * Solve for the voltages with all active inputs exactly at their bounds. The function changes the
 * multipliers of the active inputs, in the array `direction` (m2/V). In the array next_voltage (V)
 * it sets the voltages of the active inputs to their bounds and lets those of the free inputs
 * follow.
 */
void pzs_dual_move_to_bounds(pzs_optimiser *optimiser);

/*
 * Iterate the dual active-set method until no voltage is outside its bounds and no multiplier has
 * the wrong sign. It starts from the array next_voltage that pzs_predict_step_dual has set. The
 * voltages of the optimiser become those reached, clamped to the bounds. Returns false if the
 * iterations ended early, for example at the work limit.
 *   rounding in  multipliers of the wrong sign up to this size do not count (m2/V)
 */
bool pzs_iterate_dual(pzs_optimiser *optimiser, pzs_real rounding);

/*
 * Iterate the dual active-set method as pzs_iterate_dual does, where no sums of voltages are
 * limited. If a large part of the active set is still wrong after a few iterations, as after a jump
 * of the target, the active set is estimated as a whole from the Hessian. This takes less work than
 * to correct it by iterations.
 */
bool pzs_run_round_dual(pzs_optimiser *optimiser, pzs_real rounding);

#endif
