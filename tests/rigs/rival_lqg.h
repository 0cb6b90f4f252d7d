/*
 * Linear quadratic Gaussian control (rival_lqg.c).
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef RIVAL_LQG_H
#define RIVAL_LQG_H

#include "rival_base.h"

/* Compute the feedback of the regulator. */
void lqg_open(rival *rival);

/* Return the governor to 0 V. */
void lqg_reset(rival *rival);

/* Compute law.next, the voltages of a tick before they are clipped. */
void lqg_choose(rival *rival, const pzs_loop_signals *signals);

#endif
