/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Record of a simulation over time, for reports and JSON. The ticks are divided into bins of equal
 * length, because a page cannot show every tick of a long simulation.
 */
#ifndef SIMULATE_RECORD_H
#define SIMULATE_RECORD_H

#include "simulation.h"

/* Largest number of bins; shorter simulations have a bin for each tick. */
enum { RECORD_BINS = 800 };

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

/* Prepare an empty record. Returns 0, or -1: out of memory. */
int record_open(simulate_record *record, const simulation *simulation);
void record_close(simulate_record *record);

/* Add the results of one tick. */
void record_tick(simulate_record *record, const simulate_sample *sample);

#endif
