/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Report page of `pzs simulate`: shape errors, voltages and active limits over time, and the shape
 * at the end of each phase.
 */
#ifndef REPORT_SIMULATE_H
#define REPORT_SIMULATE_H

#include "report.h"
#include "../simulate/simulation.h"

enum { RECORD_BINS = 800 };

/*
 * Data that the page draws over time. The ticks are divided into bins of equal length, because a
 * page cannot show every tick of a long simulation.
 */
typedef struct simulate_record {
    int bins, ticks, amplifiers;
    double error[LAWS][RECORD_BINS]; /* largest shape error within the bin, for each control law */
    double missed[RECORD_BINS]; /* largest error of the controller's shape estimate within the bin;
                                   0 without an estimator */
    double vibration[RECORD_BINS]; /* largest distance of the controller's shape from the static
                                      equilibrium within the bin; 0 for a quasi-static plant */
    double *volt; /* [RECORD_BINS][amplifiers] the controller's voltages at the last tick of each
                     bin */
    double *lower, *upper; /* [amplifiers] the controller's voltage limits, to mark the bins in
                              which a limit is active */
} simulate_record;

int record_open(simulate_record *record, const simulation *simulation);
void record_close(simulate_record *record);
void record_tick(simulate_record *record, const simulate_sample *sample);

/* Write the report page. Returns 0, or -1 when memory runs out or the file cannot be written. */
int report_simulate(const report_job *job, const simulation *simulation,
                    const simulate_record *record);

#endif
