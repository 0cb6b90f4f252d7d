/* SPDX-License-Identifier: BSD-2-Clause */
/* Estimated discretisation errors on standard output, as text and as JSON. */
#ifndef PRINT_MESH_ERROR_H
#define PRINT_MESH_ERROR_H

#include "../model/mesh_error.h"
#include "../text/json.h"

/*
 * Print a table of estimated discretisation errors with one row for each result. Without an
 * estimate nothing is printed.
 */
void print_mesh_error(const mesh_error *mesh_error);

/*
 * Write the estimated discretisation errors as the JSON member `discretisation`: the meshes, and
 * for each result its value, extrapolated value, uncertainty and order (null where it was not
 * observed). Without an estimate nothing is written.
 */
void print_mesh_error_json(json *json, const mesh_error *mesh_error);

#endif
