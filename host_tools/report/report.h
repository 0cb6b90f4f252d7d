/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Report pages of the results. A report is either an HTML page with SVG drawings, or its main
 * picture alone as an SVG file. Each function that returns an int returns 0, or -1 when memory runs
 * out, a solve fails or the file cannot be written.
 */
#ifndef REPORT_H
#define REPORT_H

#include <stdbool.h>
#include <stdio.h>
#include "../model/loaded.h"
#include "../model/modes.h"
#include "../model/stress_field.h"
#include "../simulate/simulate_record.h"

/* One report: the open file, its format, and the command line, which the report shows. */
typedef struct report_job {
    FILE *file;
    bool is_svg; /* an SVG picture in place of an HTML page */
    int words;
    char *const *word; /* [words] words of the command line */
} report_job;

/*
 * Write the report of `pzs solve`: the deformed shape, the outputs and maps of the displacement
 * components.
 *   u      [dof]          in  displacement vector
 *   output in values of all outputs of the scene, output after output
 *   stress                in  recovered stresses, of which the page shows maps; NULL: without
 */
int report_solve(const report_job *job, const analysis *analysis, const double *u,
                 const double *output, const stress_field *stress);

/*
 * Write the report of `pzs modes`: frequencies, damping and participating masses, and pictures of
 * the mode shapes, of measured modes maps of the outputs.
 */
int report_modes(const report_job *job, const loaded_modes *modes);

/*
 * Write the report of `pzs shape`: for each result the reached shape, the misfit (reached minus
 * target values), the voltages and the shape error; of a target that is a list of modes also
 * theirs. result [results] in  voltages of all amplifiers: the optimum without limits, the optimum
 * within the first pair of limits, which the summary and the picture show, and others
 */
int report_shape(const report_job *job, const analysis *analysis, const voltages *result,
                 int results, const modes *modes);

/* Write the report of `pzs simulate`: errors and voltages over time, and the shape at the end. */
int report_simulate(const report_job *job, const simulation *simulation,
                    const simulate_record *record);

#endif
