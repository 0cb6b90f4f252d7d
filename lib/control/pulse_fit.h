/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Least-squares fit of the response to a test pulse of the fault detector of a loop that damps
 * vibration (pulse_faults.c).
 */
#ifndef PZS_LIB_PULSE_FIT_H
#define PZS_LIB_PULSE_FIT_H

#include "pzs_loop.h"

/*
 * Numbers of the two electrodes under test: the one suspected of a fault, and the reference
 * electrode, a healthy one with which it is compared.
 */
enum { SUSPECT = 0, REFERENCE };

/*
 * Return the input of an electrode under test: number SUSPECT is the suspected electrode, number
 * REFERENCE the healthy one with which it is compared.
 */
static inline uint32_t tested_input(const pzs_pulse_detector_state *state, uint32_t number)
{
    return number == SUSPECT ? state->suspect : state->reference;
}

/*
 * Result of one test pulse of the suspected electrode and of the reference electrode, a healthy
 * one.
 */
typedef struct pulse_response {
    pzs_real gain[2];   /* measured divided by modelled response, of the suspected electrode and of
                           the reference electrode (1) */
    pzs_real jumped[2]; /* jump of the readings during the test pulse in the shape of each of both
                           electrodes, relative to the modelled response (1) */
    bool is_measured;   /* false: a load or a motion has disturbed the test pulse, or readings were
                           missing */
} pulse_response;

/*
 * Compute the gains of the suspected electrode and of the reference electrode (a healthy one) from
 * the readings during their test pulses. The member is_measured of the result is false, and all
 * other members are zero, if the modelled responses to both electrodes are not independent.
 */
pulse_response pzs_pulse_response(pzs_pulse_detector_state *state);

#endif
