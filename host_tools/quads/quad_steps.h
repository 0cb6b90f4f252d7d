/* SPDX-License-Identifier: BSD-2-Clause */
/* Steps from the contents of a mesh file to a mesh; shared by the files of this room. */
#ifndef QUAD_STEPS_H
#define QUAD_STEPS_H

#include "quad_mesh.h"
#include "quad_options.h"
#include "quad_raw.h"

/* What the messages of the later steps need of the file. */
typedef struct quad_origin {
    const quad_file *file;
    size_t *element_at; /* [elements] place of each element in the file (byte) */
} quad_origin;

/* Number of an element or of a node in the file. */
long long quad_element_label(const quad_mesh *mesh, size_t element);
long long quad_node_label(const quad_mesh *mesh, size_t node);

/*
 * Look up all numbers: fill nodes, elements and sets of nodes and elements. Each step returns 0, or
 * -1 with the error of the file filled.
 */
int quad_collect(quad_mesh *mesh, quad_origin *origin, const quad_raw *raw,
                 const quad_options *options);

/* Neighbours of the elements across their sides. */
#define QUAD_FREE UINT32_MAX
typedef struct quad_topology {
    uint32_t (*neighbour)[4]; /* [elements] edge 4 element + side on the other side, or QUAD_FREE */
} quad_topology;
void quad_topology_free(quad_topology *topology);

/*
 * Find the neighbours and give all elements one orientation; then fill the edge sets. Refuses
 * branched, one-sided and disconnected surfaces.
 */
int quad_connect(quad_mesh *mesh, const quad_origin *origin, const quad_raw *raw,
                 const quad_options *options, quad_topology *topology);

/* Fill directors and axes; warn of sharp edges and of nodes at one place that are not joined. */
int quad_directors(quad_mesh *mesh, const quad_origin *origin, const quad_topology *topology,
                   quad_warnings *warnings);

/*
 * Let the first side of each element run as nearly along the axes of its nodes as it can, so that
 * equal elements are listed alike and share an element type. The sides in edge sets follow.
 * Returns 0, or -1: out of memory.
 */
int quad_turn(quad_mesh *mesh);

/*
 * Fill mesh->order for a small envelope of the factor: reverse Cuthill-McKee from a node at an end
 * of the mesh. Returns 0, or -1: out of memory.
 */
int quad_renumber(quad_mesh *mesh);

#endif
