/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Element types of a general mesh: corner tables, stiffness, warp and skew of quadrilaterals in any
 * arrangement, and the checks that such a mesh must pass.
 */
#ifndef QUAD_TYPES_H
#define QUAD_TYPES_H

#include "mesh.h"

/*
 * Check that every edge belongs to at most two elements, which pass it in opposite directions.
 * Returns 0, or -1 with error filled.
 */
int quad_check_edges(const scene *scene, const quad_mesh *quads, char *error);

/*
 * Fill the element types of mesh->quads and what is to be reported about it (mesh->quad_report).
 * The nodes, elements and plies of the mesh must be filled. Returns 0, or -1 with error filled: an
 * element is degenerate, nearly a triangle or stands against its directors, or (unless irregular
 * meshes are accepted) elements are too thin for the irregular mesh around them.
 */
int quad_types_build(mesh *mesh, char *error);

#endif
