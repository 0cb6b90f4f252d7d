/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Memory and sets of a mesh of quadrilaterals in any arrangement, and the axes of its nodes
 * (quad_mesh.h).
 */
#include "quad_mesh.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void free_sets(quad_set *set, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        free(set[i].name);
        free(set[i].index);
    }
    free(set);
}

int quad_mesh_allocate(quad_mesh *mesh)
{
    mesh->regions = 1;
    mesh->position = calloc(mesh->nodes, sizeof *mesh->position);
    mesh->director = calloc(mesh->nodes, sizeof *mesh->director);
    mesh->axis = calloc(mesh->nodes, sizeof *mesh->axis);
    mesh->node_label = calloc(mesh->nodes, sizeof *mesh->node_label);
    mesh->element = calloc(mesh->elements, sizeof *mesh->element);
    mesh->element_label = calloc(mesh->elements, sizeof *mesh->element_label);
    mesh->region = calloc(1, sizeof *mesh->region);
    const bool has_nodes = mesh->position && mesh->director && mesh->axis && mesh->node_label;
    return has_nodes && mesh->element && mesh->element_label && mesh->region ? 0 : -1;
}

void quad_mesh_free(quad_mesh *mesh)
{
    free(mesh->position);
    free(mesh->director);
    free(mesh->axis);
    free(mesh->constrained);
    free(mesh->holder);
    free(mesh->order);
    free(mesh->node_label);
    free(mesh->element_label);
    free(mesh->element);
    free(mesh->area);
    free(mesh->element_region);
    free(mesh->region);
    free(mesh->material_axis);
    free_sets(mesh->node_set, mesh->node_sets);
    free_sets(mesh->element_set, mesh->element_sets);
    free_sets(mesh->edge_set, mesh->edge_sets);
    memset(mesh, 0, sizeof *mesh);
}

static int ascending(const void *left, const void *right)
{
    const uint32_t *first = left, *second = right;
    return (*first > *second) - (*first < *second);
}

bool quad_set_begin(quad_set *set, const char *name, size_t count)
{
    set->name = malloc(strlen(name) + 1);
    set->index = calloc(count + 1, sizeof *set->index);
    if (!set->name || !set->index)
        return false;
    strcpy(set->name, name);
    return true;
}

void quad_set_sort(quad_set *set)
{
    size_t kept = 0;
    qsort(set->index, set->count, sizeof *set->index, ascending);
    for (size_t i = 0; i < set->count; i++)
        if (i == 0 || set->index[i] != set->index[i - 1])
            set->index[kept++] = set->index[i];
    set->count = kept;
}

bool quad_set_has(const quad_set *set, uint32_t index)
{
    size_t low = 0, high = set->count;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (set->index[middle] < index)
            low = middle + 1;
        else
            high = middle;
    }
    return low < set->count && set->index[low] == index;
}

const quad_set *quad_set_find(const quad_set *set, size_t count, const char *name)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(set[i].name, name) == 0)
            return &set[i];
    return NULL;
}

int quad_common_axis(const quad_mesh *mesh)
{
    const double most_aligned = 0.95;
    double largest[3] = {0, 0, 0};
    int best = 0;
    for (size_t node = 0; node < mesh->nodes; node++)
        for (int i = 0; i < 3; i++)
            largest[i] = fmax(largest[i], fabs(mesh->director[node][i]));
    for (int i = 1; i < 3; i++)
        if (largest[i] < largest[best] - 1e-9)
            best = i;
    return largest[best] < most_aligned ? best : -1;
}

void quad_default_axis(const double director[3], int common, double axis[3])
{
    int least = common < 0 ? 0 : common;
    for (int i = 1; i < 3 && common < 0; i++)
        if (fabs(director[i]) < fabs(director[least]) - 1e-9)
            least = i;
    double square = 0;
    for (int i = 0; i < 3; i++) {
        axis[i] = (i == least) - director[least] * director[i];
        square += axis[i] * axis[i];
    }
    for (int i = 0; i < 3; i++)
        axis[i] /= sqrt(square);
}
