/* SPDX-License-Identifier: BSD-2-Clause */
/* Texts that describe a simulation, for HTML reports and terminal output. */
#ifndef SIMULATE_WORDS_H
#define SIMULATE_WORDS_H

#include "simulation.h"

/*
 * Size of the text that describes a phase (interval between events), with the terminating zero
 * (characters).
 */
enum { SIMULATE_PHASE_TEXT = 160 };

/*
 * Size of the texts that describe the vibration, the components or the table of phases of a
 * simulation, with the terminating zero (characters).
 */
enum { SIMULATE_TEXT = 8000 };

/*
 * Return a text that names the shape (undeformed or deformed) at which the influence matrix of the
 * simulated controller is computed.
 */
const char *simulate_words_influence(const design *design);

/*
 * Describe the events with which a phase of the simulation (interval between events) begins.
 *   text [SIMULATE_PHASE_TEXT] out  the description
 */
void simulate_words_phase(const simulation *simulation, const simulate_phase *phase,
                          char text[SIMULATE_PHASE_TEXT]);

/*
 * Write texts of several lines, indented by two spaces but for the first.
 *   simulate_words_inertia  whether the plant vibrates, with its modes and time steps, or why not
 *   simulate_words_plant    plant, sensors, amplifiers and controller
 *   simulate_words_columns  columns of the table of phases
 */
void simulate_words_inertia(const plant *plant, char text[SIMULATE_TEXT]);
void simulate_words_plant(const simulation *simulation, char text[SIMULATE_TEXT]);
void simulate_words_columns(const simulation *simulation, char text[SIMULATE_TEXT]);

#endif
