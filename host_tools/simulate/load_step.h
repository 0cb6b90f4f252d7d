/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Load steps: simulations of a control loop on a structure with mass, on which a load appears at
 * once.
 */
#ifndef LOAD_STEP_H
#define LOAD_STEP_H

#include "storm_rig.h"

/*
 * Measure the time in which the voltages compensate suddenly applied loads (load steps), by
 * simulation on a structure that equals the controller's model. The shape has settled when its
 * distance from the best shape stays below 5 % of the uncompensated displacements.
 *
 * Loads: a uniform pressure, two forces at single outputs, and the first and third vibration mode.
 * They do not excite modes whose phase advances by more than 0.6 rad in a tick. The compensating
 * voltages change by at most 30 % of half their range. Loads are left out if even the best voltages
 * leave more than a fifth of their displacements.
 *   rig     in   data that all simulations of a loop share, with the control loop (storm_use)
 *   first   in   natural frequency of the first vibration mode that the loop observes (Hz)
 *   periods out  longest time of all loads, in periods of this mode, at most 8; NAN if the voltages
 *       can compensate none of the loads
 * Returns 0, or -1 with error filled.
 */
int load_step_periods(const storm_rig *rig, double first, double *periods, char *error);

#endif
