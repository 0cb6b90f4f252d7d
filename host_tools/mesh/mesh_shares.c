/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Lengths and areas of places on a mesh (edges, regions, sets), and the shares of them that belong
 * to each node (mesh.h).
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../quads/vector.h"
#include "corner_weight.h"
#include "mesh.h"

/* ---- sides ---------------------------------------------------------------- */

/*
 * Return side number i of an edge set of a mesh from a file; its length is that of the straight
 * line between its nodes.
 */
static mesh_side side_of_set(const mesh *mesh, const quad_set *set, size_t i)
{
    const uint16_t *element = mesh->element[set->index[i] / 4];
    const uint32_t side = set->index[i] % 4;
    mesh_side found = {{element[side], element[(side + 1) % 4]}, 0};
    const double *from = mesh->point[found.node[0]].position,
                 *to = mesh->point[found.node[1]].position;
    found.length =
        sqrt(pow(to[0] - from[0], 2) + pow(to[1] - from[1], 2) + pow(to[2] - from[2], 2));
    return found;
}

/*
 * Return the k-th element side, counted from 0, along an edge of a mesh that consists of mesh
 * lines.
 */
static mesh_side side_of_lines(const mesh *mesh, scene_edge edge, int k)
{
    const int along = edge == EDGE_THETA1_MINUS || edge == EDGE_THETA1_PLUS ? 1 : 0;
    const scene_line *line = &mesh->scene->line[along];
    const int across = edge == EDGE_THETA1_PLUS || edge == EDGE_THETA2_PLUS
                           ? mesh->scene->line[1 - along].elements
                           : 0;
    mesh_side found;
    for (int end = 0; end < 2; end++)
        found.node[end] =
            along == 1 ? mesh_node(mesh, across, k + end) : mesh_node(mesh, k + end, across);
    found.length = mesh->point[found.node[0]].lame[along] * (line->point[k + 1] - line->point[k]);
    return found;
}

int mesh_sides(const mesh *mesh, const scene_where *where)
{
    const quad_mesh *quads = mesh->quads;
    if (!quads && where->type != WHERE_EDGE)
        return -1;
    if (!quads)
        return mesh->scene
            ->line[where->edge == EDGE_THETA1_MINUS || where->edge == EDGE_THETA1_PLUS]
            .elements;
    const quad_set *set = where->type == WHERE_SET
                              ? quad_set_find(quads->edge_set, quads->edge_sets, where->set)
                              : NULL;
    return set ? (int)set->count : -1;
}

mesh_side mesh_side_at(const mesh *mesh, const scene_where *where, int k)
{
    const quad_mesh *quads = mesh->quads;
    if (!quads)
        return side_of_lines(mesh, where->edge, k);
    return side_of_set(mesh, quad_set_find(quads->edge_set, quads->edge_sets, where->set),
                       (size_t)k);
}

int mesh_length_shares(const mesh *mesh, const scene_where *where, double *share)
{
    const int sides = mesh_sides(mesh, where);
    for (int k = 0; k < sides; k++) {
        const mesh_side side = mesh_side_at(mesh, where, k);
        for (int end = 0; end < 2; end++)
            share[side.node[end]] += side.length / 2;
    }
    return sides;
}

/* ---- areas ---------------------------------------------------------------- */

static void add_area(const mesh *mesh, int element, double *share)
{
    const laminate_place *place = &mesh->place[mesh->element_type[element]];
    for (int corner = 0; corner < 4; corner++)
        share[mesh->element[element][corner]] += place->area / 4 * corner_share(place, corner);
}

void mesh_node_areas(const mesh *mesh, double *area)
{
    memset(area, 0, (size_t)mesh->nodes * sizeof *area);
    for (int element = 0; element < mesh->elements; element++)
        add_area(mesh, element, area);
}

/* Return whether all four nodes of an element belong to a set of marked nodes. */
static bool is_inside(const mesh *mesh, int element, const unsigned char *marked)
{
    bool inside = true;
    for (int corner = 0; corner < 4; corner++)
        inside &= marked[mesh->element[element][corner]] != 0;
    return inside;
}

void mesh_area_shares(const mesh *mesh, const scene_where *where, double *share)
{
    const quad_mesh *quads = mesh->quads;
    const quad_set *set = quads && where->type == WHERE_SET
                              ? quad_set_find(quads->element_set, quads->element_sets, where->set)
                              : NULL;
    int *node = calloc((size_t)mesh->nodes, sizeof *node);
    unsigned char *marked = calloc((size_t)mesh->nodes, 1);
    const int count = node && marked ? mesh_select(mesh, where, node) : 0;
    for (int k = 0; k < count; k++)
        marked[node[k]] = 1;
    for (int element = 0; element < mesh->elements && count > 0; element++)
        if (set ? quad_set_has(set, (uint32_t)element) : is_inside(mesh, element, marked))
            add_area(mesh, element, share);
    free(node);
    free(marked);
}
