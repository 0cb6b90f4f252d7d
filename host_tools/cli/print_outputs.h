/* SPDX-License-Identifier: BSD-2-Clause */
/* Named outputs of a scene on standard output, as text and as JSON. */
#ifndef PRINT_OUTPUTS_H
#define PRINT_OUTPUTS_H

#include "../model/analysis.h"
#include "../text/json.h"

/*
 * Print one output of the scene: a single value on one line; several values as their range and a
 * table with one row for each node or electrode.
 */
void print_output(const analysis *analysis, int k, const double *value);

/*
 * Print a table of the output with index k, with one row for each node or electrode: coordinates in
 * the reference state or the name of the electrode, and the value.
 */
void print_output_table(const analysis *analysis, int k, const double *value);

/*
 * Write the outputs as the JSON member `outputs`: a number for each output with a single value,
 * otherwise an array of numbers.
 *   only_rows in  1: omit all outputs that are not linear in the displacement
 */
void print_outputs_json(json *json, const analysis *analysis, const double *value, int only_rows);

/*
 * Write the JSON member `output_places`: for each output with several values an array of objects in
 * the order of the values. An object has the members theta1, theta2 (surface coordinates), x, y, z
 * and value for a node, and the members electrode (name) and value for an electrode.
 */
void print_output_places_json(json *json, const analysis *analysis, const double *value,
                              int only_rows);

#endif
