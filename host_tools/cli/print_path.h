/* SPDX-License-Identifier: BSD-2-Clause */
/* A load path (equilibria from zero to full load) on standard output, as text and as JSON. */
#ifndef PRINT_PATH_H
#define PRINT_PATH_H

#include "../model/analysis.h"
#include "../text/json.h"

/*
 * Print the critical points of a load path, and a table with one row for each point: load factor
 * and outputs.
 */
void print_load_path(const analysis *analysis, const load_path *path);

/*
 * Write a load path as the JSON member `path` with the members complete, linear_solves, events and
 * points.
 */
void print_load_path_json(json *json, const analysis *analysis, const load_path *path);

/* Write a JSON document that contains only a load path, which has not reached the full load. */
void print_ended_path_json(const analysis *analysis, const load_path *path);

#endif
