/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Numbering of the nodes of a mesh by the algorithm of S. W. Sloan (Int. J. Numer. Meth. Engng. 23,
 * 1986, 239-251). The algorithm keeps the front small, which is the set of the nodes that have no
 * number yet but have a neighbour with a number (quad_graph.h).
 */
#include "quad_graph.h"

#include <stdbool.h>
#include <stdlib.h>

/*
 * State of a mesh node while the nodes are numbered one after the other.
 *   UNSEEN      no candidate for the next number yet
 *   NEAR_FRONT  candidate without a numbered neighbour
 *   IN_FRONT    candidate with a numbered neighbour
 *   NUMBERED    numbered
 */
typedef enum node_state { UNSEEN, NEAR_FRONT, IN_FRONT, NUMBERED } node_state;

typedef struct sloan {
    const quad_graph *graph;
    int64_t *priority; /* [nodes] priority of each mesh node in the numbering; of the candidates,
                          the node with the highest priority gets the next number */
    node_state *state; /* [nodes] state of each mesh node while the nodes are numbered */
    uint32_t *waiting; /* [nodes] candidates for the next number as a binary heap: the priority at
                          index i is at least that at the indices 2 i + 1 and 2 i + 2 */
    uint32_t *slot;    /* [nodes] position of a mesh node in the heap `waiting`, if the node is a
                          candidate for the next number */
    uint32_t count;    /* number of mesh nodes that are candidates for the next number */
    int64_t growth_weight; /* The front is the set of nodes without a number that have a numbered
                              neighbour. Numbering a node adds some nodes to the front: the priority
                              of the node is its distance from the end of the mesh, minus
                              growth_weight for each added node */
} sloan;

/* ---- waiting nodes ------------------------------------------------------ */

static int64_t priority_at(const sloan *run, uint32_t slot)
{
    return run->priority[run->waiting[slot]];
}

static void swap_slots(sloan *run, uint32_t first, uint32_t second)
{
    const uint32_t node = run->waiting[first];
    run->waiting[first] = run->waiting[second];
    run->waiting[second] = node;
    run->slot[run->waiting[first]] = first;
    run->slot[run->waiting[second]] = second;
}

/*
 * Move the node at an index of the binary heap of candidates for the next number towards the top
 * until its priority does not exceed that of the node above.
 */
static void lift(sloan *run, uint32_t slot)
{
    for (; slot > 0 && priority_at(run, slot) > priority_at(run, (slot - 1) / 2);
         slot = (slot - 1) / 2)
        swap_slots(run, slot, (slot - 1) / 2);
}

/*
 * Take the node with the highest priority from the binary heap of candidates for the next number.
 * Returns the index of this node in the mesh.
 */
static uint32_t take_next(sloan *run)
{
    const uint32_t node = run->waiting[0];
    swap_slots(run, 0, --run->count);
    for (uint32_t slot = 0, child = 1; child < run->count; child = 2 * slot + 1) {
        if (child + 1 < run->count && priority_at(run, child + 1) > priority_at(run, child))
            child++;
        if (priority_at(run, child) <= priority_at(run, slot))
            break;
        swap_slots(run, slot, child);
        slot = child;
    }
    return node;
}

static void add_waiting(sloan *run, uint32_t node)
{
    run->state[node] = NEAR_FRONT;
    run->slot[node] = run->count;
    run->waiting[run->count] = node;
    lift(run, run->count++);
}

/*
 * Raise the priority of a node, because numbering this node would now add one node less to the
 * front (nodes without a number that have a numbered neighbour).
 */
static void raise_priority(sloan *run, uint32_t node)
{
    run->priority[node] += run->growth_weight;
    if (run->state[node] == UNSEEN)
        add_waiting(run, node);
    else if (run->state[node] != NUMBERED)
        lift(run, run->slot[node]);
}

/* ---- front -------------------------------------------------------------- */

/*
 * Raise the priority of all neighbours of a node that has just come into the front (nodes without a
 * number that have a numbered neighbour).
 */
static void enter_front(sloan *run, uint32_t node)
{
    for (uint32_t k = run->graph->start[node]; k < run->graph->start[node + 1]; k++)
        raise_priority(run, run->graph->neighbour[k]);
}

/*
 * Give the next number to a candidate, and bring its neighbours without a number into the front
 * (nodes without a number that have a numbered neighbour).
 */
static void give_number(sloan *run, uint32_t node)
{
    const bool was_near = run->state[node] == NEAR_FRONT;
    run->state[node] = NUMBERED;
    if (was_near)
        enter_front(run, node);
    for (uint32_t k = run->graph->start[node]; k < run->graph->start[node + 1]; k++) {
        const uint32_t other = run->graph->neighbour[k];
        if (run->state[other] != NEAR_FRONT)
            continue;
        run->state[other] = IN_FRONT;
        raise_priority(run, other);
        enter_front(run, other);
    }
}

int quad_sloan(const quad_graph *graph, const uint32_t *distance, uint32_t first, int growth_weight,
               uint32_t *order)
{
    sloan run = {.graph = graph, .growth_weight = growth_weight};
    run.priority = calloc(graph->nodes, sizeof *run.priority);
    run.state = calloc(graph->nodes, sizeof *run.state);
    run.waiting = calloc(graph->nodes, sizeof *run.waiting);
    run.slot = calloc(graph->nodes, sizeof *run.slot);
    const bool has_memory = run.priority && run.state && run.waiting && run.slot;
    for (uint32_t node = 0; has_memory && node < graph->nodes; node++) {
        const int64_t neighbours = graph->start[node + 1] - graph->start[node];
        run.priority[node] = distance[node] - growth_weight * (neighbours + 1);
        run.state[node] = UNSEEN;
    }
    if (has_memory)
        add_waiting(&run, first);
    for (uint32_t number = 0; run.count > 0; number++) {
        order[number] = take_next(&run);
        give_number(&run, order[number]);
    }
    free(run.priority);
    free(run.state);
    free(run.waiting);
    free(run.slot);
    return has_memory ? 0 : -1;
}
