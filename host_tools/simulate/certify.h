/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Stability tests of a control loop with a vibration model, by simulation on structures whose
 * static responses to voltages (gains) and natural frequencies differ from those of the model. The
 * results are the loop's certificate (certificate_loop in certificate.h).
 *
 * Tests, in this order:
 *   load steps  time in which the loop compensates suddenly applied loads (load_step.h)
 *   growth      growth per tick of small vibrations without voltage limits (spectral radius of the
 *       loop); gains of 0.8, 1 and 1.33, frequencies of 0.9, 1 and 1.1 times those of the model
 *   storms      30 simulations with fast random jumps of the target (storm.h) on the model and on
 *       four other structures; they find limit cycles, which a spectral radius below 1 does not
 *       exclude
 *
 * Properties of settings of the vibration damper:
 *   pass    small vibrations decay and all storms settle
 *   fast    the loop compensates a load step within two periods of the first mode
 *   robust  the settings also pass with readings one tick older or newer than the scene file states
 *
 * The first settings that are fast and pass are chosen, unless later ones are more robust and
 * settle at most a quarter slower. The choice is made among all settings if none are fast and pass,
 * if a period has few ticks, or if the scene file gives delay_margin.
 */
#ifndef CERTIFY_H
#define CERTIFY_H

#include "../model/analysis.h"

/*
 * Choose the settings of the vibration damper and test the stability of the control loop by
 * simulations. Nothing is done for a loop without a vibration model, or tested before. An unstable
 * loop is a result, not an error.
 *   analysis  in/out  in: analysis with the tables of its controller and with vibration modes; out:
 *       chosen settings and results of the tests (analysis->certificate)
 * Returns 0, or -1 with error filled.
 */
int certify_loop(analysis *analysis, char *error);

/*
 * Find the stability margins of a tested loop, if it is stable: by which factors the structure's
 * response to voltages and its natural frequencies may differ from the model, and by how much the
 * age of the readings may change.
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
