/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Identification of hysteresis and creep of a ceramic actuator from one measured sweep of voltage
 * and position. Most suitable is a triangle wave of decreasing amplitude, followed by a constant
 * voltage. Bounded least squares determine the numbers of the section `hysteresis` of a scene file,
 * except slacks and time constants, which are prescribed. The model is
 *   position = position at the start + gain x effect.
 *   effect  voltage (V) that would cause the same position without hysteresis and creep
 *           (pzs_hysteresis)
 *   gain    position per volt of the effect
 */
#ifndef IDENTIFY_H
#define IDENTIFY_H

#include "../scene/scene.h"

/* Measured sweep of an actuator: samples of its voltage and position at a constant rate. */
typedef struct sweep {
    size_t count; /* number of samples of the actuator's voltage and position, at most 60000 */
    const double *voltage;  /* [count] voltage that was applied between the previous sample and this
                               one (V) */
    const double *position; /* [count] measured position of the actuator at each sample, in any unit
                               of length */
    double rate; /* number of samples of the actuator's voltage and position in a second (1/s) */
} sweep;

typedef struct identification {
    scene_hysteresis hysteresis;
    double gain; /* change of the actuator's position per volt without hysteresis and creep (unit of
                    the position per V) */
    double rms; /* root mean square difference between measured and fitted position of the actuator,
                   relative to the range of the measured positions */
    double largest;  /* largest difference between measured and fitted position of the actuator,
                        relative to the range of the measured positions */
    double straight; /* root mean square difference between the actuator's measured positions and a
                        straight line over the voltage, fitted by least squares, relative to the
                        range of the positions */
} identification;

/*
 * Fit the hysteresis and creep model to a measured sweep of an actuator.
 *   plays in   number of play operators, 1 to SCENE_PLAYS; more than 8 hardly improve the fit
 *   gain  in   position per volt without hysteresis and creep; 0: unknown, taken as the change of
 *       position over that of voltage, from the lowest to the highest voltage
 *   error [SCENE_ERROR] out  message
 * Returns 0, or -1 with error filled: memory runs out, too few or too many samples, a number not
 * finite, a constant voltage, or a position that does not rise with the voltage.
 */
int identify(identification *result, const sweep *sweep, int plays, double gain, char *error);

#endif
