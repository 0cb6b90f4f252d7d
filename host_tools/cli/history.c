/* SPDX-License-Identifier: BSD-2-Clause */
/* Record of the controller's results in a simulation, tick by tick (history.h). */
#include "history.h"
#include <stdlib.h>
#include <string.h>

bool history_open(history *history, const design *design)
{
    memset(history, 0, sizeof *history);
    history->room = (size_t)design->simulate.ticks;
    history->amplifiers = (size_t)design->amplifiers;
    history->row = calloc(history->room * HISTORY_COLUMNS, sizeof *history->row);
    history->voltage = calloc(history->room * history->amplifiers, sizeof *history->voltage);
    return history->row && history->voltage;
}

void history_add(history *history, const design *design, const simulate_sample *sample)
{
    if (history->ticks == history->room)
        return;
    const double values[HISTORY_COLUMNS] = {sample->tick / design->control.rate,
                                            sample->error,
                                            sample->vibration,
                                            sample->measurement_error,
                                            sample->active,
                                            sample->iterations,
                                            sample->status,
                                            sample->is_missed};
    memcpy(history->row + history->ticks * HISTORY_COLUMNS, values, sizeof values);
    memcpy(history->voltage + history->ticks * history->amplifiers, sample->voltage,
           history->amplifiers * sizeof *history->voltage);
    history->ticks++;
}

void history_close(history *history)
{
    free(history->row);
    free(history->voltage);
}
