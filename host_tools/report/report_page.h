/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Parts that several report pages share: the frame of a page, tables of the structure, and the
 * misfit of a shape with its picture.
 */
#ifndef REPORT_PAGE_H
#define REPORT_PAGE_H

#include "report.h"
#include "report_shell.h"

/*
 * Begin and end a page. The beginning contains the name and the purpose of the scene, mesh size,
 * numerical checks and warnings.
 *   residual  in  largest relative residual of the solves shown on this page
 */
void page_begin(const report_job *job, const analysis *analysis, const char *kind, double residual);
void page_end(const report_job *job);

/*
 * Begin and end the main picture in a file of its own, with its title and the notes below it.
 * `width` and `height` are those of the drawing, in pixels.
 */
void picture_begin(const report_job *job, const scene *scene, const char *title, double width,
                   double height);
void picture_end(const report_job *job, double width, double height);

/* Write the tables of the supports, loads and actuators, and those of the layers and materials. */
void page_conditions(FILE *file, const design *design);
void page_layers(FILE *file, const scene *scene);

/* Write a section with the tables of the structure, or with that of a measured matrix. */
void page_source(FILE *file, const analysis *analysis, const char *title);

/*
 * Draw the voltages of all amplifiers as bars, for scenes without patches.
 *   voltage, mark [amplifiers]  in
 */
void page_bars(FILE *file, const scene *scene, const double *voltage, const shell_mark *mark,
               const draw_scale *scale);

/*
 * One column of the table of voltages: its heading and the voltages of all amplifiers.
 * page_voltages writes this table with a row for each amplifier and `count` columns, which the
 * function `set` returns one by one.
 */
typedef struct page_set {
    const char *name;
    const double *voltage; /* [amplifiers] voltages, in the voltage unit of the scene */
} page_set;
typedef page_set page_voltage_set(const void *context, int set);
void page_voltages(FILE *file, const design *design, int count, page_voltage_set *set,
                   const void *context);

/*
 * Reached shape of one result and its misfit, the deviation from the target. Lengths are in the
 * length unit of the scene. Nodes outside the target have NAN in `wanted` and `misfit`.
 */
typedef struct page_shape {
    double *vector; /* [nodes][3] reached displacement */
    double *wanted; /* [nodes][3] reached displacement with the target's component replaced by its
                       target value */
    double *misfit; /* [nodes] reached minus target value of the target's component */
    double worst;   /* largest absolute value of the misfit */
} page_shape;

int page_shape_open(page_shape *shape, const mesh *mesh);
void page_shape_close(page_shape *shape);

/*
 * Fill a shape that page_shape_open has allocated.
 *   u       [dof]      in  displacement vector
 *   reached [targets]  in  reached values of the target's component
 *   target  [targets]  in  target values of the same component
 */
void page_shape_fill(page_shape *shape, const design *design, const double *u,
                     const double *reached, const double *target);

/*
 * page_shape_draw draws a shape coloured by its misfit, with mesh lines of the target over it,
 * magnified by `factor`; the misfit at the outputs of a measured matrix as coloured discs. Returns
 * 0, or -1: out of memory. page_keys writes the legend of the lines in this picture, followed by
 * the markup `more`.
 */
int page_shape_draw(FILE *file, const page_shape *shape, const draw_view *view,
                    const design *design, double factor, const draw_scale *scale);
void page_keys(FILE *file, const mesh *mesh, const char *more);

/*
 * Write a section for each pair of voltage limits: the shape error of every mode of the target
 * within these limits. Writes nothing if the target lists no modes.
 */
void page_modes(FILE *file, const scene *scene, const modes *modes);

/*
 * Length of the largest of the vectors at the nodes.
 *   vector [nodes][3]  in
 */
double page_largest(const mesh *mesh, const double *vector);

/* Write the caption of a drawing with displacements magnified by `factor`. */
void page_magnified(FILE *file, const mesh *mesh, double factor);

#endif
