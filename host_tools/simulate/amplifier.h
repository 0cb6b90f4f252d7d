/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Amplifier of a simulated plant: voltage limits, step limit, resolution and dead band. `pzs
 * simulate` and the plants that `pzs fmu` exports use these functions.
 */
#ifndef AMPLIFIER_H
#define AMPLIFIER_H

#include <stdbool.h>

typedef struct amplifier {
    double lower, upper; /* lower and upper voltage limit of the amplifier (V) */
    double step_limit;   /* limit of the change of the amplifier's voltage in one tick (V) */
    double resolution;   /* quantisation step of the digital-to-analogue converter (V); 0: none */
    double dead_band;    /* largest change of the command that the amplifier ignores (V) */
} amplifier;

/*
 * Output voltage of an amplifier for a command (V). The amplifier enforces its voltage limits and
 * its step limit, rounds to its resolution, and ignores changes within its dead band.
 *   before in  output voltage before the command (V)
 */
double amplifier_output(const amplifier *amplifier, double before, double command);

/*
 * Limit the change of a voltage in one tick. Returns `to`, or the voltage nearest to `to` whose
 * computed difference from `from` does not exceed the step limit (V), not even by a rounding error.
 */
double amplifier_limited(double from, double to, double step_limit);

/* Whether a step limit allows a change of voltage, without any rounding tolerance. */
bool amplifier_may_move(double from, double to, double step_limit);

#endif
