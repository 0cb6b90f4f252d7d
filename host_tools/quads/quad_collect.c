/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Replacement of the numbers in a mesh file by indices of nodes and elements, and copies of its
 * sets (quad_steps.h).
 */
#include "quad_steps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Largest absolute coordinate of a node; its fourth power is still a finite number. */
static const double largest_place = 1e60;

/* Number of a node or element in the mesh file, with the index of that node or element. */
typedef struct numbered {
    int64_t label;
    size_t index;
} numbered;

static int by_label(const void *left, const void *right)
{
    const numbered *first = left, *second = right;
    if (first->label != second->label)
        return first->label > second->label ? 1 : -1;
    return (first->index > second->index) - (first->index < second->index);
}

/*
 * Value that stands in place of an index in the mesh for items of the mesh file that do not become
 * part of the mesh: nodes that no quadrilateral uses, and cells that are points or edges.
 */
static const uint32_t unused = UINT32_MAX;
typedef struct collection {
    quad_mesh *mesh;
    quad_origin *origin;
    const quad_raw *raw;
    const quad_file *file;
    numbered *node; /* numbers and indices of all nodes of the mesh file, in ascending order of the
                       numbers */
    uint32_t *node_of, *element_of; /* index in the mesh of each node and each cell (point, edge or
                                       quadrilateral) of the mesh file; the value `unused` for those
                                       that the mesh does not contain */
} collection;

static int refuse_memory(const collection *collection)
{
    return quad_fault_at(collection->file, 0,
                         "the mesh does not fit into memory; use a coarser one");
}

/* ---- nodes ------------------------------------------------------------- */

static int sort_nodes(collection *collection)
{
    const quad_raw *raw = collection->raw;
    for (size_t i = 0; i < raw->nodes; i++) {
        collection->node[i] = (numbered){raw->node[i].label, i};
        collection->node_of[i] = unused;
    }
    qsort(collection->node, raw->nodes, sizeof *collection->node, by_label);
    for (size_t i = 1; i < raw->nodes; i++)
        if (collection->node[i].label == collection->node[i - 1].label)
            return quad_fault_at(collection->file, raw->node[collection->node[i].index].at,
                                 "node %lld is defined twice; export the mesh again, or renumber "
                                 "its parts",
                                 (long long)collection->node[i].label);
    return 0;
}

/*
 * Return the index of the node with a given number among the nodes of the file, or the value
 * `unused` if the file does not define it.
 */
static size_t find_node(const collection *collection, int64_t label)
{
    size_t low = 0, high = collection->raw->nodes;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (collection->node[middle].label < label)
            low = middle + 1;
        else
            high = middle;
    }
    const bool found = low < collection->raw->nodes && collection->node[low].label == label;
    return found ? collection->node[low].index : (size_t)unused;
}

/*
 * Mark the nodes of one cell of the mesh file (point, edge or quadrilateral) as used, if it is a
 * quadrilateral. Returns 0, or -1 after writing an error message about the mesh file if it has an
 * undefined node or a node twice.
 */
static int mark_cell(collection *collection, const quad_raw_cell *cell)
{
    for (int k = 0; k < cell->corners; k++) {
        const size_t node = find_node(collection, cell->node[k]);
        if (node == unused)
            return quad_fault_at(collection->file, cell->at,
                                 "element %lld has node %lld, which the file does not define; "
                                 "export the nodes too",
                                 (long long)cell->label, (long long)cell->node[k]);
        for (int j = 0; j < k && cell->corners > 1; j++)
            if (cell->node[j] == cell->node[k])
                return quad_fault_at(collection->file, cell->at,
                                     "element %lld has node %lld twice; a collapsed quadrilateral "
                                     "is a triangle: mesh with Mesh.SubdivisionAlgorithm = 1;",
                                     (long long)cell->label, (long long)cell->node[k]);
        if (cell->corners == 4)
            collection->node_of[node] = 0;
    }
    return 0;
}

