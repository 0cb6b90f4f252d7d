/* SPDX-License-Identifier: BSD-2-Clause */
/* The command `pzs calibrate --hysteresis`: hysteresis and creep from a measured sweep. */
#ifndef COMMAND_SWEEP_H
#define COMMAND_SWEEP_H

#include "../model/calibrate.h"
#include "options.h"

/*
 * Identify hysteresis and creep from a sweep, print the section `hysteresis` of a scene and the
 * errors of the fit, and write the section to the output file that the options name.
 *   samples  in  voltages in one column, positions in one column or more, whose mean counts
 * Returns an exit code after printing the result or an error message.
 */
int command_sweep(const options *options, const pokes *samples);

#endif
