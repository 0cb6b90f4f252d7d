/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Order of the nodes that gives the factor of the stiffness matrix a small envelope (quad_steps.h):
 * the reverse Cuthill-McKee algorithm, started from a node or from all nodes on one side of the
 * mesh. Two nodes are neighbours if they belong to one element.
 */
#include "quad_steps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Elements at each node: those of node n are element[start[n]] to element[start[n + 1] - 1]. */
typedef struct star {
    uint32_t *start, *element;
} star;

static int make_star(const quad_mesh *mesh, star *star)
{
    star->start = calloc(mesh->nodes + 2, sizeof *star->start);
    star->element = calloc(4 * mesh->elements, sizeof *star->element);
    if (!star->start || !star->element)
        return -1;
    for (size_t i = 0; i < 4 * mesh->elements; i++)
        star->start[mesh->element[i / 4][i % 4] + 2]++;
    for (size_t node = 0; node < mesh->nodes; node++)
        star->start[node + 2] += star->start[node + 1];
    for (size_t i = 0; i < 4 * mesh->elements; i++)
        star->element[star->start[mesh->element[i / 4][i % 4] + 1]++] = (uint32_t)(i / 4);
    return 0;
}

static uint32_t valence(const star *star, uint32_t node)
{
    return star->start[node + 1] - star->start[node];
}

/* Move the last node of a list forward until no node before it belongs to more elements. */
static void sift(const star *star, uint32_t *list, size_t count)
{
    for (size_t i = count - 1; i > 0; i--) {
        if (valence(star, list[i - 1]) <= valence(star, list[i]))
            return;
        const uint32_t swap = list[i];
        list[i] = list[i - 1];
        list[i - 1] = swap;
    }
}

/*
 * List all nodes in levels: level 0 consists of the first `count` nodes of the order, and each
 * further level of the new neighbours of the level before. Among the neighbours of a node, those
 * with fewer elements come first.
 *   order  [nodes] in/out  the first `count` nodes in, all nodes out
 *   level  [nodes] work
 * Returns the number of levels.
 */
static uint32_t list_levels(const quad_mesh *mesh, const star *star, size_t count, uint32_t *order,
                            uint32_t *level)
{
    for (size_t node = 0; node < mesh->nodes; node++)
        level[node] = UINT32_MAX;
    for (size_t i = 0; i < count; i++)
        level[order[i]] = 0;
    for (size_t i = 0; i < count; i++) {
        const uint32_t own = order[i];
        const size_t first = count;
        for (uint32_t k = star->start[own]; k < star->start[own + 1]; k++)
            for (int corner = 0; corner < 4; corner++) {
                const uint32_t other = mesh->element[star->element[k]][corner];
                if (level[other] != UINT32_MAX)
                    continue;
                level[other] = level[own] + 1;
                order[count++] = other;
                sift(star, order + first, count - first);
            }
    }
    return level[order[count - 1]] + 1;
}

/* Return the node with the fewest elements among those in the last level of an order. */
static uint32_t end_node(const quad_mesh *mesh, const star *star, const uint32_t *order,
                         const uint32_t *level)
{
    uint32_t best = order[mesh->nodes - 1];
    for (size_t i = mesh->nodes; i-- > 0 && level[order[i]] == level[order[mesh->nodes - 1]];)
        if (valence(star, order[i]) < valence(star, best))
            best = order[i];
    return best;
}

/*
 * Find an order that starts from a node at an end of the mesh: the search moves on to the farthest
 * node as long as the number of levels grows.
 */
static void order_from_node(const quad_mesh *mesh, const star *star, uint32_t *order,
                            uint32_t *level)
{
    order[0] = 0;
    uint32_t levels = list_levels(mesh, star, 1, order, level);
    for (int round = 0; round < 8; round++) {
        order[0] = end_node(mesh, star, order, level);
        const uint32_t more = list_levels(mesh, star, 1, order, level);
        if (more <= levels)
            break;
        levels = more;
    }
}

