/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Numbering of the mesh nodes with which the factor of the stiffness matrix has few stored entries
 * (small envelope, quad_steps.h): the best of orders by Cuthill-McKee from a node, by Cuthill-McKee
 * from all nodes on one side of the mesh, and by Sloan, each also reversed.
 */
#include "quad_graph.h"
#include "quad_steps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static uint32_t valence(const quad_graph *graph, uint32_t node)
{
    return graph->start[node + 1] - graph->start[node];
}

/*
 * Insert the last node of a list into the nodes before it, which ascend by their numbers of
 * neighbours in the mesh.
 */
static void sift(const quad_graph *graph, uint32_t *list, size_t count)
{
    for (size_t i = count - 1; i > 0; i--) {
        if (valence(graph, list[i - 1]) <= valence(graph, list[i]))
            return;
        const uint32_t swap = list[i];
        list[i] = list[i - 1];
        list[i - 1] = swap;
    }
}

/*
 * List all nodes of the mesh by levels: level 0 is given, and each further level consists of the
 * new neighbours of the previous one. Of a node's neighbours, those with fewer neighbours come
 * first.
 *   order [nodes] in/out  in: nodes of level 0, `count` in number; out: all nodes
 *   level [nodes] out     level of each node
 * Returns the number of levels.
 */
static uint32_t list_levels(const quad_graph *graph, size_t count, uint32_t *order, uint32_t *level)
{
    for (size_t node = 0; node < graph->nodes; node++)
        level[node] = UINT32_MAX;
    for (size_t i = 0; i < count; i++)
        level[order[i]] = 0;
    for (size_t i = 0; i < count; i++) {
        const uint32_t own = order[i];
        const size_t first = count;
        for (uint32_t k = graph->start[own]; k < graph->start[own + 1]; k++) {
            const uint32_t other = graph->neighbour[k];
            if (level[other] != UINT32_MAX)
                continue;
            level[other] = level[own] + 1;
            order[count++] = other;
            sift(graph, order + first, count - first);
        }
    }
    return level[order[count - 1]] + 1;
}

/*
 * Return the node with the fewest neighbours in the last level of a node order; the level of a node
 * is its distance, counted in elements, from the start of the order.
 */
static uint32_t end_node(const quad_graph *graph, const uint32_t *order, const uint32_t *level)
{
    const uint32_t last = order[graph->nodes - 1];
    uint32_t best = last;
    for (size_t i = graph->nodes; i-- > 0 && level[order[i]] == level[last];)
        if (valence(graph, order[i]) < valence(graph, best))
            best = order[i];
    return best;
}

/*
 * Find an order of the nodes by levels: the level of a node is its distance from the first node,
 * counted in elements. The first node lies at an end of the mesh. It is found by moving to a node
 * of the last level as long as the number of levels grows.
 */
