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
 * with its gradient multiplied by `share`, minus the damping gradient. A step of no change is
 * always allowed, so voltages at rest are those of the undamped tick. share             in  part of
 * the static gradient, 0 < share <= 1 damping [inputs]  in  damping gradient (m2/V), read in each
 * tick; NULL: undamped ticks again
 */
void pzs_control_damp(pzs_control *control, pzs_real share, const pzs_real *damping);

#endif
