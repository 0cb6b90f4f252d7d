/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The graph of the nodes of a mesh (quad_graph.h). For an order of the nodes, the envelope of the
 * stiffness matrix's factor, which is the number of its stored entries, is counted on the graph.
 */
#include "quad_graph.h"

#include <stdlib.h>
#include <string.h>

/*
 * List all corners of all elements by their nodes: the corners that lie at node n are
 * corner[start[n]] to corner[start[n + 1] - 1].
 */
static void list_corners(const quad_mesh *mesh, uint32_t *start, uint32_t *corner)
{
    for (size_t i = 0; i < 4 * mesh->elements; i++)
        start[mesh->element[i / 4][i % 4] + 2]++;
    for (size_t node = 0; node < mesh->nodes; node++)
        start[node + 2] += start[node + 1];
    for (size_t i = 0; i < 4 * mesh->elements; i++)
        corner[start[mesh->element[i / 4][i % 4] + 1]++] = (uint32_t)i;
}

/* Fill the list of the neighbours of each node of the mesh. */
static void list_neighbours(const quad_mesh *mesh, const uint32_t *start, const uint32_t *corner,
                            uint32_t *seen, quad_graph *graph)
{
    uint32_t count = 0;
    for (uint32_t node = 0; node < graph->nodes; node++) {
        graph->start[node] = count;
        seen[node] = node + 1;
        for (uint32_t k = start[node]; k < start[node + 1]; k++)
            for (int i = 0; i < 4; i++) {
                const uint32_t other = mesh->element[corner[k] / 4][i];
                if (seen[other] == node + 1)
                    continue;
                seen[other] = node + 1;
                graph->neighbour[count++] = other;
            }
    }
    graph->start[graph->nodes] = count;
}

int quad_graph_make(quad_graph *graph, const quad_mesh *mesh)
{
    uint32_t *start = calloc(mesh->nodes + 2, sizeof *start);
    uint32_t *corner = calloc(4 * mesh->elements, sizeof *corner);
    uint32_t *seen = calloc(mesh->nodes, sizeof *seen);
    int status = -1;
    graph->nodes = (uint32_t)mesh->nodes;
    graph->start = calloc(mesh->nodes + 1, sizeof *graph->start);
    graph->neighbour = calloc(12 * mesh->elements, sizeof *graph->neighbour);
    if (start && corner && seen && graph->start && graph->neighbour) {
        list_corners(mesh, start, corner);
        list_neighbours(mesh, start, corner, seen, graph);
        status = 0;
    }
    free(start);
    free(corner);
    free(seen);
    return status;
}

void quad_graph_free(quad_graph *graph)
{
    free(graph->start);
    free(graph->neighbour);
    memset(graph, 0, sizeof *graph);
}

uint64_t quad_envelope(const quad_graph *graph, const uint32_t *order, uint32_t *place)
{
    uint64_t sum = 0;
    for (uint32_t i = 0; i < graph->nodes; i++)
        place[order[i]] = i;
    for (uint32_t node = 0; node < graph->nodes; node++) {
        uint32_t first = place[node];
        for (uint32_t k = graph->start[node]; k < graph->start[node + 1]; k++) {
            const uint32_t other = place[graph->neighbour[k]];
            first = other < first ? other : first;
        }
        sum += place[node] - first;
    }
    return sum;
}
