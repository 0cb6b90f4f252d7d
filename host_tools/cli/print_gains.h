/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Prints the modes of the control loop, each with its gain (part of the wanted change that a tick
 * makes) and its leak (part that a tick removes).
 */
#ifndef PRINT_GAINS_H
#define PRINT_GAINS_H

#include "../model/design.h"
#include "../text/json.h"

/*
 * Print the gains and leaks of the modes of a scene, how fast errors decay with them, and how much
 * noise they pass on. For modes that the scene gives as functions, also print the part of each
 * function that the actuators cannot produce. Print nothing where the scene has no gains of modes.
 */
void print_gains(const design *design);

/* Write the results of print_gains as the member "modal_gains" of a JSON object. */
void print_gains_json(json *json, const design *design);

#endif
