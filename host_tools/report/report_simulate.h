/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Page of `pzs simulate`: errors, voltages and active limits over time, shapes at the end of each
 * phase.
 */
#ifndef REPORT_SIMULATE_H
#define REPORT_SIMULATE_H

#include "report.h"
#include "../simulate/simulation.h"

enum { RECORD_BINS = 800 };

/* What the page draws over time: bins of equal numbers of ticks. */
typedef struct simulate_record {
    int bins, ticks, amplifiers;
    double error[LAWS][RECORD_BINS]; /* the largest of the bin */
    double missed[RECORD_BINS]; /* the same of the controller's estimate; 0 where there is none */
    double *volt;          /* [RECORD_BINS][amplifiers] the last of the bin, under the controller */
    double *lower, *upper; /* [amplifiers] of the controller, for the bins at a limit */
} simulate_record;

int record_open(simulate_record *record, const simulation *simulation);
void record_close(simulate_record *record);
void record_tick(simulate_record *record, const simulate_sample *sample);

/* Returns 0, or -1 when memory runs out or the file cannot be written. */
int report_simulate(const report_job *job, const simulation *simulation,
                    const simulate_record *record);

#endif
