/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The command `pzs calibrate --hysteresis`: hysteresis and creep of an actuator from a measured
 * sweep (voltage that rises and falls, and the position at every sample).
 */
#ifndef CALIBRATE_HYSTERESIS_H
#define CALIBRATE_HYSTERESIS_H

#include "../model/calibrate.h"
#include "options.h"

/*
 * Identify hysteresis and creep from positions recorded while the voltage rises and falls (sweep).
 * Print the section `hysteresis` of a scene file, also written to the output file, and the errors
 * of the fit.
 *   samples  in  one voltage and one or more positions per sample; the mean of the positions is
 *       used
 * Returns an exit code after printing the result or an error message.
 */
int calibrate_hysteresis(const options *options, const pokes *samples);

#endif
