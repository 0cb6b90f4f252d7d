/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Identification of the static responses of vibration modes to the voltages: after a voltage step a
 * mode vibrates about its new static value. The amplitude is static response times step; the phase
 * tells the delay of the voltages.
 */
#ifndef IDENTIFY_RESPONSES_H
#define IDENTIFY_RESPONSES_H

#include "calibrate.h"

/*
 * Static responses of vibration modes to voltages, identified from a record of voltages and
 * readings.
 */
typedef struct mode_responses {
    bool is_found; /* true where the static responses of the vibration modes are identified */
    char reason[SCENE_ERROR]; /* why the static responses of the vibration modes are not identified;
                                 otherwise empty */
    double *value; /* [modes][actuators] static response of each vibration mode to 1 V of each
                      actuator, as a multiple of its shape (unit of the readings per volt) */
    double *error; /* [modes][actuators] standard errors of the static responses of the vibration
                      modes to 1 V of each actuator */
    double delay;  /* time between a recorded step of the voltages and its effect (s) */
} mode_responses;

/* Free vibration of the vibration modes in the intervals of constant voltages of a record. */
typedef struct free_vibration {
    const pokes *samples;
    size_t modes;
    const double *frequency, *damping; /* [modes] angular frequencies of the vibration modes (rad/s)
                                          and their damping ratios */
    double rate; /* number of samples in a second of the record of voltages and readings (1/s) */
    size_t intervals;    /* number of intervals of constant voltages in the record of voltages and
                            readings */
    size_t skipped;      /* number of samples between a step of the voltages and the first sample to
                            which free vibration is fitted */
    const size_t *first; /* [intervals] number of the first sample of each interval of constant
                            voltages to which free vibration was fitted */
    const size_t *behind; /* [intervals] number of the first sample behind each interval of constant
                             voltages */
    const double _Complex *amplitude; /* [modes][intervals] complex amplitudes of the free vibration
                                         of each mode, at the first fitted sample of each interval
                                         of constant voltages; multiples of the mode's shape */
} free_vibration;

/*
 * Identify the static responses of the vibration modes to 1 V of each actuator, and the delay with
 * which the voltages act. Returns whether memory sufficed; call mode_responses_free in either case.
 */
bool identify_responses(mode_responses *result, const free_vibration *record);
void mode_responses_free(mode_responses *result);

#endif
