/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Pictures of a result: an HTML page with SVG drawings, its main picture as an SVG file, and a VTK
 * file for ParaView. Each function returns 0, or -1 when memory runs out, a solve fails or the file
 * cannot be written.
 */
#ifndef REPORT_H
#define REPORT_H

#include <stdbool.h>
#include <stdio.h>
#include "../model/modes.h"

/* Where a report goes, as which of the two, and the command line that asked for it. */
typedef struct report_job {
    FILE *file;
    bool is_svg;
    int words;
    char *const *word; /* [words] */
} report_job;

/*
 * `pzs solve`: deformed shape, outputs, components. u [dof] displacement, output [output rows]
 * values
 */
int report_solve(const report_job *job, const analysis *analysis, const double *u,
                 const double *output);

/*
 * `pzs shape`: reached shapes, misfits and voltages of each result, error table, modes of the
 * target; one solve each. voltages [count]
 */
int report_shape(const report_job *job, analysis *analysis, const voltages *voltages, int count,
                 const modes *modes);

/* Displacement field of a result: u [nodes][3], Cartesian, of the middle surface. */
typedef struct report_field {
    const char *name;
    const double *u;
} report_field;

/* VTK file: quadrilaterals with one displacement vector field per entry. */
int report_vtu(FILE *file, const mesh *mesh, const report_field *field, int fields);

/* Cartesian displacement of the middle surface at the nodes. u [dof] in, vector [nodes][3] out. */
void report_displacement(const mesh *mesh, const double *u, double *vector);

#endif
