/* SPDX-License-Identifier: BSD-2-Clause */
/* Results as named arrays in files: the options --npz and --csv-dir. */
#ifndef EXPORT_H
#define EXPORT_H

#include "../data/named_array.h"
#include "../model/stress.h"
#include "../model/loaded.h"
#include "options.h"
#include "history.h"
#include "print_shape.h"

/* Whether the options of the command line ask for files with arrays of numbers. */
bool export_is_wanted(const options *options);

/*
 * Write the arrays of a result to the files that the options name. Each function returns 0, or an
 * exit code after printing an error message.
 *   export_solve       displacement [free_dof], values of all outputs, and stresses (NULL: without)
 *   export_shape       voltages and shape of every result of `pzs shape`
 *   export_modes       natural frequencies, mode shapes and coupling factors of vibration
 *   export_simulation  values of every tick of a simulation
 */
int export_solve(const options *options, const analysis *analysis, const double *displacement,
                 const double *value, const stress_field *stress);
int export_shape(const options *options, const shape_run *run);
int export_modes(const options *options, const loaded_modes *modes);

int export_simulation(const options *options, const simulation *simulation, const history *history);

#endif
