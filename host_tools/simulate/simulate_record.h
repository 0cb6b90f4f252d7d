/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Results of a simulation over time, for reports and JSON. The ticks are divided into time bins of
 * equal length, because a page cannot show every tick of a long simulation.
 */
#ifndef SIMULATE_RECORD_H
#define SIMULATE_RECORD_H

#include "simulation.h"

/*
 * Largest number of points in the diagrams of a simulation over time. A longer simulation is
 * divided into this many intervals of time (bins), each with one recorded value; a shorter one has
 * a bin for each tick.
 */
enum { RECORD_BINS = 800 };

typedef struct simulate_record {
    int bins, ticks, amplifiers;
    double error[LAWS][RECORD_BINS]; /* largest shape error, relative to the norm of the scene's
                                        target, within each bin of time, for each control law */
    double measurement_error[RECORD_BINS]; /* largest error of the shape that the controller
                                              measures or estimates, relative to the norm of the
                                              scene's target, within each bin of time; 0 without an
                                              estimator */
    double vibration[RECORD_BINS]; /* largest deviation of the shape from the static equilibrium
                                      under the library's controller within each bin of time,
                                      relative to the norm of the scene's target; 0 for a
                                      quasi-static plant */
    double *voltage; /* [RECORD_BINS][amplifiers] voltages that the library's controller gives at
                        the last tick of each bin of time (V) */
    double *lower, *upper; /* [amplifiers] voltage limits of the controller, to mark the bins of
                              time in which a limit is active (V) */
} simulate_record;

/*
 * Prepare an empty record of the results of a simulation over time. Returns 0, or -1 where memory
 * runs out.
 */
int record_open(simulate_record *record, const simulation *simulation);
void record_close(simulate_record *record);

/* Add the results of one tick of a simulation to the record of its results over time. */
void record_tick(simulate_record *record, const simulate_sample *sample);

#endif
