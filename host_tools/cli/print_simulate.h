/* SPDX-License-Identifier: BSD-2-Clause */
/* Simulation of a closed loop: progress and results as text, as JSON, and tick by tick as CSV. */
#ifndef PRINT_SIMULATE_H
#define PRINT_SIMULATE_H

#include <stdio.h>
#include "../report/report_simulate.h"

/*
 * Run the simulation under all control laws, then compute the optimum of each phase.
 *   record in/out  opened record that stores every tick
 *   csv in  file for a header and one line per tick of the controller, or NULL
 * Returns 0, or -1 with error filled.
 */
int print_run(simulation *simulation, simulate_record *record, FILE *csv, char *error);

/* Print the results on standard output, after print_run. */
void print_simulation(const simulation *simulation, const simulate_record *record);
void print_simulation_json(const simulation *simulation, const simulate_record *record);

#endif
