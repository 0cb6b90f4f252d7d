/* SPDX-License-Identifier: BSD-2-Clause */
/* The controller's course in a simulation, tick by tick. */
#ifndef HISTORY_H
#define HISTORY_H

#include "../simulate/simulation.h"

enum { HISTORY_COLUMNS = 8 };

typedef struct history {
    size_t ticks, amplifiers, room;
    double *row;     /* [ticks][HISTORY_COLUMNS] time, error, vibration, missed, active, iterations,
                        status, lost */
    double *voltage; /* [ticks][amplifiers] */
} history;
/* Make room for the ticks of a simulation. Returns whether memory sufficed. */
bool history_open(history *history, const scene *scene);
void history_add(history *history, const scene *scene, const simulate_sample *sample);
void history_close(history *history);

#endif
