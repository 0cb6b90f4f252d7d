/* SPDX-License-Identifier: BSD-2-Clause */
/* Results of `pzs shape`. */
#ifndef PRINT_SHAPE_H
#define PRINT_SHAPE_H

#include "../model/modes.h"
#include "../model/voltages.h"

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

/* Print the results of `pzs shape`: each set of voltages with its shape error. */
void print_shape(const shape_run *run);
void print_shape_json(const shape_run *run);

#endif
