/* SPDX-License-Identifier: BSD-2-Clause */
/* Time that compact element types take, beside full ones. */
#ifndef COMPACT_COST_H
#define COMPACT_COST_H

#include "../mesh/mesh.h"

/* Times for one element on this computer, in double precision (s). */
typedef struct compact_cost {
    double full;    /* nodal force from the strains of the element, with its full type */
    double compact; /* the same force, with the compact type, which is completed before */
    double matrix;  /* stiffness matrix from the full type, which compact tables leave out */
} compact_cost;

/*
 * Measure the times of a mesh whose element types have a compact form. Returns whether the mesh has
 * such types; the times are written only then.
 */
bool compact_cost_measure(const mesh *mesh, compact_cost *cost);

#endif
