/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Storm: simulation of a control loop on a structure with mass that differs from its model, with
 * target jumps so fast that voltage or step limits are always active. Such jumps can drive a loop
 * that is stable without limits into a limit cycle. Times in periods of the first vibration mode:
 *   jumps  10 targets, one every 0.6 periods: the scene's target, its negative, or the shape under
 *       random voltages of up to twice the limits
 *   rest   the scene's target for 12 periods, and up to three times as long where hysteresis
 * weakens small changes of the voltages. The storm settles if the shape ends within 5 % (of the
 * target's norm) of the best shape that the limits, and hysteresis, allow; or, where few sensors
 * show only a part of the effect of hysteresis, if the shape comes to rest
 */
#ifndef STORM_H
#define STORM_H

#include "storm_rig.h"

typedef struct storm_result {
    double end;  /* largest distance of the shape from the best shape that the voltage limits allow,
                    during about the last period of the first vibration mode in a storm (simulation
                    with fast target jumps), divided by the norm of the target */
    double peak; /* largest distance of the shape from the best shape that the voltage limits allow,
                    at any time of a storm (simulation with fast target jumps); relative to the norm
                    of the target */
    double growth; /* growth factor per tick of the amplitude of small vibrations of the structure,
                      mean over the second half of the simulation; only for simulations without
                      voltage limits */
    double unseen; /* in a loop with few sensors that does not compensate hysteresis, and whose
                      shape has not come near the best one: distance of the shape from the best one
                      in the last quarter of the time without jumps, divided by the norm of the
                      target. `end` is then measured from the shape at that time. Otherwise 0 */
    int ticks;
    int gated; /* number of ticks in which the sensor gate of the loop has taken readings away */
    bool passed;
    bool is_stopped; /* true: the supervisor has taken control away from the loop, which ends the
                        simulation */
} storm_result;

/* Run one storm, a simulation with fast target jumps. Returns 0, or -1 with error filled. */
int storm_run(const storm_rig *rig, const storm_plant *plant, storm_result *result, char *error);

/*
 * Measure the growth factor per tick of a small vibration without any limits (spectral radius of
 * the loop). All modes start at random positions and velocities; the simulation ends after growth
 * or decay by 1e6, or after `ticks`. Returns 0, or -1 with error filled.
 */
int storm_growth(const storm_rig *rig, const storm_plant *plant, int ticks, storm_result *result,
                 char *error);

#endif
