/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Load steps: simulations of a control loop on a structure with mass, on which a load appears at
 * once.
 */
#ifndef LOAD_STEP_H
#define LOAD_STEP_H

#include "storm_rig.h"

/*
 * Simulate load steps: a load that the voltages can compensate appears at once on a structure at
 * rest, as the model has it. Measure the time until the shape stays within 5 % of the effect of the
 * load (its displacements without compensation) from the best shape under the load.
 *
 * The loads are a uniform pressure, two forces at single outputs, and loads that move the first or
 * third vibration mode only, without their parts in vibration modes that turn by more than 0.6 rad
 * in a tick: the control tick does not damp those in full. They need 30 % of the voltage range from
 * the middle to a limit. Loads of which the best voltages leave more than a fifth are left out.
 *   rig     in   data that all storms share, with the control loop (storm_use)
 *   first   in   natural frequency of the first vibration mode that the loop observes (Hz)
 *   periods out  longest time of all loads, in periods of this mode, at most 8; NAN where the
 *                voltages can compensate none of the loads
 * Returns 0, or -1 with error filled.
 */
int load_step_periods(const storm_rig *rig, double first, double *periods, char *error);

#endif
