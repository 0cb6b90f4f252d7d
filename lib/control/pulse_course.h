/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Course in time of the responses to a test pulse, by which the fault detector of a loop that damps
 * vibration (pulse_faults.c) tells an electrode that does not respond from a healthy one whose
 * response a load hides: a load that comes and goes during the pulse, or that follows another
 * course than the pulse, leaves a difference that changes with time.
 *
 *   shown voltage   z = A^-1 b: the changes of voltage of both electrodes under test that the
 *                   readings show in a tick (V)
 *   A [2][2]        scalar products of the modelled responses per volt of both electrodes (1/V2)
 *   b [2]           scalar products of these with the changes of the readings since the first tick
 *                   of the pulse, without those that the voltages of all other electrodes explain;
 *                   in A and b the shape of the first vibration mode is left out (pulse_fit.h)
 *   course error    largest minus smallest mean of z - gain * given voltage over windows of one
 *                   period of the first vibration mode, which vibration of this mode hardly changes
 *
 * Responses are changes of readings, each times the scale factor of its sensor. Sums over parts of
 * the pulse are stored, so that the memory does not depend on its duration.
 */
#ifndef PZS_LIB_PULSE_COURSE_H
#define PZS_LIB_PULSE_COURSE_H

#include "pzs_loop.h"

/*
 * Add the voltages of a tick of a test pulse to the course of the responses.
 *   tick             in  number of the tick within the pulse; 0 begins a new course
 *   voltage [inputs] in  voltages that act on the structure (V)
 */
void pzs_pulse_course_voltages(pzs_pulse_detector_state *state, uint32_t tick,
                               const pzs_real *voltage);

/*
 * Add the last readings to the course of the responses to a test pulse.
 *   tick in  number of the tick within the pulse whose voltages the readings show
 */
void pzs_pulse_course_readings(pzs_pulse_detector_state *state, uint32_t tick);

/*
 * At the end of a measured test pulse, compute the course errors of both electrodes under test, and
 * store them in state->response.
 */
void pzs_pulse_course_errors(pzs_pulse_detector_state *state);

#endif
