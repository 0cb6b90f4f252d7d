/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Report pages of the results. A report is either an HTML page with SVG drawings, or its main
 * picture alone as an SVG file. The displacements can also be written as a VTK file for ParaView.
 * Each function that returns an int returns 0, or -1 when memory runs out, a solve fails or the
 * file cannot be written.
 */
#ifndef REPORT_H
#define REPORT_H

#include <stdbool.h>
#include <stdio.h>
#include "../model/modes.h"
#include "../simulate/simulate_record.h"

/*
 * One report to write: the open file, whether it is a single SVG picture instead of an HTML page,
 * and the words of the command line that asked for it.
 */
typedef struct report_job {
    FILE *file;
    bool is_svg;
    int words;
    char *const *word; /* [words] words of the command line */
} report_job;

/*
 * Write the report of `pzs solve`: the deformed shape, the outputs and maps of the displacement
 * components.
 *   u      [dof]          in  displacement vector
 *   output [output rows]  in  values of the outputs
 */
int report_solve(const report_job *job, const analysis *analysis, const double *u,
                 const double *output);

/*
 * Write the report of `pzs shape`: the reached shape, the misfit (reached minus target values) and
 * the voltages of each result, a table of their errors, and the errors of the target's modes.
 *   result [results]  in  sets of voltages
 */
int report_shape(const report_job *job, const analysis *analysis, const voltages *result,
                 int results, const modes *modes);

/* Write the report of `pzs simulate`: errors and voltages over time, and the last shape. */
int report_simulate(const report_job *job, const simulation *simulation,
                    const simulate_record *record);

/* A named displacement field u [nodes][3] of the middle surface, in Cartesian components. */
typedef struct report_field {
    const char *name;
    const double *u;
} report_field;

/* Write a VTK file for ParaView: the mesh, with each of the fields as a vector at the nodes. */
int report_vtu(FILE *file, const mesh *mesh, const report_field *field, int fields);

/*
 * Compute the Cartesian displacement of the middle surface at the nodes.
 *   u      [dof]       in   displacement vector
 *   vector [nodes][3]  out
 */
void report_displacement(const mesh *mesh, const double *u, double *vector);

#endif
