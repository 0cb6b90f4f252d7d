/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Mesh of quadrilaterals between the coordinate lines of a surface, for surfaces whose coordinate
 * lines are no lines of curvature.
 */
#ifndef QUADS_OF_LINES_H
#define QUADS_OF_LINES_H

#include "../quads/quad_mesh.h"
#include "../scene/surface.h"

/*
 * Mesh whose nodes are at the intersections of coordinate lines of a surface (lines on which theta1
 * or theta2 is constant), with elements between these lines.
 */
typedef struct line_mesh {
    const surface_point *point; /* [nodes] position, local axes and metric of the surface at the
                                   nodes */
    size_t nodes, elements;
    uint16_t (*element)[4];        /* [elements] numbers of the four corner nodes of each element */
    const double *area;            /* [elements] exact areas of the elements (m2) */
    const uint32_t *present_plies; /* [elements] plies that are present in each element: bit i is
                                      set for ply i */
} line_mesh;

/*
 * Build the mesh of quadrilaterals from nodes and elements between the coordinate lines of a
 * surface; direction 1 of its elements is that of the surface coordinate theta1. The caller
 * releases quads with quad_mesh_free. Returns 0, or -1 with quads empty when memory runs out.
 */
int quads_of_lines(const line_mesh *lines, quad_mesh *quads);

#endif
