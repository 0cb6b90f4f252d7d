/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Compact element types of a mesh, which contain only what a device cannot compute from the nodes.
 * They save memory where nearly every element is a type of its own.
 */
#ifndef COMPACT_TYPES_H
#define COMPACT_TYPES_H

#include "mesh.h"

/* Compact element types of a mesh. */
typedef struct compact_types {
    pzs_compact_type *type; /* [types] compact element types; NULL where the mesh has none */
    pzs_node *node;         /* [nodes] positions and triads (local axes) of the nodes; the positions
                               count from an origin near the mesh, so that single precision keeps
                               the differences between neighbours */
} compact_types;

/*
 * Make the compact element types of a mesh. The result has no types in three cases: the library
 * would not complete them to the bits of the full types (element option `published`, and meshes
 * along lines of curvature, whose edges have a length each); the full types take no more memory;
 * memory for the compact types is lacking.
 */
void compact_types_make(compact_types *compact, const mesh *mesh);
void compact_types_free(compact_types *compact);

#endif
