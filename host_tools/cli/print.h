/* SPDX-License-Identifier: BSD-2-Clause */
/* Results of analyses and optima on standard output, as text and as JSON. */
#ifndef PRINT_H
#define PRINT_H

#include "print_work.h"
#include "../model/estimator.h"
#include "../text/json.h"
#include "../model/modes.h"
#include "../model/stress.h"

/* Results of the command `pzs shape`. */
typedef struct shape_run {
    analysis *analysis;
    /*
     * [count] results, each with voltages and the shape that they reach, in this order:
     *   1. the optimum without voltage limits;
     *   2. for each pair of voltage limits: the optimum; on a nonlinear structure also that of the
     *       linear model; clipped least squares; clipped regularised least squares;
     *   3. the sets of voltages that the scene file gives for comparison.
     */
    voltages *results;
    voltages before;     /* displacements and shape error with all voltages zero */
    int count, compared; /* count: number of results in `results`; compared: index of the first
                            result for voltages that the scene file gives for comparison */
    modes modes; /* shape errors for each single shape, if the target is a list of shapes for which
                    the voltages are optimised one by one; otherwise empty */
} shape_run;

/*
 * Print name, mesh and condition number of the scene, and what the sensors of its `estimate`
 * section observe.
 *   influence in  text that names the shape at which the influence matrix is computed
 */
void print_head(const analysis *analysis, const char *influence);

/* Write how well the sensors determine the shape as the JSON member `estimate`. */
void print_estimate_json(json *json, const estimator *estimator);

/*
 * Print heights and duration of the test pulses of the self-test, which runs before the control
 * loop starts; then on how many electrodes the fault detector can find faults, with a warning that
 * names the others. Print nothing where the scene has neither self-test nor fault detector.
 */
void print_test_plans(const analysis *analysis);

/*
 * Print the size of the scene and the device memory that the constants of its firmware (`pzs
 * tables`) need.
 */
void print_check(const analysis *analysis, const work_report *work);
void print_check_json(const analysis *analysis, const work_report *work);

/*
 * Print the outputs of the scene under a displacement, then the forces of springs and the voltages
 * and charges of electrodes.
 *   displacement [free_dof]     in  displacement vector of the structure
 *   value in values of all outputs of the scene, output after output
 */
void print_solve(analysis *analysis, const double *displacement, const double *value,
                 const stress_field *stress);
void print_solve_json(analysis *analysis, const double *displacement, const double *value,
                      const stress_field *stress);

/*
 * Print voltage, charge and capacitance of each electrode, and how much electrodes in open circuit
 * stiffen the shell. Without sensor electrodes nothing is printed.
 */
void print_electrodes(analysis *analysis);
void print_electrodes_json(json *json, analysis *analysis);

/*
 * Print the range of the potential of each bare face (face of a layer without electrode). Without
 * bare faces nothing is printed.
 */
void print_bare_faces(const analysis *analysis);
void print_bare_faces_json(json *json, const analysis *analysis);

/* Print the results of `pzs shape`: each set of voltages with its shape error. */
void print_shape(const shape_run *run);
void print_shape_json(const shape_run *run);

/*
 * Print the shape error of each shape of the target, where the scene file lists several shapes for
 * which the voltages are optimised one by one; otherwise print nothing.
 */
void print_modes(const design *design, const modes *modes);
void print_modes_json(json *json, const design *design, const modes *modes);

#endif
