/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Least-squares fit of the readings during a test pulse, by which the fault detector of a loop that
 * damps vibration tests an electrode suspected of a fault and a healthy one together
 * (pulse_faults.c).
 */
#ifndef PZS_LIB_PULSE_FIT_H
#define PZS_LIB_PULSE_FIT_H

#include "pzs_loop.h"

/*
 * Smallest accepted difference between the modelled responses to the suspected and to the reference
 * electrode; with a smaller one the two cannot be tested together, and is_measured is false. The
 * difference is the part of the response to the reference electrode that is orthogonal to the other
 * response, divided by the whole response (ratio of sums of squares, dimensionless).
 */
#define PZS_PULSE_DEPENDENT PZS_R(0.05)

/*
 * Numbers of the two electrodes under test: the one suspected of a fault, and the reference
 * electrode, a healthy one with which it is compared.
 */
enum { SUSPECT = 0, REFERENCE };
/* Number of the modelled response to all electrodes that are not under test. */
enum { PZS_PULSE_OTHERS = 2 };

/*
 * Return the input of an electrode under test: SUSPECT is the electrode suspected of a fault,
 * REFERENCE the healthy one with which it is compared.
 */
static inline uint32_t tested_input(const pzs_pulse_detector_state *state, uint32_t number)
{
    return number == SUSPECT ? state->suspect : state->reference;
}

/*
 * Compute the gains (measured divided by modelled response) of the electrode suspected of a fault
 * and of the healthy reference electrode from the readings during their test pulses, and store them
 * in state->response. If the modelled responses to both electrodes are not independent, all members
 * of the result are zero, with is_measured false.
 */
void pzs_pulse_measure(pzs_pulse_detector_state *state);

/*
 * Compute by how much the readings have jumped during a measured test pulse, and store it in
 * state->response. Jumps that the voltages explain, with the measured gains of the electrodes, do
 * not count.
 */
void pzs_pulse_find_jumps(pzs_pulse_detector_state *state);

#endif