static int check_place(const collection *collection, const quad_raw_node *node)
{
    for (int i = 0; i < 3; i++)
        if (!(fabs(node->x[i]) <= largest_place))
            return quad_fault_at(collection->file, node->at,
                                 "node %lld has the coordinate %g; finite coordinates are needed",
                                 (long long)node->label, node->x[i]);
    return 0;
}

/*
 * Number the nodes that quadrilaterals use, in the order of the mesh file, and copy their
 * positions. Returns 0, or -1 after writing an error message about the mesh file.
 */
static int copy_nodes(collection *collection, const quad_options *options)
{
    quad_mesh *mesh = collection->mesh;
    for (size_t i = 0; i < collection->raw->nodes; i++)
        mesh->nodes += collection->node_of[i] != unused;
    if (mesh->nodes > options->most_nodes)
        return quad_fault_at(collection->file, 0,
                             "the mesh has %zu nodes; at most %zu are allowed, use "
                             "larger elements",
                             mesh->nodes, options->most_nodes);
    mesh->position = calloc(mesh->nodes, sizeof *mesh->position);
    mesh->node_label = calloc(mesh->nodes, sizeof *mesh->node_label);
    if (!mesh->position || !mesh->node_label)
        return refuse_memory(collection);
    uint32_t next = 0;
    for (size_t i = 0; i < collection->raw->nodes; i++) {
        const quad_raw_node *node = &collection->raw->node[i];
        if (collection->node_of[i] == unused)
            continue;
        if (check_place(collection, node) < 0)
            return -1;
        for (int k = 0; k < 3; k++)
            mesh->position[next][k] = options->unit * node->x[k];
        mesh->node_label[next] = node->label;
        collection->node_of[i] = next++;
    }
    return 0;
}

/* List the nodes of the mesh file that belong to no quadrilateral. */
static void find_loose(const collection *collection, quad_loose *loose)
{
    for (size_t i = 0; i < collection->raw->nodes; i++) {
        if (collection->node_of[collection->node[i].index] != unused)
            continue;
        if (loose->count < QUAD_LOOSE)
            loose->label[loose->count] = collection->node[i].label;
        loose->count++;
    }
}

/* ---- elements ---------------------------------------------------------- */

/*
 * Sort key by which repeated elements of a mesh file are found: four node numbers in ascending
 * order, and the index of the element among the cells of the file.
 */
typedef struct corners {
    int64_t node[4];
    size_t cell;
} corners;

static int by_corners(const void *left, const void *right)
{
    const corners *first = left, *second = right;
    for (int k = 0; k < 4; k++)
        if (first->node[k] != second->node[k])
            return first->node[k] > second->node[k] ? 1 : -1;
    return (first->cell > second->cell) - (first->cell < second->cell);
}

static int by_number(const void *left, const void *right)
{
    const int64_t *first = left, *second = right;
    return (*first > *second) - (*first < *second);
}

/*
 * Find quadrilaterals that the mesh file lists repeatedly, as the MSH format 2.2 does for each
 * physical group of an element.
 *   first [cells] out  index of the first copy of each cell (point, edge or quadrilateral)
 * Returns 0, or -1 after writing an error message about the mesh file if two different elements
 * have the same nodes.
 */
static int find_copies(const collection *collection, corners *key, size_t *first)
{
    size_t count = 0;
    for (size_t i = 0; i < collection->raw->cells; i++) {
        if (collection->raw->cell[i].corners != 4)
            continue;
        memcpy(key[count].node, collection->raw->cell[i].node, sizeof key->node);
        qsort(key[count].node, 4, sizeof *key->node, by_number);
        key[count++].cell = i;
    }
    qsort(key, count, sizeof *key, by_corners);
    for (size_t i = 0; i < count; i++) {
        const bool is_copy = i > 0 && memcmp(key[i].node, key[i - 1].node, sizeof key->node) == 0;
        first[key[i].cell] = is_copy ? first[key[i - 1].cell] : key[i].cell;
        const quad_raw_cell *own = &collection->raw->cell[key[i].cell];
        const quad_raw_cell *other = &collection->raw->cell[first[key[i].cell]];
        if (is_copy && (own->group < 0 || own->group == other->group))
            return quad_fault_at(collection->file, own->at,
                                 "elements %lld and %lld have the same nodes; remove one",
                                 (long long)other->label, (long long)own->label);
    }
    return 0;
}

