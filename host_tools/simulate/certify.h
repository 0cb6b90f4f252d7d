/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Stability tests of a control loop with a vibration model, whose results are its certificate
 * (certificate_loop in certificate.h). The loop that `pzs tables` would write is simulated with
 * structures that differ from its model, in two ways.
 *   growth  growth per tick of small vibrations without any limits, which is the spectral radius of
 *       the loop, for static responses to voltages (gains) of 0.8, 1 and 1.33 and natural
 *       frequencies of 0.9, 1 and 1.1 times those of the model
 *   storms  30 simulations with fast random jumps of the target (storm.h): the model and four
 *       structures around it, full and quarter step limits, three sequences of targets, of which
 *       the last one misses 5 % of the ticks without informing the loop
 * Neither is enough alone: a loop whose spectral radius is below 1 may end in a limit cycle, and a
 * storm is too short to show slow growth. Before them, load steps are simulated: loads that appear
 * at once (load_step.h).
 *
 * The settings of the vibration damper are chosen from a short list. Settings pass if small
 * vibrations decay and all storms settle. They are fast if the loop compensates a load step within
 * two periods of the first mode. They are robust if they also pass with readings one tick older or
 * newer than the scene file states.
 *
 * Fast settings are tried first, those that let less sensor noise into the voltages before others.
 * The first that pass are chosen, unless later ones are robust and settle after jumps at most a
 * quarter slower. If no fast settings pass, or if the phase of the first mode advances by more than
 * 0.6 rad in a tick, all settings are tried in this way.
 */
#ifndef CERTIFY_H
#define CERTIFY_H

#include "../model/analysis.h"

/*
 * Choose the settings of the control tick that damps vibration and test the stability of the
 * control loop by simulations, if the loop needs a vibration model. Otherwise, and for a loop that
 * is tested already, do nothing. A loop that does not settle after fast jumps of the target is not
 * an error of this function.
 *   analysis  in/out  in: analysis with the tables of its controller and with computed vibration
 *             modes; out: results of the tests (analysis->certificate) and chosen settings
 * Returns 0, or -1 with error filled.
 */
int certify_loop(analysis *analysis, char *error);

/*
 * Find by bisection how far a structure may differ from the model of a loop that has passed the
 * stability tests: the largest factor of its response to voltages, and the range of the factor of
 * its natural frequencies. Also find by how many ticks sensor readings may be older or newer than
 * the scene file states.
 *   with_rates in  true: find the range of stable tick rates too, with tables made for each rate
 * Returns 0, or -1 with error filled.
 */
int certify_margins(analysis *analysis, bool with_rates, char *error);

/*
 * Describe a structure on which a control loop is unstable, or does not settle after fast jumps of
 * the target: its static response to voltages and its natural frequencies, relative to the model.
 *   text out  description
 */
void certify_failure(const certificate *certificate, char text[SCENE_ERROR]);

#endif
