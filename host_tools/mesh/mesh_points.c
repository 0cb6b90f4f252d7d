/* SPDX-License-Identifier: BSD-2-Clause */
/* Mesh of points without elements, for a measured influence matrix (mesh.h). */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "mesh.h"

static void fill(mesh *mesh)
{
    const scene_influence *influence = &mesh->scene->influence;
    for (int n = 0; n < mesh->nodes; n++) {
        mesh->theta[n][0] = mesh->theta[n][1] = (double)NAN;
        mesh->node_dof[n] = (uint16_t)n;
        for (int a = 0; a < 3; a++) {
            mesh->point[n].x[a] = influence->place ? influence->place[n][a] : 0;
            mesh->point[n].e[a][(a + 2) % 3] = 1; /* the one dof, along e1, is along z */
        }
        if (!influence->place)
            mesh->point[n].x[0] = n;
    }
}

int mesh_points(mesh *mesh, const scene *scene, char *error)
{
    const size_t nodes = (size_t)scene->influence.outputs;
    memset(mesh, 0, sizeof *mesh);
    mesh->scene = scene;
    mesh->nodes = mesh->free_dof = (int)nodes;
    mesh->dof_per_node = 1;
    mesh->point = calloc(nodes + 1, sizeof *mesh->point);
    mesh->theta = calloc(nodes + 1, sizeof *mesh->theta);
    mesh->node_dof = calloc(nodes + 1, sizeof *mesh->node_dof);
    if (!mesh->point || !mesh->theta || !mesh->node_dof) {
        mesh_free(mesh);
        return scene_fault(scene, scene->influence.at, error, "%zu outputs do not fit into memory",
                           nodes);
    }
    fill(mesh);
    return 0;
}
