/*
 * Functions that the files of rival.h share: gains of the laws, and their voltages in a tick.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef RIVAL_PARTS_H
#define RIVAL_PARTS_H

#include "rival.h"

/* Estimates of the vibration damper of the rival's loop in the present tick. */
const pzs_damper_info *rival_estimates(const rival *rival);

/* Compute law.next: the static optimum without limits for law.required [outputs]. */
void rival_solve(rival *rival);

/* Compute and return the static optimum [inputs] within the voltage limits for law.required. */
const double *rival_solve_bounded(rival *rival);

/* Linear quadratic Gaussian control (rival_lqg.c). */
void lqg_open(rival *rival);
void lqg_choose(rival *rival, const pzs_loop_signals *signals);

/* Positive position feedback (rival_ppf.c). */
void ppf_open(rival *rival);
void ppf_reset(rival *rival);
void ppf_choose(rival *rival, const pzs_loop_signals *signals);
/* Take the voltages that the amplifiers will give as those of this tick. */
void ppf_keep(rival *rival);

/* Damping factors of RIVAL_WISH (rival_wish.c). */
void wish_open(rival *rival);
/* Change the target of the tick: minus the damping factors times the velocities of the modes. */
void wish_change(rival *rival, const pzs_real *wanted, pzs_real *changed);

#endif
