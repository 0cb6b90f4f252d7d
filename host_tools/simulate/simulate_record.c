/* SPDX-License-Identifier: BSD-2-Clause */
/* Record of a simulation over time, in bins of equal length (simulate_record.h). */
#include "simulate_record.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

int record_open(simulate_record *record, const simulation *simulation)
{
    const design *design = &simulation->nominal->design;
    memset(record, 0, sizeof *record);
    record->ticks = design->simulate.ticks;
    record->bins = record->ticks < RECORD_BINS ? record->ticks : RECORD_BINS;
    record->amplifiers = design->amplifiers;
    record->lower = design->lower;
    record->upper = design->upper;
    record->voltage = calloc((size_t)(RECORD_BINS * design->amplifiers), sizeof *record->voltage);
    return record->voltage ? 0 : -1;
}

void record_close(simulate_record *record)
{
    free(record->voltage);
    memset(record, 0, sizeof *record);
}

void record_tick(simulate_record *record, const simulate_sample *sample)
{
    const int bin = (int)((double)sample->tick * record->bins / record->ticks);
    record->error[sample->law][bin] = fmax(record->error[sample->law][bin], sample->error);
    if (sample->law != LAW_CONTROLLER)
        return;
    record->measurement_error[bin] =
        fmax(record->measurement_error[bin], sample->measurement_error);
    record->vibration[bin] = fmax(record->vibration[bin], sample->vibration);
    memcpy(record->voltage + (size_t)(bin * record->amplifiers), sample->voltage,
           (size_t)record->amplifiers * sizeof *record->voltage);
}
