/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Tables of the control tick that damps vibration (pzs_vibration): observed modes, their shapes at
 * sensors and outputs, and gains (damper_gains.h). The observed modes are the lowest ones that move
 * the outputs and whose phase advances by at most 2 rad in a tick. Their number is smaller than
 * that of the sensors, and at most that of the amplifiers whose voltage can change. A unit modal
 * coordinate moves the outputs by a root mean square of 1.
 */
#ifndef DAMPER_H
#define DAMPER_H

#include <stdbool.h>
#include "damper_gains.h"
#include "estimator.h"

typedef struct damper {
    bool is_used; /* true where the control tick must damp vibration; the following members are set
                     only then */
    char reason[SCENE_ERROR]; /* where the control tick must damp vibration but cannot, the reason;
                                 otherwise empty */
    int modes;                /* number of vibration modes that the control tick observes */
    bool has_slow_mode; /* true where the phase of the first vibration mode advances slowly enough,
                           in radians a tick, for the control tick to observe this mode */
    double *frequency;  /* [modes] natural frequencies of the vibration modes that the control tick
                           observes (Hz) */
    double rate;        /* rate of the control tick that damps vibration (1/s) */
    double fading_periods; /* time in which the vibration that the supervisor tolerates after a jump
                              of the target falls by the factor e (periods of the first observed
                              mode) */
    double *memory; /* one allocation that holds all arrays of the vibration damper's tables */
    pzs_vibration tables;
} damper;

/*
 * Tick rate, age of the readings and settings for which the tables of a control tick that damps
 * vibration are made.
 */
typedef struct damper_options {
    double rate; /* rate of the control tick that damps vibration (1/s) */
    int delay;   /* delay of the sensor readings between measurement and use (ticks) */
    damper_settings settings;
} damper_options;

/*
 * Return the options for the tables of the vibration damper: tick rate and sensor delay of the
 * scene, and the settings that the stability tests of the loop have chosen.
 */
damper_options damper_options_of(const analysis *analysis);

/*
 * Make the tables of a control tick that damps vibration, whether the loop needs them or not.
 *   analysis   in  analysis with the least-squares problem for the voltages and the result of the
 *       stability tests; must outlive the damper
 *   estimator  in  shape estimator of the controller, which must outlive the damper; NULL: every
 *       target node is measured
 *   options    in  tick rate, age of the readings and settings
 * Returns 0, or -1 with error filled and `damper` unchanged.
 */
int damper_make(damper *damper, const analysis *analysis, const estimator *estimator,
                const damper_options *options, char *error);

/*
 * Make the tables of a control tick that damps vibration, on three conditions: the scene gives a
 * tick rate, it gives densities, and the control step alone would be unstable
 * (certificate_refuses). Otherwise, and with the option `quasi_static`, the damper is left unused.
 *   analysis   in  analysis with the least-squares problem for the voltages and the result of the
 *       stability tests; must outlive the damper
 *   estimator  in  shape estimator of the controller, which must outlive the damper; NULL: every
 *       target node is measured
 * Returns 0, or -1 with error filled and the damper unused.
 */
int damper_open(damper *damper, const analysis *analysis, const estimator *estimator, char *error);
void damper_close(damper *damper);

/*
 * Write one sentence on the vibration modes that the control tick observes to damp vibration, the
 * tick rate and the delay of the sensor readings.
 */
void damper_text(const damper *damper, char text[SCENE_ERROR]);

#endif
