/*
 * Pictures of a result: an HTML page with SVG drawings, and a VTK file for ParaView.
 * Each function returns 0, or -1 when memory runs out, a solve fails or the file cannot be written.
 */
#ifndef REPORT_H
#define REPORT_H

#include <stdio.h>
#include "../model/modes.h"

/*
 * Displacement field of a result on the mesh.
 *   u      [nodes][3]  Cartesian displacement of the middle surface
 */
typedef struct report_field {
    const char *name;
    const double *u;
} report_field;

/*
 * HTML page of `pzs solve`: undeformed and deformed shape, outputs with their references, mesh and
 * numerics. u       [dof]            displacement output  [output rows]    values of the
 * structure's output rows
 */
int report_solve(FILE *file, const analysis *analysis, const double *u, const double *output);

/*
 * HTML page of `pzs shape`: target and reached shape, misfit maps, voltages on their patches, error
 * table, and what is left of each of the target's modes. volts [count] results, each drawn; one
 * solve each
 */
int report_shape(FILE *file, analysis *analysis, const voltages *voltages, int count,
                 const modes *modes);

/* Legacy VTK file: quadrilaterals with one displacement vector field per entry. */
int report_vtu(FILE *file, const mesh *mesh, const report_field *field, int fields);

/* Cartesian displacement of the middle surface at the nodes. u [dof] in, vector [nodes][3] out. */
void report_displacement(const mesh *mesh, const double *u, double *vector);

#endif
