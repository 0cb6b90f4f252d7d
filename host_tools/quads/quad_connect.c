/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Neighbours of elements, their common orientation, and the named sets of edges of a mesh
 * (quad_steps.h).
 */
#include "quad_side.h"
#include "quad_steps.h"

#include <stdlib.h>
#include <string.h>

void quad_topology_free(quad_topology *topology)
{
    free(topology->neighbour);
    topology->neighbour = NULL;
}

static int refuse_memory(const quad_origin *origin)
{
    return quad_fault_at(origin->file, 0, "the mesh does not fit into memory; use a coarser one");
}

/* ---- neighbours -------------------------------------------------------- */

static int refuse_branch(const quad_mesh *mesh, const quad_origin *origin, const quad_side *three)
{
    const size_t element = three[2].edge / 4;
    return quad_fault_at(origin->file, origin->element_at[element],
                         "elements %lld, %lld and %lld share the edge of nodes %lld and %lld; a "
                         "shell has two at most: mesh the sheets apart",
                         quad_element_label(mesh, three[0].edge / 4),
                         quad_element_label(mesh, three[1].edge / 4),
                         quad_element_label(mesh, element), quad_node_label(mesh, three->low),
                         quad_node_label(mesh, three->high));
}

static int pair_sides(const quad_mesh *mesh, const quad_origin *origin, const quad_side *list,
                      quad_topology *topology)
{
    const size_t count = 4 * mesh->elements;
    for (size_t i = 0; i < count; i++)
        topology->neighbour[i / 4][i % 4] = QUAD_FREE;
    for (size_t i = 0; i + 1 < count; i++) {
        if (!quad_side_is_same(&list[i], &list[i + 1]))
            continue;
        if (i + 2 < count && quad_side_is_same(&list[i], &list[i + 2]))
            return refuse_branch(mesh, origin, &list[i]);
        topology->neighbour[list[i].edge / 4][list[i].edge % 4] = list[i + 1].edge;
        topology->neighbour[list[i + 1].edge / 4][list[i + 1].edge % 4] = list[i].edge;
    }
    return 0;
}

/* ---- orientation ------------------------------------------------------- */

/*
 * Return whether two elements run along their common side in the same direction (the order of their
 * corners), so that their outer faces lie on opposite sides of the surface.
 */
static bool is_opposed(const quad_mesh *mesh, uint32_t edge, uint32_t other)
{
    return mesh->element[edge / 4][edge % 4] == mesh->element[other / 4][other % 4];
}

/*
 * State of an element while a common orientation spreads over the mesh: NOT_SEEN (not reached yet),
 * AS_IT_IS (orientation of the mesh file is kept), or TURNED (turned over).
 */
enum { NOT_SEEN, AS_IT_IS, TURNED };

/*
 * Spread a common orientation over the mesh: neighbours of an element that have not been reached
 * yet get its orientation and are added to the queue.
 *   queue  [elements] in/out  elements whose neighbours are to be visited; *count is their number
 * Returns 0, or -1 after writing an error message about the mesh file if the surface is one-sided.
 */
static int spread(const quad_mesh *mesh, const quad_origin *origin, const quad_topology *topology,
                  uint32_t element, unsigned char *state, uint32_t *queue, size_t *count)
{
    for (uint32_t side = 0; side < 4; side++) {
        const uint32_t other = topology->neighbour[element][side];
        if (other == QUAD_FREE)
            continue;
        const bool turned =
            (state[element] == TURNED) != is_opposed(mesh, 4 * element + side, other);
        const unsigned char wanted = turned ? TURNED : AS_IT_IS;
        if (state[other / 4] == NOT_SEEN) {
            state[other / 4] = wanted;
            queue[(*count)++] = other / 4;
        } else if (state[other / 4] != wanted) {
            return quad_fault_at(origin->file, origin->element_at[other / 4],
                                 "the surface has one side alone, as a Moebius strip: elements "
                                 "%lld and %lld cannot be oriented alike; cut it open there",
                                 quad_element_label(mesh, element),
                                 quad_element_label(mesh, other / 4));
        }
    }
    return 0;
}

static int refuse_parts(const quad_mesh *mesh, const quad_origin *origin,
                        const unsigned char *state, size_t reached)
{
    size_t element = 0;
    while (state[element] != NOT_SEEN)
        element++;
    return quad_fault_at(
        origin->file, origin->element_at[element],
        "the mesh falls apart: %zu elements are joined, %zu are not, element %lld "
        "among them; if the part between them is missing, give it a physical group "
        "(Gmsh saves no others); else join them (Coherence;) or leave them out",
        reached, mesh->elements - reached, quad_element_label(mesh, element));
}

/*
 * Turn over elements so that all have the orientation (side of the outer face) that most elements
 * have in the mesh file, or the opposite one if is_flipped is true.
 */
