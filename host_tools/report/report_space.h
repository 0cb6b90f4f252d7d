/* A shell in space: coloured surface, mesh lines, supports, loads and outputs. */
#ifndef REPORT_SPACE_H
#define REPORT_SPACE_H

#include "report_draw.h"

/*
 * What is drawn: the mesh moved by factor times a displacement, in a view.
 *   vector [nodes][3]  displacement, or NULL
 */
typedef struct space {
    FILE *file;
    const draw_view *view;
    const mesh *m;
    const double *vector;
    double factor;
} space;

/* Surface coloured by value [nodes] with its supports, farther parts first; NaN is grey. Returns 0,
 * or -1 when memory runs out. */
int space_surface(const space *f, const double *value, const draw_scale *scale);

/* Are elements or mesh lines left out of the drawings, for there are too many? */
int space_is_thinned(const mesh *mesh);

/* Mesh lines of a style class; broken where the displacement is NaN. */
void space_wires(const space *f, const char *style);

/* The four edges, dashed. */
void space_outline(const space *f);

/* A dot at a node. */
void space_dot(const space *f, int node);

/* Point loads as arrows, named points with their names. */
void space_loads(const space *f);
void space_outputs(const space *f);

/* Directions of x, y, z in a corner. */
void space_axes(const space *f);

#endif
