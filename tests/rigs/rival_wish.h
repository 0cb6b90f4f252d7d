/*
 * Damped wish (rival_wish.c).
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef RIVAL_WISH_H
#define RIVAL_WISH_H

#include "rival_base.h"

/* Compute the damping factors of the modes. */
void wish_open(rival *rival);

/*
 * Change the target of a tick: subtract the damping factors times the velocities of the modes.
 *   wanted, changed [outputs] in, out  target (m)
 */
void wish_change(const rival *rival, const pzs_real *wanted, pzs_real *changed);

#endif
