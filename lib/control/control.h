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
 * For comparison on the host: the unconstrained optimum for an error, and the same clamped to the
 * limits. Steps after it may differ in their last bits. voltage [inputs] out (V) Errors: ARGUMENT,
 * STAGE, NONFINITE.
 */
pzs_status pzs_unlimited(pzs_control *control, const pzs_real *error, pzs_real *voltage);
pzs_status pzs_clipped(pzs_control *control, const pzs_real *error, pzs_real *voltage);

#endif
