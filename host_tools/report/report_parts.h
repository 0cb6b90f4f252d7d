/* Parts that the report pages share: their head, the structure in words, misfits, a fair
 * magnification. */
#ifndef REPORT_PARTS_H
#define REPORT_PARTS_H

#include "../model/analysis.h"
#include "report_draw.h"

/* Name, purpose, changes, mesh and numerics. residual and error (pzs_model) of the solves of this
 * page; negative: not checked. */
void parts_head(FILE *file, const analysis *analysis, const char *kind, double residual,
                double error);

/* Tables: the layers; supports, loads and actuators. */
void parts_layers(FILE *file, const scene *scene);
void parts_conditions(FILE *file, const design *design);

/*
 * What a shape misses of a target.
 *   shape, target [targets] in; vector [nodes][3] in  displacement that belongs to the shape
 *   misfit [nodes]    out  reached minus wanted; NAN where nothing is wanted
 *   wanted [nodes][3] out  vector with the target's component as wanted; NAN as above
 */
void parts_misfit(const design *design, const double *shape, const double *target,
                  const double *vector, double *misfit, double *wanted);

/* Factor that draws the largest displacement at about a share of the structure: 1, 2 or 5 times a
 * power of ten. most (length) in */
double parts_magnification(const mesh *mesh, double most, double share);

/* Include the structure at rest and moved by factor times vector [nodes][3]. */
void parts_include(draw_view *view, const mesh *mesh, const double *vector, double factor);

/*
 * Picture of a shape reached, coloured by its misfit, the target as lines over it, the edges at
 * rest dashed. vector, wanted [nodes][3], misfit [nodes] in  as parts_misfit has them scale in  of
 * the misfit Returns 0, or -1 when memory runs out. parts_keys: its lines explained; more (markup)
 * beside them.
 */
int parts_shape(FILE *file, const draw_view *view, const design *design, const double *vector,
                const double *wanted, const double *misfit, double factor, const draw_scale *scale);
void parts_keys(FILE *file, const char *more);

/* Caption of a magnified drawing. */
void parts_magnified(FILE *file, const mesh *mesh, double factor);

#endif
