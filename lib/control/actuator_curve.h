/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Curve of one actuator: the effect of a voltage and the voltage of an effect. The displacement of
 * the actuator is proportional to the effect.
 */
#ifndef PZS_LIB_ACTUATOR_CURVE_H
#define PZS_LIB_ACTUATOR_CURVE_H

#include "pzs_loop.h"

/*
 * Return the effect of a voltage (V) on the actuator of an input, from the actuator's curve; the
 * displacement is proportional to the effect. Outside the curve this is the effect at the nearer
 * end; for NaN, that at the lower end.
 */
pzs_real pzs_actuator_curve_effect(const pzs_actuator_curves *tables, uint32_t input,
                                   pzs_real voltage);

/*
 * Return the voltage (V) at which the actuator of an input has a wanted effect, exact up to
 * rounding; the displacement is proportional to the effect. An effect outside the actuator's curve
 * gives the voltage of the nearer end; NaN, that of the lower end.
 */
pzs_real pzs_actuator_curve_voltage(const pzs_actuator_curves *tables, uint32_t input,
                                    pzs_real effect);

#endif
