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

#endif