static void order_from_node(const quad_graph *graph, uint32_t *order, uint32_t *level)
{
    order[0] = 0;
    uint32_t levels = list_levels(graph, 1, order, level);
    for (int round = 0; round < 8; round++) {
        order[0] = end_node(graph, order, level);
        const uint32_t more = list_levels(graph, 1, order, level);
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
 * Find an order of the nodes by their distances, counted in elements, from one side of the mesh:
 * from all nodes with the lowest coordinate along a global axis. These nodes are sorted along that
 * one of the other two axes in which the mesh is longer.
 */
static void order_from_side(const quad_mesh *mesh, const quad_graph *graph, int axis,
                            uint32_t *order, uint32_t *level)
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
    list_levels(graph, count, order, level);
}

/*
 * Search for the order of the nodes in which the stiffness matrix has the smallest envelope (number
 * of stored entries).
 */
typedef struct search {
    const quad_graph *graph;
    uint32_t *best;  /* [nodes] node order with the smallest envelope of the stiffness matrix found
                        so far */
    uint32_t *other; /* [nodes] another node order, whose envelope (number of stored matrix entries)
                        is compared with the smallest one found so far */
    uint32_t *level; /* [nodes] number of elements on the shortest way from the first node of a node
                        order to each node */
    uint32_t *place; /* [nodes] work memory in which each node's position in an order is stored
                        while the envelope of the stiffness matrix is counted */
    uint64_t envelope; /* number of stored entries (envelope) of the stiffness matrix's factor for
                          the best node order; UINT64_MAX: no order has been found yet */
} search;

static void reverse(uint32_t *order, size_t count)
{
    for (size_t i = 0; i < count / 2; i++) {
        const uint32_t swap = order[i];
        order[i] = order[count - 1 - i];
        order[count - 1 - i] = swap;
    }
}

/*
 * Make the node order `other` the best order of a search if the stiffness matrix has a smaller
 * envelope (number of stored entries) with it than with the best order so far.
 */
static void compare(search *search)
{
    const uint64_t envelope = quad_envelope(search->graph, search->other, search->place);
    if (envelope >= search->envelope)
        return;
    search->envelope = envelope;
    memcpy(search->best, search->other, search->graph->nodes * sizeof *search->best);
}

/*
 * Compare a new node order and its reverse with the best one found so far, and keep the one for
 * which the stiffness matrix has the fewest stored entries.
 */
static void compare_both(search *search)
{
    compare(search);
    reverse(search->other, search->graph->nodes);
    compare(search);
}

/*
 * Try four node orders of the algorithm of Cuthill and McKee, and keep the best order (fewest
 * stored entries of the stiffness matrix). One order starts from a node at an end of the mesh. The
 * other three start from all nodes on the lowest side of the mesh along x, y and z.
 */
static void try_levels(search *search, const quad_mesh *mesh)
{
    order_from_node(search->graph, search->other, search->level);
    compare_both(search);
    for (int axis = 0; axis < 3; axis++) {
        order_from_side(mesh, search->graph, axis, search->other, search->level);
        compare_both(search);
    }
}

/*
 * Try node orders of Sloan's algorithm from the node `first` to the opposite end of the mesh, with
 * several weights of the growth of the front. Keep the best order found so far (fewest stored
 * entries of the stiffness matrix). Returns 0, or -1 when memory runs out.
 */
static int try_sloan(search *search, uint32_t first)
{
    static const int weight[] = {1, 2, 4, 8};
    for (size_t k = 0; k < sizeof weight / sizeof *weight; k++) {
        if (quad_sloan(search->graph, search->level, first, weight[k], search->other) < 0)
            return -1;
        compare_both(search);
    }
    return 0;
}

/*
 * Set the level of each node to its distance from the lower end of the mesh along a global axis.
 * The distance is counted in mean side lengths of the elements and limited to the number of nodes.
 * Returns the node at the upper end.
 */
static uint32_t measure_levels(const search *search, const quad_mesh *mesh, int axis)
{
    const double side = mean_side(mesh);
    double range[2];
    uint32_t last = 0;
    find_range(mesh, axis, range);
    for (uint32_t node = 0; node < mesh->nodes; node++) {
        const double distance = (mesh->position[node][axis] - range[0]) / side;
        search->level[node] = (uint32_t)fmin(distance, (double)mesh->nodes);
        if (mesh->position[node][axis] > mesh->position[last][axis])
            last = node;
    }
    return last;
}

/*
 * Try node orders of Sloan's algorithm, each from one end of the mesh to the opposite one, and keep
 * the order with the fewest stored entries. Ends: two nodes with many elements between them, then
 * the highest and lowest nodes along x, y and z. Returns 0, or -1 when memory runs out.
 */
static int try_fronts(search *search, const quad_mesh *mesh)
{
    order_from_node(search->graph, search->other, search->level);
    if (try_sloan(search, end_node(search->graph, search->other, search->level)) < 0)
        return -1;
    for (int axis = 0; axis < 3; axis++)
        if (try_sloan(search, measure_levels(search, mesh, axis)) < 0)
            return -1;
    return 0;
}

int quad_renumber(quad_mesh *mesh)
{
    quad_graph graph = {0};
    search search = {.graph = &graph, .envelope = UINT64_MAX};
    search.best = mesh->order = calloc(mesh->nodes, sizeof *mesh->order);
    search.other = calloc(mesh->nodes, sizeof *search.other);
    search.level = calloc(mesh->nodes, sizeof *search.level);
    search.place = calloc(mesh->nodes, sizeof *search.place);
    int status = -1;
    if (search.best && search.other && search.level && search.place &&
        quad_graph_make(&graph, mesh) == 0) {
        try_levels(&search, mesh);
        search.envelope -= search.envelope / 50; /* An order of Sloan's algorithm is chosen only if
                                                    its envelope (number of stored matrix entries)
                                                    is 2 % smaller than the best so far: the rows of
                                                    the other orders have more uniform lengths and
                                                    are factored faster. */
        status = try_fronts(&search, mesh);
    }
    quad_graph_free(&graph);
    free(search.other);
    free(search.level);
    free(search.place);
    return status;
}
