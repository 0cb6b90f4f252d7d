/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * What the pages of the report share: their frame, the structure in words, misfits and their
 * picture.
 */
#ifndef REPORT_PAGE_H
#define REPORT_PAGE_H

#include "report.h"
#include "report_shell.h"

/*
 * Frame of a page with its name, purpose, mesh, numerics and warnings. residual: of the solves of
 * this page
 */
void page_begin(const report_job *job, const analysis *analysis, const char *kind, double residual);
void page_end(const report_job *job);

/*
 * Frame of the main picture in a file of its own, as large as its contents (width, height), title
 * and notes included.
 */
void picture_begin(const report_job *job, const scene *scene, const char *title, double width,
                   double height);
void picture_end(const report_job *job, double width, double height);

/* Tables: supports, loads and actuators; layers and materials. */
void page_conditions(FILE *file, const design *design);
void page_layers(FILE *file, const scene *scene);

/* Table of voltages by amplifier name, a column for each of count sets. */
typedef struct page_set {
    const char *name;
    const double *voltage; /* [amplifiers] */
} page_set;
typedef page_set page_voltage_set(const void *context, int set);
void page_voltages(FILE *file, const design *design, int count, page_voltage_set *set,
                   const void *context);

/* Reached shape of one result, and what it misses of a target. */
typedef struct page_shape {
    double *vector; /* [nodes][3] displacement */
    double *wanted; /* [nodes][3] the same with the target's component as wanted; NAN where nothing
                       is */
    double *misfit; /* [nodes] reached minus wanted, NAN as above */
    double worst;   /* largest |misfit| */
} page_shape;

int page_shape_open(page_shape *shape, const mesh *mesh);
void page_shape_close(page_shape *shape);

/*
 * u [dof] displacement, reached, target [targets] its part that the target is about, and the
 * wanted one
 */
void page_shape_fill(page_shape *shape, const design *design, const double *u,
                     const double *reached, const double *target);

/*
 * Picture of a shape coloured by its misfit, the target as lines over it; its lines explained,
 * more (markup) beside.
 */
int page_shape_draw(FILE *file, const page_shape *shape, const draw_view *view,
                    const design *design, double factor, const draw_scale *scale);
void page_keys(FILE *file, const char *more);

/*
 * A section for each limit with the modes of a target: what is left of each; nothing without
 * modes.
 */
void page_modes(FILE *file, const scene *scene, const modes *modes);

/* Length of the largest vector. vector [nodes][3] */
double page_largest(const mesh *mesh, const double *vector);

/* Caption of a magnified drawing. */
void page_magnified(FILE *file, const mesh *mesh, double factor);

#endif
