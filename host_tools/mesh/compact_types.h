/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Compact element types of a mesh (pzs_compact_type), without the matrices s, t and base vectors
 * g_mean, g_diff, which the firmware computes from the nodes (pzs_rebuild_type). They save memory
 * where nearly every element is a type of its own.
 */
#ifndef COMPACT_TYPES_H
#define COMPACT_TYPES_H

#include "mesh.h"

/*
 * Compact element types of a mesh, and the nodes. From both, the firmware computes the full element
 * types (pzs_rebuild_type).
 */
typedef struct compact_types {
    pzs_compact_type *type; /* [types] element types without s, t, g_mean and g_diff; NULL where
                               compact types cannot be used (compact_types_make) */
    pzs_node *node;         /* [nodes] positions and triads (local axes) of the nodes; the positions
                               count from an origin near the mesh, so that single precision keeps
                               the differences between neighbours */
} compact_types;

/*
 * Make the compact element types of a mesh and list its nodes. The arrays of types and of nodes are
 * both NULL in three cases: memory runs out; compact types would save no memory; or
 * pzs_rebuild_type does not compute the full types from them bit by bit, as with the element option
 * `published` and on meshes along lines of curvature.
 */
void compact_types_make(compact_types *compact, const mesh *mesh);
void compact_types_free(compact_types *compact);

#endif
