/* SPDX-License-Identifier: BSD-2-Clause */
/* Estimated discretisation errors on standard output, as text and as JSON. */
#ifndef PRINT_MESH_ERROR_H
#define PRINT_MESH_ERROR_H

#include "../model/mesh_error.h"
#include "../text/json.h"

/* Print a table with a row for each result. Without an estimate nothing is printed. */
void print_mesh_error(const mesh_error *mesh_error);

/*
 * Print the JSON member `discretisation`: meshes, and for each result value, extrapolated,
 * uncertainty and order (null where it was not observed). Without an estimate nothing is printed.
 */
void print_mesh_error_json(json *json, const mesh_error *mesh_error);

#endif
