/* SPDX-License-Identifier: BSD-2-Clause */
/* Record of the controller's results in a simulation, tick by tick. */
#ifndef HISTORY_H
#define HISTORY_H

#include "../simulate/simulation.h"

enum { HISTORY_COLUMNS = 8 };

typedef struct history {
    size_t ticks, amplifiers, room;
    double *row; /* [ticks][HISTORY_COLUMNS] time (s); shape error, vibration (deviation from the
                    static equilibrium) and error of the measured shape, relative to the norm of the
                    target; number of active limits; iterations of the optimiser; status; 1 for a
                    missed tick, else 0 */
    double *voltage; /* [ticks][amplifiers] output voltages of the amplifiers in every tick (V) */
} history;
/* Allocate memory for the ticks of a simulation. Returns whether memory sufficed. */
bool history_open(history *history, const design *design);
void history_add(history *history, const design *design, const simulate_sample *sample);
void history_close(history *history);

#endif
