/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Actuators that are not linear, in the model of the controller: their voltages and effects. The
 * displacement of an actuator is proportional to its effect, and the influence matrix of a design
 * is the displacement per volt of effect. Where a scene has no actuator curves, effects are
 * voltages.
 */
#ifndef CURVES_H
#define CURVES_H

#include "actuator_effect.h"
#include "design.h"

/* Whether the scene gives curves of its actuators. */
bool curves_are_used(const design *design);

/*
 * Return the curves of a simulated plant whose actuators behave exactly as the scene states,
 * without errors.
 */
actuator_curves curves_of(const design *design);

/*
 * Make the tables of the curves for the controller (design.curves). The hash of the scene must be
 * known; the tables point to arrays of the scene.
 */
void curves_fill(design *design);

/*
 * Compute, from the actuator curves, the effects of voltages: values to which the displacements of
 * the actuators are proportional. Beyond the ends of a curve its first and last segments are
 * continued.
 *   voltage, effect [amplifiers] in, out (V)
 */
void curves_effects(const design *design, const double *voltage, double *effect);

/*
 * Narrow voltage limits to the ends of the curves. Limits of amplifiers that are held at one
 * voltage stay.
 *   lower, upper [amplifiers] in/out (V)
 */
void curves_narrow(const design *design, double *lower, double *upper);

/*
 * Compute, from the actuator curves, the effects (values proportional to the displacements of the
 * actuators) of voltage limits. The result equals that of the controller bit by bit. The limits
 * must lie inside the curves.
 *   limit, effect [amplifiers] in, out (V)
 */
void curves_limits(const design *design, const double *limit, double *effect);

/*
 * Compute, from the actuator curves, the voltages inside limits that have given effects (values
 * proportional to the displacements of the actuators). If an effect is that of a voltage limit, the
 * result is exactly this limit. The result equals that of the controller bit by bit.
 *   effect       [amplifiers] in   wanted effects (V)
 *   lower, upper [amplifiers] in   voltage limits (V)
 *   voltage      [amplifiers] out  voltages (V); may be the array of the effects
 */
void curves_voltages(const design *design, const double *effect, const double *lower,
                     const double *upper, double *voltage);

/*
 * Return half the range of the effect between the voltage limits of an amplifier (V); infinite
 * where a limit is infinite. The effect is proportional to the displacement of the actuator.
 */
double curves_half_range(const design *design, int amplifier);

/* Length of the text that describes the curves, with its NUL. */
enum { CURVES_TEXT = 400 };

/*
 * Describe the actuator curves in words: their kind, and how much the displacement per volt varies
 * between the voltage limits. The text is empty where the scene has no curves.
 */
void curves_text(const design *design, char text[CURVES_TEXT]);

#endif
