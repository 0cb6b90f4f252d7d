/* SPDX-License-Identifier: BSD-2-Clause */
/* Results as text for people and as JSON for machines, on standard output. */
#ifndef PRINT_H
#define PRINT_H

#include "../model/estimator.h"
#include "../text/json.h"
#include "../model/modes.h"

/* What `pzs shape` found. */
typedef struct shape_run {
    analysis *analysis;
    voltages *results; /* [count] optimum without limits; then per limit the optimum, on a nonlinear
                        structure that of the linear model, clipped least squares, and those
                        regularised before; then those of the scene */
    voltages before;   /* the scene without any voltages */
    int count, compared; /* compared: the first of the scene's own */
    modes modes;         /* of the target, where it lists some */
} shape_run;

/* Name, mesh, condition, and what the sensors of an estimate see; influence: at what shape, in
 * words. */
void print_head(const analysis *analysis, const char *influence);

/* What the sensors of an estimate see, under `estimate`. */
void print_estimate_json(json *json, const estimator *estimator);

/* Size of the scene and what its images need of a device. */
void print_check(const analysis *analysis);
void print_check_json(const analysis *analysis);

/* A displacement's outputs, then the electrodes. value [output rows] in */
void print_solve(analysis *analysis, const double *value);
void print_solve_json(analysis *analysis, const double *value);

/* Voltages, charge and capacitance of each electrode; how much stiffer open ones make the shell.
 * Nothing without sensors. */
void print_electrodes(analysis *analysis);
void print_electrodes_json(json *json, analysis *analysis);

/* Sets of voltages and their errors. */
void print_shape(const shape_run *run);
void print_shape_json(const shape_run *run);

/* What is left of each mode, nothing where there is none. */
void print_modes(const scene *scene, const modes *modes);
void print_modes_json(json *json, const scene *scene, const modes *modes);

#endif
