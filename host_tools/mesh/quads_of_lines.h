/* SPDX-License-Identifier: BSD-2-Clause */
/* General mesh of the elements between the coordinate lines of a surface that is not meshed along
 * its lines of curvature. */
#ifndef QUADS_OF_LINES_H
#define QUADS_OF_LINES_H

#include "../quads/quad_mesh.h"
#include "../scene/surface.h"

/* Nodes and elements between coordinate lines. */
typedef struct line_mesh {
    const surface_point *point; /* [nodes] */
    size_t nodes, elements;
    uint16_t (*element)[4];        /* [elements] nodes of the corners */
    const double *area;            /* [elements] exact areas */
    const uint32_t *present_plies; /* [elements] */
} line_mesh;

/*
 * Build the general mesh; its elements' direction 1 is that of theta1. quads out, to be released
 * with quad_mesh_free. Returns 0, or -1 without memory and quads empty.
 */
int quads_of_lines(const line_mesh *lines, quad_mesh *quads);

#endif
