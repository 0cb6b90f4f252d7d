/* SPDX-License-Identifier: BSD-2-Clause */
/* A load path on standard output, as text and as JSON. */
#ifndef PRINT_PATH_H
#define PRINT_PATH_H

#include "../model/analysis.h"
#include "../text/json.h"

/* Print the critical points and a table with a row for each point: load factor and outputs. */
void print_load_path(const analysis *analysis, const load_path *path);

/* Print the JSON member `path`: complete, linear_solves, events and points. */
void print_load_path_json(json *json, const analysis *analysis, const load_path *path);

/* Print a JSON document that holds a path alone, which has not reached the full load. */
void print_ended_path_json(const analysis *analysis, const load_path *path);

#endif
