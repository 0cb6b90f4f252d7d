/* SPDX-License-Identifier: BSD-2-Clause */
/* Descriptions of a simulation that the HTML reports and the terminal output share. */
#ifndef SIMULATE_WORDS_H
#define SIMULATE_WORDS_H

#include "simulation.h"

/* Size of the description of a phase (characters), with the terminating zero. */
enum { SIMULATE_PHASE_TEXT = 160 };

/* Description of the shape at which the estimator gains of a simulation are computed. */
const char *simulate_words_influence(const scene *scene);

/* Describe the events that begin a phase. text out */
void simulate_words_phase(const simulation *simulation, const simulate_phase *phase,
                          char text[SIMULATE_PHASE_TEXT]);

#endif
