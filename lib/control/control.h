/* SPDX-License-Identifier: BSD-2-Clause */
/* Controller internals shared with the optional blocks of the tick. */
#ifndef PZS_LIB_CONTROL_H
#define PZS_LIB_CONTROL_H

#include "pzs_control.h"

#define CONTROL_READY 1u /* value of state.stage after a successful pzs_control_init */

/* Checksum of the counts and arrays of a problem, as stored in its crc field. */
uint32_t pzs_problem_crc(const pzs_problem *problem);

/* Renew state.predicted = B voltage if voltages have changed since the last tick. */
void pzs_control_predict(pzs_control *control);

/* To be called after state.voltage was changed outside a step: the next step or tick starts from
 * the new voltages. */
void pzs_control_moved(pzs_control *control);

/*
 * Make the next ticks damped ticks: from the present voltages, a tick minimises the static problem
 * with its gradient multiplied by `share`, minus the damping gradient. No change of the voltages
 * is always allowed, and at rest they are those of the undamped tick.
 *   share             in      part of the static gradient, 0 < share <= 1
 *   damping [inputs]  in      damping gradient (m2/V), read in each tick; NULL: undamped ticks
 * again carry [inputs]    in/out  0 at first, then kept by pzs_quantise (V)
 */
void pzs_control_damp(pzs_control *control, pzs_real share, const pzs_real *damping,
                      pzs_real *carry);

/*
 * Record at which voltage an input is held (V), NaN: not held. To be called beside every change of
 * state.lower and state.upper that is to last beyond the tick of a loop.
 */
void pzs_control_set_held(pzs_control *control, uint32_t input, pzs_real voltage);

/* ---- parts of the initialisation that a loop repeats (control.c, restore.c) */

/* Point the arrays of the controller into its workspace. The problem is set. */
void pzs_control_place(pzs_control *control, void *work);

/*
 * Row k of H: from the table of the problem, or, without one, the sum over the outputs of W^2 B_ik
 * B_i; symmetric to the last bit.
 */
void pzs_control_form_row(const pzs_control *control, const pzs_real *table, uint32_t k);

/* Find out whether some step limit is shorter than the distance between the voltage limits. */
void pzs_control_find_step_limits(pzs_control *control);

/* Without step limits, the bounds of a step are the limits in force: both share their arrays. */
void pzs_control_share_bounds(pzs_optimiser *optimiser, const pzs_control *control);

/* Numbers of the optimiser that follow from the diagonal of H and the regularisation. */
void pzs_control_set_constants(pzs_control *control);

/*
 * Derive again, at the start of a tick of a loop, what damaged memory may have changed: pointers
 * and counts, limits in force, step limits, and one row of the Hessian.
 *   influence [outputs][inputs] in  as passed to pzs_control_init
 *   work                        in  workspace of the controller
 * Without damage no bit changes. Work: about 30 operations an input.
 */
void pzs_control_restore(pzs_control *control, const pzs_problem *problem,
                         const pzs_real *influence, void *work);

/*
 * Continue from the voltages in state.voltage after damaged memory was corrected: the Hessian is
 * compared with the one of the tables or of the influence matrix, entry by entry, and tableau and
 * predicted shape are computed anew.
 *   influence [outputs][inputs] in  as passed to pzs_control_init
 */
void pzs_control_recover(pzs_control *control, const pzs_real *influence);

#endif
