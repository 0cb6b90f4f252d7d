/* SPDX-License-Identifier: BSD-2-Clause */
/* Corner tables s, t, g_mean and g_diff of an element type. */
#ifndef CORNER_TABLES_H
#define CORNER_TABLES_H

#include <stdbool.h>
#include "pzs.h"
#include "../scene/surface.h"

/* What the corner tables of an element are made from. */
typedef struct corner_data {
    const surface_point *point[4]; /* corners (-,-) (+,-) (+,+) (-,+) */
    bool is_cartesian; /* differences of vectors between the corners; else derivatives in the triad
                          that turns with the surface */
    double range[2];   /* lengths of the element in theta1, theta2; not used if is_cartesian */
    double length[2];  /* lengths that differences are divided by; 0: each edge's own chord */
    double middle;     /* height of the mean of the faces above the reference surface */
} corner_data;

/* Fill s, t, g_mean and g_diff of the type, whose other members are not touched. */
void corner_tables_fill(const corner_data *data, pzs_element_type *type);

#endif
