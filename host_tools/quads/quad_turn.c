/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Choice of the corner with which the list of an element's corners begins, so that elements of
 * equal shape share an element type (quad_steps.h).
 */
#include "quad_steps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/*
 * Return how well side k of an element runs along the first local axes of its nodes: the component
 * of the side's direction along these axes.
 */
static double along_axes(const quad_mesh *mesh, const uint32_t node[4], int k)
{
    double sum = 0;
    for (int i = 0; i < 3; i++) {
        double axis = 0;
        for (int corner = 0; corner < 4; corner++)
            axis += mesh->axis[node[corner]][i];
        sum += axis * (mesh->position[node[(k + 1) % 4]][i] + mesh->position[node[(k + 2) % 4]][i] -
                       mesh->position[node[k]][i] - mesh->position[node[(k + 3) % 4]][i]);
    }
    return sum;
}

/*
 * Return the corner with which the list of an element's corners should begin, so that its first
 * side runs along the first local axes of its nodes; the first of nearly equal choices is taken.
 */
static uint32_t first_corner(const quad_mesh *mesh, const uint32_t node[4])
{
    const double nearly = 1 + 1e-6;
    uint32_t best = 0;
    for (int k = 1; k < 4; k++)
        if (along_axes(mesh, node, k) > nearly * fmax(along_axes(mesh, node, (int)best), 0))
            best = (uint32_t)k;
    return best;
}

/*
 * Renumber the sides in a set of edges after the corner lists of elements were rotated; an edge is
 * the number 4 element + side.
 *   first  [elements] in  number that the new first corner of each element had before
 */
static void turn_set(quad_set *set, const uint32_t *first)
{
    for (size_t i = 0; i < set->count; i++) {
        const uint32_t element = set->index[i] / 4, side = set->index[i] % 4;
        set->index[i] = 4 * element + (side + 4 - first[element]) % 4;
    }
    quad_set_sort(set);
}

int quad_turn(quad_mesh *mesh)
{
    uint32_t *first = calloc(mesh->elements, sizeof *first);
    if (!first)
        return -1;
    for (size_t element = 0; element < mesh->elements; element++) {
        uint32_t node[4];
        memcpy(node, mesh->element[element], sizeof node);
        first[element] = first_corner(mesh, node);
        for (uint32_t corner = 0; corner < 4; corner++)
            mesh->element[element][corner] = node[(corner + first[element]) % 4];
    }
    for (size_t k = 0; k < mesh->edge_sets; k++)
        turn_set(&mesh->edge_set[k], first);
    free(first);
    return 0;
}
