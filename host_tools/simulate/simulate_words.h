/* SPDX-License-Identifier: BSD-2-Clause */
/* Texts on a simulation that the report pages and the terminal share. */
#ifndef SIMULATE_WORDS_H
#define SIMULATE_WORDS_H

#include "simulation.h"

/* Characters of a phase's text, the terminating zero included. */
enum { SIMULATE_PHASE_TEXT = 160 };

/* Shape at which the estimator's gains of a simulation are made. */
const char *simulate_words_influence(const scene *scene);

/* Write the events that begin a phase. text out */
void simulate_words_phase(const simulation *simulation, const simulate_phase *phase,
                          char text[SIMULATE_PHASE_TEXT]);

#endif
