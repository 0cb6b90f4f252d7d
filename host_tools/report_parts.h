/* Parts that the report pages share: their head, the structure in words, a fair magnification. */
#ifndef REPORT_PARTS_H
#define REPORT_PARTS_H

#include "analysis.h"
#include "report_draw.h"

/* Name, purpose, changes, mesh and numerics. */
void parts_head(FILE *file, const analysis *a, const char *kind);

/* Layers, supports, loads and applied volts. */
void parts_structure(FILE *file, const design *d);

/* Displacement to be drawn at about a tenth of the structure: 1, 2 or 5 times a power of ten. most in (length) */
double parts_magnification(const mesh *m, double most);

/* Include the structure at rest and moved by factor times vector [nodes][3]. */
void parts_include(draw_view *view, const mesh *m, const double *vector, double factor);

/* Caption of a magnified drawing. */
void parts_magnified(FILE *file, double factor);

#endif