static void copy_elements(collection *collection, const size_t *first)
{
    quad_mesh *mesh = collection->mesh;
    for (size_t i = 0; i < collection->raw->cells; i++) {
        const quad_raw_cell *cell = &collection->raw->cell[i];
        collection->element_of[i] = unused;
        if (cell->corners != 4)
            continue;
        if (first[i] != i) {
            collection->element_of[i] = collection->element_of[first[i]];
            continue;
        }
        for (int k = 0; k < 4; k++)
            mesh->element[mesh->elements][k] =
                collection->node_of[find_node(collection, cell->node[k])];
        mesh->element_label[mesh->elements] = cell->label;
        collection->origin->element_at[mesh->elements] = cell->at;
        collection->element_of[i] = (uint32_t)mesh->elements++;
    }
}

/*
 * Allocate the elements of the mesh and copy the quadrilaterals of the file.
 *   key    [cells + 1] out  work array
 *   first  [cells + 1] out  work array
 * Returns 0, or -1 after writing an error message about the mesh file.
 */
static int collect_elements(collection *collection, corners *key, size_t *first)
{
    quad_mesh *mesh = collection->mesh;
    const size_t cells = collection->raw->cells;
    mesh->element = calloc(cells + 1, sizeof *mesh->element);
    mesh->element_label = calloc(cells + 1, sizeof *mesh->element_label);
    collection->origin->element_at = calloc(cells + 1, sizeof *collection->origin->element_at);
    if (!key || !first || !mesh->element || !mesh->element_label || !collection->origin->element_at)
        return refuse_memory(collection);
    if (find_copies(collection, key, first) < 0)
        return -1;
    copy_elements(collection, first);
    return 0;
}

/*
 * Check that no two elements have the same number in the mesh file. Returns 0, or -1 after writing
 * an error message about the mesh file.
 */
static int check_labels(const collection *collection, numbered *entry)
{
    if (!entry)
        return refuse_memory(collection);
    for (size_t i = 0; i < collection->mesh->elements; i++)
        entry[i] = (numbered){collection->mesh->element_label[i], i};
    qsort(entry, collection->mesh->elements, sizeof *entry, by_label);
    for (size_t i = 1; i < collection->mesh->elements; i++)
        if (entry[i].label == entry[i - 1].label)
            return quad_fault_at(collection->file, collection->origin->element_at[entry[i].index],
                                 "element %lld is defined twice with different nodes; renumber it",
                                 (long long)entry[i].label);
    return 0;
}

/* ---- sets -------------------------------------------------------------- */

static uint32_t index_of_node(const collection *collection, int64_t label)
{
    const size_t node = find_node(collection, label);
    return node == unused ? unused : collection->node_of[node];
}

/* Copy a set of elements. Returns 0, or -1 after writing an error message about the mesh file. */
static int copy_element_set(const collection *collection, const quad_raw_set *from, quad_set *to)
{
    if (!quad_set_begin(to, from->name, from->count))
        return refuse_memory(collection);
    for (size_t i = 0; i < from->count; i++) {
        const uint32_t index = collection->element_of[from->item[i]];
        if (index != unused)
            to->index[to->count++] = index;
    }
    quad_set_sort(to);
    return 0;
}

/*
 * Store the count and the smallest numbers of nodes that belong to no element.
 *   label [count] in/out  numbers of these nodes in the mesh file, in any order and with
 *       repetition; out: ascending
 */
static void list_loose(int64_t *label, size_t count, quad_loose *loose)
{
    qsort(label, count, sizeof *label, by_number);
    for (size_t i = 0; i < count; i++) {
        if (i > 0 && label[i] == label[i - 1])
            continue;
        if (loose->count < QUAD_LOOSE)
            loose->label[loose->count] = label[i];
        loose->count++;
    }
}

