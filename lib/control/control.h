/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Functions of the controller for other parts of the library, such as the fault detector and the
 * vibration damper; programs that use the library call those in pzs_control.h.
 */
#ifndef PZS_LIB_CONTROL_H
#define PZS_LIB_CONTROL_H

#include "pzs_control.h"

/*
 * Value of state.stage by which other functions recognise a controller that was initialised without
 * an error.
 */
#define CONTROL_READY 1u

/*
 * Return the checksum of the counts and arrays in the tables of the controller, which their member
 * crc must equal.
 */
uint32_t pzs_problem_crc(const pzs_problem *problem);

/*
 * Return the checksum of the tables of the controller, and look for numbers that are not finite in
 * their influence matrix, Hessian, output weights and reference voltages. *bad receives the index
 * of the first such number in its array, or -1. Each array is read once.
 */
uint32_t pzs_problem_check(const pzs_problem *problem, int32_t *bad);

/*
 * Check the tables of the controller.
 *   influence [outputs][inputs] in   influence matrix that is used with them (m/V)
 *   where                       out  index to which the status refers, or -1
 * Returns PZS_OK or the errors of pzs_control_init.
 */
pzs_status pzs_control_check_problem(const pzs_problem *problem, const pzs_real *influence,
                                     int32_t *where);

/*
 * Compute product [outputs] = influence matrix in use, full or sparse, times voltages [inputs]. The
 * memory of the voltages must be readable up to the next multiple of four entries.
 */
void pzs_control_multiply(const pzs_control *control, pzs_real *product, const pzs_real *voltage);

/* Predict the shape of the present voltages if they have changed since the last tick. */
void pzs_control_predict(pzs_control *control);

/*
 * Do what pzs_step leaves to the next call: apply the pivot exchanges that the optimiser has
 * collected to its tableau (pivoted Hessian). A block of the loop must call this function in the
 * tick of its pzs_step, because pzs_control_restore discards collected exchanges.
 */
void pzs_control_complete(pzs_control *control);

/*
 * Tell the controller that another function than pzs_step or pzs_tick has changed its array
 * state.voltage; the next call of pzs_step or pzs_tick then starts from the new voltages.
 */
void pzs_control_moved(pzs_control *control);

/*
 * Make the next ticks damp vibration: half the gradient of their objective at the present voltages
 * is multiplied by `share`, and `damping` is subtracted. The Hessian does not change, so that a
 * tick goes only the part `share` of the way to the optimum.
 *   share            in      factor of the static gradient, at most 1; 0: damp vibration alone
 *   damping [inputs] in      gradient by which the vibration damper moves the voltages, read in
 *                            each tick, zero in static equilibrium (m2/V); NULL: ticks without
 *                            damping
 *   carry   [inputs] in/out  parts of voltage changes that converter steps have suppressed, kept by
 *                            pzs_quantise (V); 0 at first
 */
void pzs_control_damp(pzs_control *control, pzs_real share, const pzs_real *damping,
                      pzs_real *carry);

/*
 * Let a block change the gradient of the objective in the next pzs_tick, after the gradient was
 * computed and before the optimisation; NULL: none. The Hessian does not change.
 */
void pzs_control_filter(pzs_control *control, pzs_step_filter *filter);

/*
 * Record the voltage at which pzs_hold keeps an input (V), or NaN if it keeps none. The voltage
 * must be recorded with every change of the present voltage limits (state.lower, state.upper) that
 * is to last longer than one tick of a loop, because each tick derives these limits again.
 */
void pzs_control_set_held(pzs_control *control, uint32_t input, pzs_real voltage);

/* ---- parts of the initialisation that every tick repeats ---------------- */

/*
 * Set the pointers of the controller to its arrays in the workspace. The member state.problem,
 * which points to the tables of the controller, must be set before.
 */
void pzs_control_place(pzs_control *control, void *work);

/*
 * Compute row k of the Hessian B'W^2 B + regularisation I: from `table`, the matrix B'W^2 B of the
 * controller's tables, or, if `table` is NULL, from influence matrix B and output weights W. The
 * Hessian is symmetric to the last bit.
 */
void pzs_control_form_row(const pzs_control *control, const pzs_real *table, uint32_t k);

/*
 * Compute the Hessian B'W^2 B + regularisation I of the voltage optimisation. Overwrites the
 * tableau (pivoted Hessian) of the optimiser.
 *   table in  matrix B'W^2 B of the controller's tables; NULL: computed from influence matrix B and
 *             output weights W
 * Returns the index of the first entry of the Hessian that is not finite, or -1.
 */
int32_t pzs_control_form_hessian(const pzs_control *control, const pzs_real *table);

/*
 * Return the exclusive or of the words of the predicted shape, by which a tick notices that memory
 * was damaged since the shape was predicted.
 */
uint32_t pzs_control_predicted_sum(const pzs_control *control);

/*
 * Return the default of the largest number of multiply-adds that the optimiser may use in a tick.
 */
uint64_t pzs_control_usual_work(const pzs_problem *problem);

/*
 * Let the bounds of the voltages in a tick and the present voltage limits share their arrays,
 * where there are no step limits and both are always equal.
 */
void pzs_control_share_bounds(pzs_optimiser *optimiser, const pzs_control *control);

/*
 * Set the constants of a controller that follow from the diagonal of the Hessian and from the
 * regularisation weight: smallest admissible pivot, largest norm of a column of the weighted
 * influence matrix, and bound of the trace of the inverse Hessian.
 */
void pzs_control_set_constants(pzs_control *control);

/*
 * Set the step limits and the present voltage limits to those of the tables; for an input that
 * pzs_hold keeps at a voltage, both limits become this voltage. Also find out whether any step
 * limit is shorter than the distance between the voltage limits of its input.
 */
void pzs_control_restore_limits(pzs_control *control);

/*
 * Compute again from the tables, at the start of a tick of a loop, what damaged memory may have
 * changed: pointers and counts, present voltage limits, step limits, and one row of the Hessian. A
 * damaged predicted shape is computed again in this tick. Without damage no bit changes.
 *   influence [outputs][inputs] in  as passed to pzs_control_init
 *   work                        in  workspace of the controller
 * The work is about 30 operations for each input.
 */
void pzs_control_restore(pzs_control *control, const pzs_problem *problem,
                         const pzs_real *influence, void *work);

/*
 * Continue from the voltages in state.voltage after damaged memory was corrected. Each entry of the
 * Hessian is compared with the tables and repaired, and the tableau (pivoted Hessian) of the
 * optimiser and the predicted shape are computed anew.
 *   influence [outputs][inputs] in  as passed to pzs_control_init
 */
void pzs_control_recover(pzs_control *control, const pzs_real *influence);

#endif
