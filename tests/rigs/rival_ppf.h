/*
 * Positive position feedback (rival_ppf.c).
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef RIVAL_PPF_H
#define RIVAL_PPF_H

#include "rival_base.h"

/* Compute filters and feedback. */
void ppf_open(rival *rival);

/* Return the filters to rest, for a plant in static equilibrium at 0 V; other kinds do nothing. */
void ppf_reset(rival *rival);

/* Compute law.next, the voltages of a tick before they are clipped. */
void ppf_choose(rival *rival, const pzs_loop_signals *signals);

/* Record the voltages without feedback of this tick, after ppf_choose. */
void ppf_keep(rival *rival);

#endif
