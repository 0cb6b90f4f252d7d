/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Steps from the contents of a mesh file to a checked mesh; only the files of host_tools/quads use
 * them.
 */
#ifndef QUAD_STEPS_H
#define QUAD_STEPS_H

#include "quad_mesh.h"
#include "quad_options.h"
#include "quad_raw.h"

/*
 * Mesh file, and positions of the elements in it, for error messages after the file has been read.
 */
typedef struct quad_origin {
    const quad_file *file;
    size_t *element_at; /* [elements] position of each element in the mesh file (byte) */
} quad_origin;

/* Return the number that an element, or a node, has in the mesh file. */
long long quad_element_label(const quad_mesh *mesh, size_t element);
long long quad_node_label(const quad_mesh *mesh, size_t node);

/*
 * Replace the numbers of nodes and elements in the mesh file by indices: fill the nodes, the
 * elements and the sets of nodes and elements of the mesh, and list the nodes without elements
 * among the warnings. Returns 0, or -1 after writing an error message about the mesh file.
 */
int quad_collect(quad_mesh *mesh, quad_origin *origin, const quad_raw *raw,
                 const quad_options *options, quad_warnings *warnings);

/*
 * Refuse elements whose sides cross or of which a corner points inwards. Returns 0, or -1 after
 * writing an error message about the mesh file.
 */
int quad_check_folds(const quad_mesh *mesh, const quad_origin *origin);

/*
 * Neighbours of all elements of a mesh across their sides; the value QUAD_FREE marks a side without
 * a neighbour.
 */
#define QUAD_FREE UINT32_MAX
typedef struct quad_topology {
    uint32_t (*neighbour)[4]; /* [elements][4] for each side of each element the side of its
                                 neighbour, as the edge number 4 element + side, or QUAD_FREE where
                                 there is no neighbour */
} quad_topology;
void quad_topology_free(quad_topology *topology);

/*
 * Find the neighbours of all elements, give the elements one orientation, and fill the mesh's named
 * sets of edges. Returns 0, or -1 after writing an error message about the mesh file: the surface
 * is branched, one-sided or in several parts.
 */
int quad_connect(quad_mesh *mesh, const quad_origin *origin, const quad_raw *raw,
                 const quad_options *options, quad_topology *topology);

/*
 * Determine the directors (unit normals) and the first local axes of all nodes. Warn of sharp edges
 * of the surface, and of two nodes at nearly the same place in elements not connected there.
 * Returns 0, or -1 after writing an error message about the mesh file.
 */
int quad_directors(quad_mesh *mesh, const quad_origin *origin, const quad_topology *topology,
                   quad_warnings *warnings);

/*
 * Choose the first side of each element along the first local axes of its nodes as nearly as
 * possible, so that elements of equal shape share an element type, and adapt the edge numbers in
 * named sets. Returns 0, or -1 when memory runs out.
 */
int quad_turn(quad_mesh *mesh);

/*
 * Fill mesh->order with an order of the nodes that gives the factor of the stiffness matrix a small
 * envelope (number of stored entries): the best of the orders that the algorithms of Cuthill and
 * McKee and of Sloan find. Returns 0, or -1 when memory runs out.
 */
int quad_renumber(quad_mesh *mesh);

#endif
