/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Errors and warnings about the control loop of a scene. A loop that vibration makes unstable is
 * refused, with advice how to make it stable; a loop that is nearly unstable causes a warning.
 */
#ifndef LOOP_SAFETY_H
#define LOOP_SAFETY_H

#include "../model/analysis.h"

/*
 * Refuse a control loop that vibration makes unstable and whose tick cannot damp the vibration,
 * unless the options permit the loop. Returns 0, or -1 with error filled.
 */
int judge_loop(analysis *analysis, char *error);

/*
 * Refuse tables without a vibration model for a structure whose vibration modes are known, where
 * the scene gives no tick rate, unless the options permit such tables. Call it after judge_loop.
 * Returns 0, or -1 with error filled.
 */
int judge_rate(const analysis *analysis, char *error);

/*
 * Refuse a control loop with a vibration damper if it is unstable or does not settle after fast
 * jumps of the target. Returns 0, or -1 with error filled.
 */
int judge_storms(const analysis *analysis, char *error);

/*
 * Add a warning where voltages within their limits can reproduce only a small part of the target
 * shape. Returns 0, or -1 with error filled.
 */
int warn_of_target(analysis *analysis, char *error);

/*
 * Add a warning where the supervisor of the control loop tolerates loads that move the target nodes
 * so far, compared with the voltages, that reversed amplifiers may not be noticed.
 */
void warn_of_loads(analysis *analysis);

/*
 * Add a warning about a stable control loop in two cases: the loop would be unstable if the sensor
 * readings were one tick older than the scene file states, or the target is so large that the
 * linear vibration model may be wrong.
 */
void warn_of_loop(analysis *analysis);

/*
 * Add a warning where the static loads of a scene change the first natural frequency, but the
 * controller's tables use natural frequencies of the unloaded structure.
 */
void warn_of_prestress(analysis *analysis);

#endif
