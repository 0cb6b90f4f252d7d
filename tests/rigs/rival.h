/*
 * Rivals: control laws of the literature and of earlier designs on a modal plant, to compare the
 * library's vibration damper with. Each runs in the loop of damped_loop.h, within the same voltage
 * limits and step limits. In double only.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef RIVAL_H
#define RIVAL_H

#include "rival_base.h"

/*
 * Make a rival for a structure and put it into a loop at rest.
 *   delay  in  age of the readings for which the rival is designed (ticks)
 *   rival  out must not be moved in memory until rival_close
 */
void rival_open(rival *rival, const modal_structure *structure, double interval, double step_limit,
                int delay, const rival_settings *settings);
void rival_close(rival *rival);

/*
 * Multiply-adds of a tick of the rival's law without its optimiser, as an efficient program needs
 * them: products of matrices that do not change with vectors.
 */
double rival_work(const rival *rival);

/* Settings of a damper that only observes: the control step then moves to the static optimum. */
damper_settings rival_observer(double kick, double drift);

#endif
