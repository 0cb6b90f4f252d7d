/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Functions for actuators that do not move in proportion to their voltages, because of hysteresis
 * or a curve. The optimiser then chooses effects instead of voltages: the displacement of an
 * actuator is proportional to its effect. The functions compute the range of voltages that the
 * limits allow in one tick, and let the optimiser start from the effects of the last tick.
 */
#ifndef PZS_LIB_EFFECT_RANGE_H
#define PZS_LIB_EFFECT_RANGE_H

#include <string.h>
#include "control.h"
#include "pzs_loop.h"
#include "step_bounds.h"

/*
 * Compute the lowest and the highest voltage of input k that voltage limits and step limit allow in
 * a tick. If the two limits do not overlap, the voltage limits take precedence.
 *   given     in   voltage of the last tick (V)
 *   low, high out  range of the voltage (V)
 * Returns whether the limits overlap.
 */
static inline bool effect_set_range(const pzs_control *control, uint32_t k, pzs_real given,
                                    pzs_real *low, pzs_real *high)
{
    const pzs_real lower = control->state.lower[k], upper = control->state.upper[k];
    const pzs_real down = step_down(given, control->state.step_limit[k]);
    const pzs_real up = step_up(given, control->state.step_limit[k]);
    const pzs_real least = down > lower ? down : lower;
    const pzs_real most = up < upper ? up : upper;
    const bool overlaps = least <= most;
    const pzs_real limit = given < lower ? lower : upper;
    *low = overlaps ? least : limit;
    *high = overlaps ? most : limit;
    return overlaps;
}

/*
 * The effects of actuators that are not linear are the values to which their displacements are
 * proportional. A change of an effect since the controller last predicted the shape counts as a
 * rounding error if it is at most this multiple of the machine epsilon times the largest effect.
 */
#define EFFECT_ROUNDING 256

/*
 * Replace the controller's voltages of the last tick, from which the optimiser starts, by their
 * effects: values to which the displacements of the actuators are proportional. Step limits are
 * switched off, because they hold for voltages; the limits of the effects contain them already.
 *   effect [inputs] in  effects of the voltages of the last tick
 *   is_known        in  whether the effects equal those of the controller's last prediction up to
 *                       rounding errors, so that the prediction stays valid
 */
static inline void effect_take(pzs_control *control, const pzs_real *effect, bool is_known)
{
    const pzs_real *source = is_known ? control->state.optimiser.base : effect;
    for (uint32_t k = 0; k < control->state.problem->inputs; k++)
        control->state.voltage[k] = source[k];
    if (!is_known)
        pzs_control_moved(control);
    control->state.has_step_limits = false;
    pzs_control_share_bounds(&control->state.optimiser, control);
}

/*
 * Return the effects of the present voltages of the controller (V): values to which the
 * displacements of the actuators are proportional, in a loop without actuator curves the voltages
 * themselves. The effects stand in the work array of the optimiser.
 */
static inline const pzs_real *effect_of_voltages(const pzs_loop_signals *signals)
{
    const pzs_control *control = signals->control;
    pzs_real *effect = control->state.optimiser.scratch;
    if (signals->take_effects == NULL)
        return control->state.voltage;
    memcpy(effect, control->state.voltage, control->state.problem->inputs * sizeof *effect);
    signals->take_effects(signals, effect);
    return effect;
}

/*
 * Predict the shape under the present voltages, unless the last prediction is still valid. In a
 * loop with actuator curves the voltages are first replaced by their effects, to which the
 * displacements are proportional.
 */
static inline void effect_predict(const pzs_loop_signals *signals)
{
    pzs_control *control = signals->control;
    pzs_real *voltage = control->state.voltage, *kept = control->state.optimiser.scratch;
    const size_t bytes = control->state.problem->inputs * sizeof *voltage;
    if (signals->take_effects == NULL || control->state.behind == PZS_BEHIND_NOTHING) {
        pzs_control_predict(control);
        return;
    }
    memcpy(kept, voltage, bytes);
    signals->take_effects(signals, voltage);
    pzs_control_predict(control);
    memcpy(voltage, kept, bytes);
}

#endif
