/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Dual active-set method of the voltage optimiser for many inputs (Goldfarb and Idnani 1983). An
 * active input is kept at a bound by its multiplier. The tableau stays the negative inverse of the
 * whole Hessian; a Cholesky factor of the inverse restricted to the active inputs gives the
 * multipliers.
 */
#ifndef PZS_LIB_BOXLS_DUAL_H
#define PZS_LIB_BOXLS_DUAL_H

#include "optimiser.h"

/*
 * Numbers of the work arrays of the dual active-set method, each with an entry for each input. They
 * use the memory of the vectors in which the primal method collects pivot exchanges.
 */
enum { DUAL_SOLUTION, DUAL_CHANGE, DUAL_RESPONSE, DUAL_COSINE };

static inline pzs_real *dual_array(const pzs_optimiser *optimiser, uint32_t k)
{
    return optimiser->pending + k * optimiser->width;
}

/*
 * Return the bound (V) at which the optimiser keeps the voltage of input i, which is active (at a
 * bound).
 */
static inline pzs_real dual_bound(const pzs_optimiser *optimiser, uint32_t i)
{
    return optimiser->side[i] < 0 ? optimiser->lower[i] : optimiser->upper[i];
}

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
 * Return the number of multiply-adds by which a round (sequence of iterations) of the dual
 * active-set method exceeds PZS_ROUND_WORK, the work of a round of the primal method.
 */
uint64_t pzs_dual_round_work(const pzs_optimiser *optimiser);

/*
 * Return whether the voltage of each active input (one that is kept at a bound) is equal to this
 * bound.
 */
bool pzs_is_at_bounds_dual(const pzs_optimiser *optimiser);

/*
 * Predict the full step to the minimum of the objective over the free voltages, with active
 * voltages at their bounds. Returns the number of inputs that would be outside their bounds or have
 * a multiplier of the wrong sign.
 *   rounding in  multipliers of the wrong sign up to this size do not count (m2/V)
 * Arrays [inputs] of the optimiser:
 *   direction    in   tableau * (gradient for the free inputs, 0 for the others) (V)
 *                out  for a free input the step of its voltage (V), for an active input the
 *                     multiplier of its bound (m2/V)
 *   next_voltage out  voltages after the step (V)
 *   scratch      out  voltages after the step minus the base voltages (V)
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
 * the wrong sign. The start is next_voltage, as pzs_predict_step_dual leaves it. The result,
 * clamped to the bounds, becomes the optimiser's voltages.
 *   rounding in  multipliers of the wrong sign up to this size do not count (m2/V)
 * Returns false if the iterations ended early, for example at the work limit.
 */
bool pzs_iterate_dual(pzs_optimiser *optimiser, pzs_real rounding);

/*
 * Make a round (sequence of iterations) of the dual active-set method where no sums of voltages are
 * limited. If much of the active set is wrong after a few iterations, as after a jump of the
 * target, a new active set is estimated from the Hessian, which takes less work than further
 * iterations.
 */
bool pzs_run_round_dual(pzs_optimiser *optimiser, pzs_real rounding);

/* ---- parts of the iterations, also for sums of absolute values ------------- */

/*
 * Prepare a round (sequence of iterations) of the dual active-set method. Returns the iteration
 * count at which the round must end; the count includes the iterations of earlier rounds.
 */
uint32_t pzs_dual_begin_round(pzs_optimiser *optimiser);

/*
 * Whether the work limit of the optimiser allows `cost` more multiply-adds now. Enough of the limit
 * is kept for the end of the present round (sequence of iterations), where the gradient may have to
 * be computed twice: two products of the Hessian with a vector.
 */
bool pzs_dual_affords(const pzs_optimiser *optimiser, uint64_t cost);

/*
 * Make free all active inputs (whose voltages are kept at a bound) whose multipliers have the wrong
 * sign, until no active input has such a multiplier, or until the work limit stops the optimiser.
 *   rounding in  multipliers of the wrong sign up to this size do not count (m2/V)
 */
void pzs_dual_drop_wrong(pzs_optimiser *optimiser, pzs_real rounding);

/*
 * Choose the free input whose voltage is farthest outside its bounds, set its multiplier to zero,
 * and store the bound to which it must go in the array `side`. Returns the number of inputs if all
 * voltages are inside up to rounding errors.
 */
uint32_t pzs_dual_choose_outside(const pzs_optimiser *optimiser);

/*
 * Count one more iteration of the dual active-set method, if its work is within the work limit.
 * Otherwise set is_cut: the work limit has stopped the optimiser. Returns whether the iteration may
 * be made.
 *   extra in  work that the caller adds to that of the iteration (multiply-adds)
 */
bool pzs_dual_may_iterate(pzs_optimiser *optimiser, uint64_t extra);

/*
 * Prepare the step in which free input i becomes active: compute how the other multipliers and all
 * voltages change per 1 m2/V of its multiplier, while active voltages stay at their bounds. Results
 * in work arrays:
 *   DUAL_SOLUTION [active_count] out  row that the input would have in the Cholesky factor of the
 *                                     inverse Hessian restricted to the active inputs
 *   DUAL_CHANGE   [active_count] out  change of the multipliers of the active inputs
 *                                     (dimensionless)
 *   DUAL_RESPONSE [width]        out  change of the voltages (V2/m2)
 * Returns the square of the last entry of the row (V2/m2).
 */
pzs_real pzs_dual_find_response(pzs_optimiser *optimiser, uint32_t i);

/*
 * Whether free input i may become active (kept at a bound): its voltage is linearly independent of
 * the active ones, and the active set has room.
 *   pivot in  result of pzs_dual_find_response (V2/m2)
 */
bool pzs_dual_may_join(const pzs_optimiser *optimiser, uint32_t i, pzs_real pivot);

/*
 * Whether it is only a rounding error that a voltage (or limited sum of voltages) seems to be
 * outside its bounds by the distance `outside` (V). It must be a linear combination of those that
 * are kept at their bounds. The iterations then ignore it until the gradient is next computed from
 * the Hessian.
 */
bool pzs_dual_is_rounding(const pzs_optimiser *optimiser, pzs_real outside);

/*
 * Find the active input whose multiplier becomes zero first in the present iteration, so that it
 * must become free. The iteration changes the multiplier of one free input, and those of the active
 * inputs in proportion.
 *   sense in      sign of the change of the free input's multiplier: 1 or -1
 *   part  in/out  in: size of this change in the whole iteration (m2/V); out: its size when the
 *                 multiplier of the found input becomes zero, unchanged if none is found
 * Returns the place of the found input in the list optimiser->order, or active_count if there is
 * none.
 */
uint32_t pzs_dual_first_zero(const pzs_optimiser *optimiser, pzs_real sense, pzs_real *part);

/*
 * Change the multiplier of free input i, whose voltage is outside its bounds, by `change` (m2/V),
 * so that the voltage moves towards its bound. The voltages next_voltage and the multipliers of the
 * active inputs change in proportion, with the factors that pzs_dual_find_response has computed.
 */
void pzs_dual_advance(pzs_optimiser *optimiser, uint32_t i, pzs_real change);

/*
 * Make next_voltage the voltages of the optimiser: active inputs exactly at their bounds, all
 * others clamped to their bounds.
 */
void pzs_dual_take_voltages(pzs_optimiser *optimiser);

#endif
