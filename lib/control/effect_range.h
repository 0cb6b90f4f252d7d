/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Control steps in effects of voltages, for blocks (stages of the control tick) whose actuators do
 * not move in proportion to their voltages: the range of voltages of a tick, and the start of the
 * optimiser from effects.
 */
#ifndef PZS_LIB_EFFECT_RANGE_H
#define PZS_LIB_EFFECT_RANGE_H

#include "control.h"
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
 * A change of an effect since the controller last predicted the shape counts as a rounding error if
 * it is at most this multiple of the machine epsilon times the largest effect.
 */
#define EFFECT_ROUNDING 256

/*
 * Replace the controller's voltages of the last tick, from which it starts, by their effects. The
 * step limits of the voltages do not hold for effects: the limits of the effects contain them.
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

#endif
