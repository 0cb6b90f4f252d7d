/* SPDX-License-Identifier: BSD-2-Clause */
/* Growing arrays for the unchecked contents of a mesh file (quad_raw.h). */
#include "quad_raw.h"

#include <stdlib.h>
#include <string.h>

void quad_raw_free(quad_raw *raw)
{
    for (size_t i = 0; i < raw->sets; i++) {
        free(raw->set[i].name);
        free(raw->set[i].item);
    }
    free(raw->node);
    free(raw->cell);
    free(raw->set);
    memset(raw, 0, sizeof *raw);
}

/*
 * Make room for one more item of `size` bytes in a growing array of nodes, cells or sets of a mesh
 * file. Returns 0, or -1 after writing an error message about the mesh file when memory runs out.
 */
static int make_room(void **items, size_t count, size_t *room, size_t size, const quad_file *file)
{
    if (count < *room)
        return 0;
    const size_t larger = *room ? 2 * *room : 64;
    void *bigger = realloc(*items, larger * size);
    if (!bigger)
        return quad_fault(file, "the mesh does not fit into memory; use a coarser one");
    *items = bigger;
    *room = larger;
    return 0;
}

int quad_raw_add_node(quad_raw *raw, const quad_file *file, const quad_raw_node *node)
{
    void *items = raw->node;
    const int status = make_room(&items, raw->nodes, &raw->node_room, sizeof *node, file);
    raw->node = items;
    if (status == 0)
        raw->node[raw->nodes++] = *node;
    return status;
}

int quad_raw_add_cell(quad_raw *raw, const quad_file *file, const quad_raw_cell *cell)
{
    void *items = raw->cell;
    const int status = make_room(&items, raw->cells, &raw->cell_room, sizeof *cell, file);
    raw->cell = items;
    if (status == 0)
        raw->cell[raw->cells++] = *cell;
    return status;
}

int quad_raw_add_item(quad_raw_set *set, const quad_file *file, int64_t item)
{
    void *items = set->item;
    const int status = make_room(&items, set->count, &set->room, sizeof item, file);
    set->item = items;
    if (status == 0)
        set->item[set->count++] = item;
    return status;
}

static char *copy_name(const char *name, size_t length)
{
    char *copy = malloc(length + 1);
    if (!copy)
        return NULL;
    memcpy(copy, name, length);
    copy[length] = 0;
    return copy;
}

int quad_raw_refuse_sets(const quad_file *file)
{
    return quad_fault(file, "the file has more than %d sets; leave out those that are not used",
                      (int)QUAD_RAW_SETS);
}

quad_raw_set *quad_raw_find_set(quad_raw *raw, const quad_file *file, const char *name,
                                size_t length, int corners)
{
    void *items = raw->set;
    for (size_t i = 0; i < raw->sets; i++)
        if (raw->set[i].corners == corners && strlen(raw->set[i].name) == length &&
            memcmp(raw->set[i].name, name, length) == 0)
            return &raw->set[i];
    if (raw->sets >= QUAD_RAW_SETS) {
        quad_raw_refuse_sets(file);
        return NULL;
    }
    const int status = make_room(&items, raw->sets, &raw->set_room, sizeof *raw->set, file);
    raw->set = items;
    if (status < 0)
        return NULL;
    const quad_raw_set fresh = {copy_name(name, length), corners, 0, 0, NULL};
    if (!fresh.name) {
        quad_fault(file, "the sets do not fit into memory");
        return NULL;
    }
    raw->set[raw->sets] = fresh;
    return &raw->set[raw->sets++];
}

int quad_raw_refuse_triangle(const quad_file *file, size_t at, int64_t label)
{
    return quad_fault_at(file, at,
                         "element %lld is a triangle; quadrilaterals are needed: in Gmsh set "
                         "Mesh.RecombineAll = 1; and Mesh.SubdivisionAlgorithm = 1;",
                         (long long)label);
}

int quad_raw_refuse_shape(const quad_file *file, size_t at, int64_t label, const char *shape)
{
    return quad_fault_at(file, at,
                         "element %lld is %s; a shell mesh has quadrilaterals of 4 nodes: in Gmsh "
                         "run gmsh -2 -order 1 and set Mesh.RecombineAll = 1;",
                         (long long)label, shape);
}