static void orient(quad_mesh *mesh, const unsigned char *state, bool is_flipped)
{
    size_t turned = 0;
    for (size_t element = 0; element < mesh->elements; element++)
        turned += state[element] == TURNED;
    const bool is_other = 2 * turned > mesh->elements;
    for (size_t element = 0; element < mesh->elements; element++)
        if (((state[element] == TURNED) != is_other) != is_flipped) {
            const uint32_t second = mesh->element[element][1];
            mesh->element[element][1] = mesh->element[element][3];
            mesh->element[element][3] = second;
        }
}

static int spread_all(quad_mesh *mesh, const quad_origin *origin, const quad_topology *topology,
                      unsigned char *state, uint32_t *queue, bool is_flipped)
{
    size_t count = 1;
    state[0] = AS_IT_IS;
    queue[0] = 0;
    for (size_t i = 0; i < count; i++)
        if (spread(mesh, origin, topology, queue[i], state, queue, &count) < 0)
            return -1;
    if (count < mesh->elements)
        return refuse_parts(mesh, origin, state, count);
    orient(mesh, state, is_flipped);
    return 0;
}

static int orient_all(quad_mesh *mesh, const quad_origin *origin, const quad_topology *topology,
                      bool is_flipped)
{
    unsigned char *state = calloc(mesh->elements, 1);
    uint32_t *queue = calloc(mesh->elements, sizeof *queue);
    const int status = state && queue ? spread_all(mesh, origin, topology, state, queue, is_flipped)
                                      : refuse_memory(origin);
    free(state);
    free(queue);
    return status;
}

/* ---- edge sets --------------------------------------------------------- */

static uint32_t find_index(const quad_mesh *mesh, int64_t label)
{
    for (size_t i = 0; i < mesh->nodes; i++)
        if (mesh->node_label[i] == label)
            return (uint32_t)i;
    return UINT32_MAX;
}

/*
 * Return the first side with two given nodes in a sorted list of sides, or NULL if there is none.
 */
static const quad_side *find_side(const quad_side *list, size_t count, uint32_t from, uint32_t to)
{
    const quad_side wanted = quad_side_between(from, to, 0);
    size_t low = 0, high = count;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (quad_side_compare(&list[middle], &wanted) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low < count && quad_side_is_same(&list[low], &wanted) ? &list[low] : NULL;
}

static int fill_edge_set(const quad_mesh *mesh, const quad_origin *origin, const quad_raw *raw,
                         const quad_raw_set *from, const quad_side *list, quad_set *to)
{
    if (!quad_set_begin(to, from->name, from->count))
        return refuse_memory(origin);
    for (size_t i = 0; i < from->count; i++) {
        const quad_raw_cell *cell = &raw->cell[from->item[i]];
        const quad_side *found =
            find_side(list, 4 * mesh->elements, find_index(mesh, cell->node[0]),
                      find_index(mesh, cell->node[1]));
        if (!found)
            return quad_fault_at(origin->file, cell->at,
                                 "line element %lld of set '%s' is no edge of a quadrilateral; "
                                 "leave the curve out of the set, or embed it in the surface",
                                 (long long)cell->label, from->name);
        to->index[to->count++] = found->edge;
    }
    quad_set_sort(to);
    return 0;
}

static int fill_edge_sets(quad_mesh *mesh, const quad_origin *origin, const quad_raw *raw,
                          const quad_side *list)
{
    mesh->edge_set = calloc(raw->sets + 1, sizeof *mesh->edge_set);
    if (!mesh->edge_set)
        return refuse_memory(origin);
    for (size_t i = 0; i < raw->sets; i++)
        if (raw->set[i].corners == 2 && fill_edge_set(mesh, origin, raw, &raw->set[i], list,
                                                      &mesh->edge_set[mesh->edge_sets++]) < 0)
            return -1;
    return 0;
}

int quad_connect(quad_mesh *mesh, const quad_origin *origin, const quad_raw *raw,
                 const quad_options *options, quad_topology *topology)
{
    quad_side *list = calloc(4 * mesh->elements, sizeof *list);
    int status = -1;
    topology->neighbour = calloc(mesh->elements, sizeof *topology->neighbour);
    if (!list || !topology->neighbour)
        status = refuse_memory(origin);
    else {
        quad_sides(mesh, list);
        status = pair_sides(mesh, origin, list, topology);
        if (status == 0)
            status = orient_all(mesh, origin, topology, options->is_flipped);
        quad_sides(mesh, list); /* The sides of all elements are listed again, because turning
                                   elements over (reversing their orientation) has changed the
                                   numbers of their sides. */
        if (status == 0)
            status = pair_sides(mesh, origin, list, topology);
        if (status == 0)
            status = fill_edge_sets(mesh, origin, raw, list);
    }
    free(list);
    return status;
}
