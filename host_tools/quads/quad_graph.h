/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The graph of a mesh, in which two nodes are neighbours if they belong to one element. An order of
 * the nodes is good if the factor of the stiffness matrix then has few stored entries (a small
 * envelope).
 */
#ifndef QUAD_GRAPH_H
#define QUAD_GRAPH_H

#include "quad_mesh.h"

/*
 * Neighbours of the nodes of a mesh: those of node n are neighbour[start[n]] to neighbour[start[n +
 * 1] - 1].
 */
typedef struct quad_graph {
    uint32_t nodes;
    uint32_t *start; /* [nodes + 1] index of the first neighbour of each node in `neighbour`; the
                        last element is the number of all entries */
    uint32_t *neighbour; /* [entries] indices of the neighbours of node 0, then of node 1 and so on;
                            each neighbour of a node occurs once */
} quad_graph;

/*
 * Fill the graph of a mesh, which lists the neighbours of each node: the nodes that share an
 * element with it. Returns 0, or -1 when memory runs out.
 */
int quad_graph_make(quad_graph *graph, const quad_mesh *mesh);

void quad_graph_free(quad_graph *graph);

/*
 * Return the number of stored entries (envelope) of the stiffness matrix's factor for an order of
 * the nodes, with one row for each node: the sum over all nodes of the distance in the order
 * between a node and its first neighbour.
 *   order [nodes] in   nodes in this order
 *   place [nodes] out  position of each node in the order
 */
uint64_t quad_envelope(const quad_graph *graph, const uint32_t *order, uint32_t *place);

/*
 * Order the nodes by Sloan's algorithm: the next number goes to the node with the highest priority,
 * its distance from the end of the mesh minus growth_weight times the growth of the front (nodes
 * without a number beside numbered ones).
 *   distance [nodes]   in   number of elements between each node and the end of the mesh
 *   first              in   node that gets the first number
 *   growth_weight      in   weight of the growth of the front against the distance
 *   order    [nodes]   out  the nodes in the order of their numbers
 * Returns 0, or -1 when memory runs out.
 */
int quad_sloan(const quad_graph *graph, const uint32_t *distance, uint32_t first, int growth_weight,
               uint32_t *order);

#endif