/* Return the mean length of the sides of all elements. */
static double mean_side(const quad_mesh *mesh)
{
    double sum = 0;
    for (size_t i = 0; i < 4 * mesh->elements; i++) {
        const double *from = mesh->position[mesh->element[i / 4][i % 4]];
        const double *to = mesh->position[mesh->element[i / 4][(i + 1) % 4]];
        double square = 0;
        for (int k = 0; k < 3; k++)
            square += (from[k] - to[k]) * (from[k] - to[k]);
        sum += sqrt(square);
    }
    return sum / (4 * (double)mesh->elements);
}

/* Find the lowest and the highest coordinate of the nodes along a global axis (range [2] out). */
static void find_range(const quad_mesh *mesh, int axis, double range[2])
{
    range[0] = HUGE_VAL;
    range[1] = -HUGE_VAL;
    for (size_t node = 0; node < mesh->nodes; node++) {
        range[0] = fmin(range[0], mesh->position[node][axis]);
        range[1] = fmax(range[1], mesh->position[node][axis]);
    }
}

/*
 * Find an order that starts from all nodes at the lower end of the mesh along a global axis, sorted
 * along the longer one of the other two axes.
 */
static void order_from_side(const quad_mesh *mesh, const star *star, int axis, uint32_t *order,
                            uint32_t *level)
{
    double range[3][2];
    const double near = 1e-3 * mean_side(mesh);
    int along = (axis + 1) % 3;
    size_t count = 0;
    for (int i = 0; i < 3; i++)
        find_range(mesh, i, range[i]);
    const int other = (axis + 2) % 3;
    if (range[other][1] - range[other][0] > range[along][1] - range[along][0])
        along = other;
    for (uint32_t node = 0; node < mesh->nodes; node++) {
        if (mesh->position[node][axis] > range[axis][0] + near)
            continue;
        size_t i = count++;
        for (; i > 0 && mesh->position[order[i - 1]][along] > mesh->position[node][along]; i--)
            order[i] = order[i - 1];
        order[i] = node;
    }
    list_levels(mesh, star, count, order, level);
}

/*
 * Return the size of the factor's envelope for the reverse of an order: the sum, over all nodes, of
 * the distance in the order to their first neighbour.
 */
static uint64_t profile(const quad_mesh *mesh, const star *star, const uint32_t *order,
                        uint32_t *place)
{
    uint64_t sum = 0;
    for (uint32_t i = 0; i < mesh->nodes; i++)
        place[order[mesh->nodes - 1 - i]] = i;
    for (uint32_t node = 0; node < mesh->nodes; node++) {
        uint32_t first = place[node];
        for (uint32_t k = star->start[node]; k < star->start[node + 1]; k++)
            for (int corner = 0; corner < 4; corner++) {
                const uint32_t other = place[mesh->element[star->element[k]][corner]];
                first = other < first ? other : first;
            }
        sum += place[node] - first;
    }
    return sum;
}

/*
 * Find the order with the smallest envelope among those from a node and from the lower ends of the
 * mesh along the three global axes.
 */
static void find_order(const quad_mesh *mesh, const star *star, uint32_t *level, uint32_t *other)
{
    order_from_node(mesh, star, mesh->order, level);
    uint64_t best = profile(mesh, star, mesh->order, level);
    for (int axis = 0; axis < 3; axis++) {
        order_from_side(mesh, star, axis, other, level);
        const uint64_t own = profile(mesh, star, other, level);
        if (own >= best)
            continue;
        best = own;
        memcpy(mesh->order, other, mesh->nodes * sizeof *other);
    }
    for (size_t i = 0; i < mesh->nodes / 2; i++) {
        const uint32_t swap = mesh->order[i];
        mesh->order[i] = mesh->order[mesh->nodes - 1 - i];
        mesh->order[mesh->nodes - 1 - i] = swap;
    }
}

int quad_renumber(quad_mesh *mesh)
{
    star star = {NULL, NULL};
    uint32_t *level = calloc(mesh->nodes, sizeof *level);
    uint32_t *other = calloc(mesh->nodes, sizeof *other);
    int status = -1;
    mesh->order = calloc(mesh->nodes, sizeof *mesh->order);
    if (level && other && mesh->order && make_star(mesh, &star) == 0) {
        find_order(mesh, &star, level, other);
        status = 0;
    }
    free(star.start);
    free(star.element);
    free(level);
    free(other);
    return status;
}
