/* SPDX-License-Identifier: BSD-2-Clause */
/* The named outputs of a scene on standard output, as text and as JSON. */
#ifndef PRINT_OUTPUTS_H
#define PRINT_OUTPUTS_H

#include "../model/analysis.h"
#include "../text/json.h"

/* Does output k give displacements? Only these belong to every shape of `pzs shape`. */
int print_is_displacement(const analysis *analysis, int k);

/* One output: a line for a single value, else the range and a table with a row for each node or
 * electrode. */
void print_output(const analysis *analysis, int k, const double *value);

/* Table of the nodes or electrodes of output k: coordinates of the reference state, or names, and
 * the values. */
void print_output_table(const analysis *analysis, int k, const double *value);

/* Member `outputs`: a number for a single value, else an array of the numbers. only_displacements:
 * leave out the others. */
void print_outputs_json(json *json, const analysis *analysis, const double *value,
                        int only_displacements);

/*
 * Member `output_places`: for each output with several values an array of objects, theta1, theta2,
 * x, y, z and value for a node, electrode and value for an electrode, in the order of `outputs`.
 */
void print_output_places_json(json *json, const analysis *analysis, const double *value,
                              int only_displacements);

#endif
