/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Compact element types of a mesh, which contain only what a device cannot compute from the nodes.
 * They save memory where nearly every element is a type of its own.
 */
#ifndef COMPACT_TYPES_H
#define COMPACT_TYPES_H

#include "mesh.h"

/*
 * Compact element types of a mesh, which lack the numbers that a device computes from the nodes;
 * and the nodes, from which it computes them.
 */
typedef struct compact_types {
    pzs_compact_type *type; /* [types] element types without the numbers that a device computes from
                               the nodes; NULL where the mesh needs full element types */
    pzs_node *node;         /* [nodes] positions and triads (local axes) of the nodes; the positions
                               count from an origin near the mesh, so that single precision keeps
                               the differences between neighbours */
} compact_types;

/*
 * Make element types of a mesh that leave out what a device computes from the nodes (compact
 * types). The result has no types in three cases: the library would not compute the full types bit
 * by bit (element option `published`, and meshes along lines of curvature, whose edges have a
 * length each); the full types take no more memory; memory for the compact types is lacking.
 */
void compact_types_make(compact_types *compact, const mesh *mesh);
void compact_types_free(compact_types *compact);

#endif
