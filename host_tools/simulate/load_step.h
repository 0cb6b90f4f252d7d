/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Load steps: simulations of a control loop on a structure with mass, on which a load appears at
 * once.
 */
#ifndef LOAD_STEP_H
#define LOAD_STEP_H

#include "storm_rig.h"

/*
 * Simulate load steps: on a structure that equals the controller's model and is at rest, a load
 * appears at once, which the voltages can compensate. Measure the time until the shape has settled:
 * its distance from the best shape under the load stays below 5 % of the displacements that the
 * load causes without compensation.
 *
 * The loads are a uniform pressure, two forces at single outputs, and loads that move the first or
 * third vibration mode only. They do not move vibration modes whose phase advances by more than 0.6
 * rad in a tick, because the control tick does not damp those in full. To compensate a load, the
 * voltages change by at most 30 % of half the range between their limits. A load is left out if the
 * best voltages leave more than a fifth of the displacements that it causes.
 *   rig     in   data that all simulations of a loop share, with the control loop (storm_use)
 *   first   in   natural frequency of the first vibration mode that the loop observes (Hz)
 *   periods out  longest time of all loads, in periods of this mode, at most 8; NAN if the voltages
 *       can compensate none of the loads
 * Returns 0, or -1 with error filled.
 */
int load_step_periods(const storm_rig *rig, double first, double *periods, char *error);

#endif
