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
 * Vibration of the first mode that the last motion of the target has left would look like a
 * response to a test pulse. As the readings of such a vibration have a known shape, the evaluation
 * of a pulse leaves out the part of the readings in this shape, except for the fraction
 * MODE_WEIGHT / (1 + MODE_WEIGHT), so that an electrode that moves the structure in nearly this
 * shape remains observable. MODE_WEIGHT is the weight of the equation that there is no vibration in
 * the least-squares fit of the readings, relative to the squared readings of the vibration.
 */
#define PZS_PULSE_MODE_WEIGHT PZS_R(0.01)

/*
 * Numbers of the two electrodes under test: the one suspected of a fault, and the reference
 * electrode, a healthy one with which it is compared.
 */
enum { SUSPECT = 0, REFERENCE };
/*
 * Further columns of the least-squares fit: readings of a vibration of the first mode, and modelled
 * response to all electrodes that are not under test.
 */
enum { PZS_PULSE_MODE = 2, PZS_PULSE_OTHERS };

/*
 * Return the input of an electrode under test: SUSPECT is the electrode suspected of a fault,
 * REFERENCE the healthy one with which it is compared.
 */
static inline uint32_t tested_input(const pzs_pulse_detector_state *state, uint32_t number)
{
    return number == SUSPECT ? state->suspect : state->reference;
}

/*
 * Return the reading of sensor i per coordinate of the first vibration mode (unit of the sensor per
 * m), 0 if it is not known.
 */
static inline pzs_real mode_reading(const pzs_pulse_detector_state *state, uint32_t i)
{
    return state->mode != NULL ? state->mode[i * state->mode_step] : 0;
}

/*
 * At the end of a test pulse, compute the modelled response to all electrodes that are not under
 * test (state->difference), which pzs_pulse_measure uses.
 */
void pzs_pulse_predict(pzs_pulse_detector_state *state);

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
