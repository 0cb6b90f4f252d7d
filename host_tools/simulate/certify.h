/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Certificate of a control loop with a vibration model (certificate_loop in certificate.h). The
 * loop that `pzs tables` would write runs around structures that differ from its model:
 *
 *   growth  small vibrations without limits, for gains 0.8, 1 and 1.33 and frequencies 0.9, 1 and
 *           1.1 relative to the model: the spectral radius
 *   storms  30 of them (storm.h): the model and the four corners, whole and quarter step limits,
 *           three sequences of targets
 *
 * Neither is enough alone: a loop whose radius is below 1 may end in a limit cycle, and a storm is
 * too short to show slow growth. The settings of the damped tick are the fastest of a few that pass
 * both, or settings that are at most a quarter slower and also pass with readings one tick older or
 * newer than the scene says.
 */
#ifndef CERTIFY_H
#define CERTIFY_H

#include "../model/analysis.h"

/*
 * Choose the settings of the damped tick and certify the loop, where the scene's loop needs a
 * vibration model; otherwise do nothing, as for a loop that is certified already.
 *   analysis in/out  after certificate_make and simulate_tables; `certificate.loop` and the
 * settings are filled Returns 0, or -1 with error filled. Storms that fail are not an error here.
 */
int certify_loop(analysis *analysis, char *error);

/*
 * Find the margins of a certified loop: gain and frequencies by bisection, and the number of ticks
 * by which readings may be older or newer than the scene says.
 *   with_rates in  also the range of stable tick rates, with tables made for each rate
 */
int certify_margins(analysis *analysis, bool with_rates, char *error);

/* Name the structure at which a certified loop is unstable or a storm does not settle. */
void certify_failure(const certificate *certificate, char text[SCENE_ERROR]);

#endif
