/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The command `pzs calibrate --vibration`: vibration modes of a structure from measured steps of
 * the voltages.
 */
#ifndef CALIBRATE_VIBRATION_H
#define CALIBRATE_VIBRATION_H

#include "../model/calibrate.h"
#include "options.h"

/*
 * Identify vibration modes from a measurement. Print frequencies and damping ratios with standard
 * errors, and the key `modes` of the section `influence` of a scene, also written to the output
 * file.
 *   samples  in  voltages and readings, a line for each sample
 * Returns an exit code after printing the result or an error message.
 */
int calibrate_vibration(const options *options, const pokes *samples);

#endif
