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
#include "../model/stress_points.h"
#include "../simulate/simulate_record.h"

/* One report of results to write. */
typedef struct report_job {
    FILE *file;
    bool is_svg;
    int words;
    char *const *word; /* [words] words of the command line, which the report shows */
} report_job;

/*
 * Write the report of `pzs solve`: the deformed shape, the outputs and maps of the displacement
 * components.
 *   u      [dof]          in  displacement vector
 *   output [output rows]  in  values of the outputs
 *   stress                in  recovered stresses, of which the page shows maps; NULL: without
 */
int report_solve(const report_job *job, const analysis *analysis, const double *u,
                 const double *output, const stress_field *stress);

/*
 * Write the report of `pzs shape`: the reached shape, the misfit (reached minus target values) and
 * the voltages of each result, a table of their shape errors, and the shape errors of the
 * alternative target shapes.
 *   result [results] in  optimal voltages of all amplifiers, for each pair of voltage limits
 */
int report_shape(const report_job *job, const analysis *analysis, const voltages *result,
                 int results, const modes *modes);

/*
 * Write the report of `pzs simulate`: shape errors and voltages over time, and the last shape that
 * the controller has reached.
 */
int report_simulate(const report_job *job, const simulation *simulation,
                    const simulate_record *record);

/* An array of values at the points or in the cells of a VTK file for ParaView. */
typedef struct report_array {
    char name[256];
    int components; /* number of values that the array of a VTK file has at each point or in each
                       cell */
    bool of_cells;  /* true: the array of the VTK file has values for the cells; false: for the
                       points */
    double *value;  /* [points or cells][components] values of the array of a VTK file */
} report_array;

/*
 * Write a VTK file for ParaView, with arrays of values at its points and in its cells.
 *   points  in  points of the file and the corners of its cells; NULL: the nodes of the mesh
 */
int report_vtu(FILE *file, const mesh *mesh, const stress_points *points, const report_array *array,
               int arrays);

/*
 * List the potentials of the bare faces (without electrodes) of a design as arrays with values at
 * the nodes; a face of a layer is one array.
 *   value [inputs]   in   input values, with the computed potentials
 *   array [2 layers] out  arrays, whose values the caller must free
 * Returns the number of arrays, or -1 where memory runs out.
 */
int report_potentials(const design *design, const double *value, report_array *array);

/*
 * Write a VTK file with the displacement and the recovered stresses: for each layer and height
 * stress and strain in material axes, at the element centres and averaged at the nodes; reserve
 * factors, resultants, electric fields, potentials of bare faces (without electrodes). A node on
 * the border of a patch has two points in the file, one for each side of the border.
 *   vector [nodes][3] in  displacement of the middle surface, in Cartesian components
 */
int report_stress_vtu(FILE *file, const stress_field *field, const double *vector);

/*
 * Compute the Cartesian displacement of the middle surface at the nodes.
 *   u      [dof]       in   displacement vector
 *   vector [nodes][3]  out  displacement of each node along x, y and z
 */
void report_displacement(const mesh *mesh, const double *u, double *vector);

#endif
