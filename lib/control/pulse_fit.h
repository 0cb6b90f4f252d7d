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

/*
 * Return the input of an electrode under test: SUSPECT is the electrode suspected of a fault,
 * REFERENCE the healthy one with which it is compared.
 */
static inline uint32_t tested_input(const pzs_pulse_detector_state *state, uint32_t number)
{
    return number == SUSPECT ? state->suspect : state->reference;
}

/*
 * Result of one test pulse that two electrodes make together: the one suspected of a fault and a
 * healthy one with which it is compared.
 */
typedef struct pulse_response {
    /*
     * gain (measured divided by modelled response to the test pulse, dimensionless) of the
     * electrode suspected of a fault [0] and of the healthy one with which it is compared [1]
     */
    pzs_real gain[2];
    /*
     * jump of the readings in the middle of the test pulse, for example by a load: as a multiple of
     * the modelled response to the electrode suspected of a fault [0], and to the healthy one [1]
     * (dimensionless). A large jump makes the gains unreliable
     */
    pzs_real jumped[2];
    /*
     * unexplained part of the measured response (dimensionless): sum of squares of the part that no
     * modelled response explains, divided by the sum of squares of the modelled response
     */
    pzs_real unexplained;
    bool is_measured; /* whether the gains (measured over modelled response) of the suspected and of
                         the healthy electrode can be trusted; false: a load or a motion has
                         disturbed the test pulse, or readings were missing */
} pulse_response;

/*
 * Compute the gains (measured divided by modelled response) of the electrode suspected of a fault
 * and of the healthy reference electrode from the readings during their test pulses. If the
 * modelled responses to both are not independent, all members of the result are zero, with
 * is_measured false.
 */
pulse_response pzs_pulse_response(pzs_pulse_detector_state *state);

#endif
