/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Effects of voltages on actuators that are not linear: values to which the displacements are
 * proportional (actuator_effect.h).
 */
#include "actuator_effect.h"
#include <stddef.h>

/*
 * Add to an effect (value to which the displacement of the actuator is proportional) the amount by
 * which the simulated structure deviates from the actuator curve in the tables. The amount is a
 * parabola over the effect.
 *   first, last  effects of the first and the last point of the curve (V)
 */
static double add_error(double effect, double first, double last, double error)
{
    const double part = (effect - first) / (last - first);
    return effect + 4 * error * (last - first) * part * (1 - part);
}

double actuator_effect(const actuator_curves *curves, int amplifier, double voltage)
{
    if (curves->sets == 0)
        return voltage;
    const int set = curves->sets > 1 ? amplifier : 0, last = curves->points - 1;
    const double *v = curves->voltage + (size_t)set * (size_t)curves->points;
    const double *e = curves->effect + (size_t)set * (size_t)curves->points;
    int i = 0;
    while (i + 1 < last && voltage >= v[i + 1])
        i++;
    const double bend = curves->bend ? curves->bend[set * last + i] : 0;
    const double t = (voltage - v[i]) / (v[i + 1] - v[i]);
    const double effect = e[i] + (e[i + 1] - e[i]) * t * (1 - bend * (1 - t));
    return add_error(effect, e[0], e[last], curves->error);
}
