/* SPDX-License-Identifier: BSD-2-Clause */
/* Simulation of a closed loop: progress and results as text, as JSON, and tick by tick as CSV. */
#ifndef PRINT_SIMULATE_H
#define PRINT_SIMULATE_H

#include <stdio.h>
#include "../simulate/simulate_record.h"
#include "history.h"

/* Records and files that receive the results of every tick of a simulation. */
typedef struct simulate_sinks {
    simulate_record *record; /* shape errors of all control laws in every tick, in a record that the
                                caller has prepared with record_open */
    FILE *csv; /* CSV file that receives a header and one line for each tick of the controller, or
                  NULL */
    history *history; /* record of every tick of the controller, opened by the caller, or NULL */
} simulate_sinks;

/*
 * Run the simulation under all control laws, then compute the optimal voltages of each phase
 * (interval between events of the scene). Returns 0, or -1 with error filled.
 */
int print_run(simulation *simulation, const simulate_sinks *sinks, char *error);

/* Print the results of a simulation on standard output, after print_run. */
void print_simulation(const simulation *simulation, const simulate_record *record);
void print_simulation_json(const simulation *simulation, const simulate_record *record);

/*
 * Print, on standard output as JSON, the faults of amplifiers, cables and sensors that a self-test
 * has found and that have stopped the simulation; nothing where no self-test has stopped it.
 */
void print_refusal_json(const simulation *simulation);

#endif
