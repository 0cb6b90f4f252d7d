/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Computing times with full and with compact element types (which contain only what a device cannot
 * compute from the nodes).
 */
#ifndef COMPACT_COST_H
#define COMPACT_COST_H

#include "../mesh/mesh.h"

/*
 * Computing times for one element on this computer in double precision (s), with full element
 * types, and with compact ones (without what a device computes from the nodes).
 */
typedef struct compact_cost {
    double full; /* time for the nodal forces of the element from its strains, with a full element
                    type (s) */
    double compact; /* time for the nodal forces of the element with a compact element type,
                       including the computation of what this type leaves out (s) */
    double matrix;  /* time for the stiffness matrix of the element from a full element type (s) */
} compact_cost;

/*
 * Measure how long this computer needs for nodal forces and stiffness matrix of one element, with
 * full element types, and with compact ones (without what a device computes from the nodes).
 * Returns whether the mesh has compact element types; only then *cost is filled.
 */
bool compact_cost_measure(const mesh *mesh, compact_cost *cost);

#endif
