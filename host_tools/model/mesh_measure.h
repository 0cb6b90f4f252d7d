/* SPDX-License-Identifier: BSD-2-Clause */
/* Results whose discretisation error can be estimated (mesh_error.h). */
#ifndef MESH_MEASURE_H
#define MESH_MEASURE_H

#include "analysis.h"

/*
 * Append the outputs of the scene that have a single value.
 *   value [output rows] in  rows of the structure
 */
void mesh_values_add_outputs(mesh_values *values, const analysis *analysis, const double *value);

/* Outputs of the scene under its loads and applied voltages. context: unused. */
mesh_measure mesh_measure_solve;
/* Shape error of the optimum within the first limits. context: its common_limits. */
mesh_measure mesh_measure_shape;
/* Natural frequencies. context: their number, an int. */
mesh_measure mesh_measure_modes;

/* Name of natural frequency `mode`, counted from 0. */
void mesh_mode_name(int mode, char name[SCENE_LABEL]);

/* Name of the shape error in the results of mesh_measure_shape. */
extern const char *const mesh_shape_name;

#endif
