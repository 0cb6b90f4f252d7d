/* SPDX-License-Identifier: BSD-2-Clause */
/* Named outputs of a scene on standard output, as text and as JSON. */
#ifndef PRINT_OUTPUTS_H
#define PRINT_OUTPUTS_H

#include "../model/analysis.h"
#include "../text/json.h"

/*
 * Whether output k consists of displacements. `pzs shape` prints only these outputs for every set
 * of voltages.
 */
int print_is_displacement(const analysis *analysis, int k);

/*
 * Print one output: a single value on one line; several values as their range and a table with a
 * row for each node or electrode.
 */
void print_output(const analysis *analysis, int k, const double *value);

/*
 * Print a table with a row for each node or electrode of output k: coordinates in the reference
 * state or the electrode name, and the values.
 */
void print_output_table(const analysis *analysis, int k, const double *value);

/*
 * Print the JSON member `outputs`: a number for each output with a single value, else an array of
 * numbers. only_displacements: omit all outputs that are not displacements.
 */
void print_outputs_json(json *json, const analysis *analysis, const double *value,
                        int only_displacements);

/*
 * Print the JSON member `output_places`: for each output with several values an array of objects in
 * the order of `outputs`. The members are theta1, theta2, x, y, z and value for a node, electrode
 * and value for an electrode.
 */
void print_output_places_json(json *json, const analysis *analysis, const double *value,
                              int only_displacements);

#endif
