/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Effects of voltages on actuators that are not linear. The displacement of an actuator is
 * proportional to its effect. `pzs shape`, `pzs simulate` and the plants that `pzs fmu` exports use
 * this function; the controller has its own (lib/control/actuator_curve.c).
 */
#ifndef ACTUATOR_EFFECT_H
#define ACTUATOR_EFFECT_H

/*
 * Curves of actuators that are not linear: effect e as a function of the voltage v. The
 * displacement of an actuator is proportional to its effect. Between two points (v0, e0) and (v1,
 * e1) of a curve
 *
 *   e = e0 + (e1 - e0) t (1 - b (1 - t)),  t = (v - v0) / (v1 - v0),  with the bend b
 *
 * The first and the last segment continue outside the curve.
 */
typedef struct actuator_curves {
    int sets;   /* number of actuator curves: 1 for all amplifiers together, otherwise one for each;
                   0: the displacement of each actuator is proportional to its voltage */
    int points; /* number of points of each curve */
    const double *voltage, *effect; /* [sets][points] points of each actuator curve, ascending:
                                       voltages, and effects (values to which the displacement of
                                       the actuator is proportional; V) */
    const double *bend; /* [sets][points - 1] bends of the segments of a curve (dimensionless);
                           NULL: all segments are straight */
    double error; /* largest deviation of the actual effects (values to which the displacements of
                     the actuators are proportional) from the curves, as a fraction of the range of
                     the effects. The deviation is a parabola over the effect: largest in the middle
                     of the range, 0 at both ends */
} actuator_curves;

/*
 * Return the value that an actuator's curve has at a voltage of its amplifier (V): the quantity to
 * which the displacement of the actuator is proportional.
 */
double actuator_effect(const actuator_curves *curves, int amplifier, double voltage);

#endif
