/* SPDX-License-Identifier: BSD-2-Clause */
/* Functions that compute the results whose discretisation error can be estimated (mesh_error.h). */
#ifndef MESH_MEASURE_H
#define MESH_MEASURE_H

#include "analysis.h"

/*
 * Append those outputs of the scene that have a single value to the results whose discretisation
 * error is estimated.
 *   value in values of all outputs of the structure, output after output
 */
void mesh_values_add_outputs(mesh_values *values, const analysis *analysis, const double *value);

/*
 * Compute the outputs of the scene under its loads and applied voltages on one mesh. The argument
 * `context` is not used.
 */
mesh_measure mesh_measure_solve;
/*
 * Compute the outputs of the scene at the end of its load path on one mesh. The argument `context`
 * points to the number of the bifurcation at which to leave the path, an int; 0: none.
 */
mesh_measure mesh_measure_path;
/*
 * Append the influence matrix (displacement per volt) to the results whose discretisation error is
 * estimated, as root mean squares over the area of the target nodes: one of the whole matrix and,
 * if there are at most MESH_COLUMNS amplifiers, one of the column of each amplifier. Returns 0, or
 * -1 with error filled.
 */
enum { MESH_COLUMNS = MESH_VALUES - 2 };
int mesh_values_add_influence(mesh_values *values, const analysis *analysis, char *error);

/*
 * Compute, on one mesh, the relative shape error of the optimal voltages within limits, and the
 * influence matrix. The argument `context` points to the voltage limits, which are the same on all
 * meshes.
 */
mesh_measure mesh_measure_shape;
/*
 * Compute the natural frequencies of the structure on one mesh. The argument `context` points to
 * the modes that are asked for, a modes_request.
 */
mesh_measure mesh_measure_modes;

/* Write the name of the natural frequency with index `mode`, counted from 0. */
void mesh_mode_name(int mode, char name[SCENE_LABEL]);

/* Name of the shape error in the list of results whose discretisation error is estimated. */
extern const char *const mesh_shape_name;

#endif
