/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Output voltage of the amplifiers of a simulated structure: limits, step limit, resolution and
 * dead band.
 */
#include "amplifier.h"
#include <math.h>

bool amplifier_may_move(double from, double to, double step_limit)
{
    return to - from <= step_limit && from - to <= step_limit;
}

double amplifier_limited(double from, double to, double step_limit)
{
    to = fmin(fmax(to, from - step_limit), from + step_limit);
    while (!amplifier_may_move(from, to, step_limit))
        to = nextafter(to, from);
    return to;
}

/*
 * Output of the digital-to-analogue converter that is nearest to a voltage (V).
 *   resolution in  quantisation step of the converter (V); 0: no rounding
 */
static double converted(double voltage, double resolution)
{
    return resolution > 0 ? resolution * floor(voltage / resolution + 0.5) : voltage;
}

static bool is_allowed(const amplifier *amplifier, double before, double voltage)
{
    return voltage >= amplifier->lower && voltage <= amplifier->upper &&
           amplifier_may_move(before, voltage, amplifier->step_limit);
}

double amplifier_output(const amplifier *amplifier, double before, double command)
{
    const double inside = fmin(fmax(command, amplifier->lower), amplifier->upper);
    const double limited = amplifier_limited(before, inside, amplifier->step_limit);
    double voltage = converted(limited, amplifier->resolution);
    if (!is_allowed(amplifier, before, voltage))
        voltage += voltage > limited ? -amplifier->resolution : amplifier->resolution;
    const bool moves = fabs(command - before) > amplifier->dead_band;
    return moves && is_allowed(amplifier, before, voltage) ? voltage : before;
}
