/* SPDX-License-Identifier: BSD-2-Clause */
/* Results on standard output, as text and as JSON. */
#ifndef PRINT_H
#define PRINT_H

#include "../model/estimator.h"
#include "../text/json.h"
#include "../model/modes.h"

/* Results of `pzs shape`. */
typedef struct shape_run {
    analysis *analysis;
    voltages *results;   /* [count] sets of voltages: the optimum without limits; for each pair of
                            limits the optimum, on a nonlinear structure also that of the linear
                            model, clipped least squares, clipped least squares with regularisation;
                            then the sets of the scene */
    voltages before;     /* result with all voltages zero */
    int count, compared; /* number of results; index of the first result with voltages given in the
                            scene */
    modes modes;         /* modes of the target, empty where the scene lists none */
} shape_run;

/*
 * Print name, mesh and condition number of the scene, and what the sensors of its `estimate`
 * section observe.
 *   influence in  description of the shape at which the influence is computed
 */
void print_head(const analysis *analysis, const char *influence);

/* Print the observability by the sensors as the JSON member `estimate`. */
void print_estimate_json(json *json, const estimator *estimator);

/* Print the size of the scene and the memory that its tables require on a device. */
void print_check(const analysis *analysis);
void print_check_json(const analysis *analysis);

/*
 * Print the outputs of a displacement, then springs and electrodes.
 *   displacement [free_dof]    in
 *   value        [output rows] in
 */
void print_solve(analysis *analysis, const double *displacement, const double *value);
void print_solve_json(analysis *analysis, const double *displacement, const double *value);

/*
 * Print voltage, charge and capacitance of each electrode, and how much open-circuit electrodes
 * stiffen the shell. Without sensor electrodes nothing is printed.
 */
void print_electrodes(analysis *analysis);
void print_electrodes_json(json *json, analysis *analysis);

/* Print all sets of voltages with their errors. */
void print_shape(const shape_run *run);
void print_shape_json(const shape_run *run);

/* Print the residual of each mode of the target; without modes nothing is printed. */
void print_modes(const scene *scene, const modes *modes);
void print_modes_json(json *json, const scene *scene, const modes *modes);

#endif