/*
 * Copy a set of nodes from the mesh file. Its nodes that belong to no element do not enter the
 * mesh; their numbers are listed in to->loose.
 *   loose [from->count + 1] out  work array
 */
static void copy_nodes_of_set(const collection *collection, const quad_raw_set *from, quad_set *to,
                              int64_t *loose)
{
    size_t count = 0;
    for (size_t i = 0; i < from->count; i++) {
        const uint32_t index = index_of_node(collection, from->item[i]);
        if (index == unused)
            loose[count++] = from->item[i];
        else
            to->index[to->count++] = index;
    }
    quad_set_sort(to);
    list_loose(loose, count, &to->loose);
}

/*
 * Copy a set of nodes from the mesh file, with work memory of its size. Returns 0, or -1 after
 * writing an error message about the mesh file.
 */
static int copy_node_set(const collection *collection, const quad_raw_set *from, quad_set *to)
{
    int64_t *loose = calloc(from->count + 1, sizeof *loose);
    const bool has_memory = loose && quad_set_begin(to, from->name, from->count);
    if (has_memory)
        copy_nodes_of_set(collection, from, to, loose);
    free(loose);
    return has_memory ? 0 : refuse_memory(collection);
}

static int copy_sets(collection *collection)
{
    quad_mesh *mesh = collection->mesh;
    mesh->node_set = calloc(collection->raw->sets + 1, sizeof *mesh->node_set);
    mesh->element_set = calloc(collection->raw->sets + 1, sizeof *mesh->element_set);
    if (!mesh->node_set || !mesh->element_set)
        return refuse_memory(collection);
    for (size_t i = 0; i < collection->raw->sets; i++) {
        const quad_raw_set *from = &collection->raw->set[i];
        int status = 0;
        if (from->corners == 0)
            status = copy_node_set(collection, from, &mesh->node_set[mesh->node_sets++]);
        else if (from->corners == 4)
            status = copy_element_set(collection, from, &mesh->element_set[mesh->element_sets++]);
        if (status < 0)
            return -1;
    }
    return 0;
}

/* ---- the whole --------------------------------------------------------- */

static int collect_all(collection *collection, const quad_options *options)
{
    if (!collection->node || !collection->node_of || !collection->element_of)
        return refuse_memory(collection);
    if (sort_nodes(collection) < 0)
        return -1;
    for (size_t i = 0; i < collection->raw->cells; i++)
        if (mark_cell(collection, &collection->raw->cell[i]) < 0)
            return -1;
    if (copy_nodes(collection, options) < 0)
        return -1;
    if (collection->mesh->nodes == 0)
        return quad_fault_at(collection->file, 0,
                             "the file has no quadrilaterals; in Gmsh set "
                             "Mesh.RecombineAll = 1; and save the surfaces");
    corners *key = calloc(collection->raw->cells + 1, sizeof *key);
    size_t *first = calloc(collection->raw->cells + 1, sizeof *first);
    int status = collect_elements(collection, key, first);
    free(key);
    free(first);
    numbered *entry = status == 0 ? calloc(collection->mesh->elements + 1, sizeof *entry) : NULL;
    if (status == 0)
        status = check_labels(collection, entry);
    free(entry);
    return status == 0 ? copy_sets(collection) : -1;
}

int quad_collect(quad_mesh *mesh, quad_origin *origin, const quad_raw *raw,
                 const quad_options *options, quad_warnings *warnings)
{
    collection collection = {.mesh = mesh, .origin = origin, .raw = raw, .file = origin->file};
    collection.node = calloc(raw->nodes + 1, sizeof *collection.node);
    collection.node_of = calloc(raw->nodes + 1, sizeof *collection.node_of);
    collection.element_of = calloc(raw->cells + 1, sizeof *collection.element_of);
    const int status = collect_all(&collection, options);
    if (status == 0)
        find_loose(&collection, &warnings->loose);
    free(collection.node);
    free(collection.node_of);
    free(collection.element_of);
    return status;
}
