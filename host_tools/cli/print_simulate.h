/* SPDX-License-Identifier: BSD-2-Clause */
/* A simulation while it runs, as text for people, as JSON, and tick by tick as CSV. */
#ifndef PRINT_SIMULATE_H
#define PRINT_SIMULATE_H

#include <stdio.h>
#include "../report/report_simulate.h"

/*
 * Run both laws, then find the optima.
 *   record  in/out  opened: takes every tick
 *   csv     in      takes the names, then a line for each tick of the controller's law; or NULL
 * Returns 0, or -1 with error filled.
 */
int print_run(simulation *simulation, simulate_record *record, FILE *csv, char *error);

/* Both on standard output, after that. */
void print_simulation(const simulation *simulation);
void print_simulation_json(const simulation *simulation);

#endif
