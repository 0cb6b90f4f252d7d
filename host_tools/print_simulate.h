/* A simulation as text for people, as JSON, and tick by tick as CSV. */
#ifndef PRINT_SIMULATE_H
#define PRINT_SIMULATE_H

#include <stdio.h>
#include "simulate.h"

/* Both on standard output, after simulate_run of both laws and simulate_optima. */
void print_simulation(const simulation *s);
void print_simulation_json(const simulation *s);

/* Lines of a CSV file: names, then each tick of the controller's law. */
void print_csv_head(FILE *file, const scene *s);
void print_csv_tick(FILE *file, const scene *s, const simulate_sample *sample);

#endif
