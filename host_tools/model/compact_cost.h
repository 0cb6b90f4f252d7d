/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Computing times with full and with compact element types (which contain only what a device cannot
 * compute from the nodes).
 */
#ifndef COMPACT_COST_H
#define COMPACT_COST_H

#include "../mesh/mesh.h"

/*
 * Computing times for one element on this computer in double precision (s). A full element type
 * stores all its tables; a compact one leaves out those that a device can compute from the nodes.
 */
typedef struct compact_cost {
    double full; /* time to compute the nodal forces of one element where all tables of its element
                    type are stored (s) */
    double compact; /* time to compute the nodal forces of one element where its element type is
                       compact (s): only those tables are stored that do not follow from the
                       positions of the nodes, and the others are computed first */
    double matrix;  /* time for the stiffness matrix of the element from a full element type (s) */
} compact_cost;

/*
 * Measure the time of this computer for the nodal forces and the stiffness matrix of one element:
 * of a compact element type, without the tables that a device computes from the nodes, and of a
 * full one.
 *   cost out  times; filled only where the mesh has compact element types
 * Returns whether the mesh has such types.
 */
bool compact_cost_measure(const mesh *mesh, compact_cost *cost);

#endif
