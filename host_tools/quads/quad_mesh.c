/* SPDX-License-Identifier: BSD-2-Clause */
/* Memory of a general mesh (quad_mesh.h). */
#include "quad_mesh.h"
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

void quad_mesh_free(quad_mesh *mesh)
{
    free(mesh->position);
    free(mesh->director);
    free(mesh->axis);
    free(mesh->constrained);
    free(mesh->order);
    free(mesh->node_label);
    free(mesh->element_label);
    free(mesh->element);
    free(mesh->area);
    free(mesh->element_region);
    free(mesh->region);
    free_sets(mesh->node_set, mesh->node_sets);
    free_sets(mesh->element_set, mesh->element_sets);
    free_sets(mesh->edge_set, mesh->edge_sets);
    memset(mesh, 0, sizeof *mesh);
}

const quad_set *quad_set_find(const quad_set *set, size_t count, const char *name)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(set[i].name, name) == 0)
            return &set[i];
    return NULL;
}
