/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Computing times with full and with compact element types (which contain only what a device cannot
 * compute from the nodes).
 */
#ifndef COMPACT_COST_H
#define COMPACT_COST_H

#include "../mesh/mesh.h"

/*
 * Computing times for one element with full and with compact element types, on this computer in
 * double precision (s).
 */
typedef struct compact_cost {
    double full; /* time for the nodal forces of the element from its strains, with a full element
                    type (s) */
    double compact; /* time for the nodal forces of the element with a compact element type, which
                       is completed first (s) */
    double matrix;  /* time for the stiffness matrix of the element from a full element type (s);
                       compact tables do not contain this matrix */
} compact_cost;

/*
 * Measure the computing times for one element of a mesh. Returns whether the mesh has compact
 * element types; only then *cost is filled.
 */
bool compact_cost_measure(const mesh *mesh, compact_cost *cost);

#endif
