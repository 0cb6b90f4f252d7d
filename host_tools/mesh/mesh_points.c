/* SPDX-License-Identifier: BSD-2-Clause */
/* Mesh of points without elements, for a measured influence matrix (mesh.h). */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "mesh.h"

static void fill(mesh *mesh)
{
    const scene_influence *influence = &mesh->scene->influence;
    for (int node = 0; node < mesh->nodes; node++) {
        mesh->theta[node][0] = mesh->theta[node][1] = (double)NAN;
        mesh->node_dof[node] = (uint16_t)node;
        for (int axis = 0; axis < 3; axis++) {
            mesh->point[node].position[axis] = influence->place ? influence->place[node][axis] : 0;
            /*
             * In a mesh of points for a measured influence matrix, the only degree of freedom of a
             * node acts along the local axis e1, which is set to the z axis.
             */
            mesh->point[node].triad[axis][(axis + 2) % 3] = 1;
        }
        if (!influence->place)
            mesh->point[node].position[0] = node;
    }
}

int mesh_points(mesh *mesh, const scene *scene, char *error)
{
    const size_t nodes = (size_t)scene->influence.outputs;
    mesh_begin(mesh, scene);
    mesh->nodes = mesh->free_dof = (int)nodes;
    mesh->dof_per_node = 1;
    mesh->point = calloc(nodes + 1, sizeof *mesh->point);
    mesh->theta = calloc(nodes + 1, sizeof *mesh->theta);
    mesh->node_dof = calloc(nodes + 1, sizeof *mesh->node_dof);
    if (!mesh->point || !mesh->theta || !mesh->node_dof) {
        mesh_free(mesh);
        return scene_fault(scene->influence.at, error, "%zu outputs do not fit into memory", nodes);
    }
    fill(mesh);
    return 0;
}
