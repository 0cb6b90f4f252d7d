/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Rotation of the triads (local axes) of nodes about the surface normal. A support with the key
 * `direction` rotates the axis e1 of its nodes to this direction, on a mesh between lines of
 * constant surface coordinates (mesh_turn_axes in mesh.h).
 */
#include <math.h>
#include <stdlib.h>
#include "../quads/vector.h"
#include "mesh.h"

/* Sine of the largest angle between two directions of supports that still count as equal. */
static const double nearly = 1e-6;

bool mesh_depends_on_axes(const scene_support *support)
{
    const unsigned along_1 = 1u << 0 | 1u << 3;
    return ((support->fix ^ support->fix >> 1) & along_1) != 0;
}

/*
 * Rotate the triad (local axes) of a node so that its first axis is the projection of a support's
 * direction. Returns 0, or -1 with error filled if the direction is normal to the surface.
 */
static int turn_node(mesh *mesh, const scene_support *support, int node, char *error)
{
    surface_point *point = &mesh->point[node];
    const double along = vector_dot(support->direction, point->triad[2]);
    double axis[3];
    for (int i = 0; i < 3; i++)
        axis[i] = support->direction[i] - along * point->triad[2][i];
    if (!(vector_normalise(axis) > 0.01))
        return scene_fault(support->at, error,
                           "the direction of this support is normal to the surface at %s; choose "
                           "one in the surface, or fix u3",
                           mesh_node_text(mesh, node).text);
    for (int i = 0; i < 3; i++)
        point->triad[0][i] = axis[i];
    vector_cross(point->triad[2], point->triad[0], point->triad[1]);
    return 0;
}

/*
 * Refuse a support that depends on the triad (local axes) of a node which another support has
 * rotated to a different direction. Returns 0, or -1 with error filled.
 */
static int check_node(const mesh *mesh, const scene_support *support, int node,
                      const unsigned char *turned, char *error)
{
    const surface_point *point = &mesh->point[node];
    double across[3];
    const bool has_direction =
        vector_length(support->direction) > 0 && !(support->fix & FIX_OBLIQUE);
    vector_cross(support->direction, point->triad[2], across);
    const double length = vector_length(across);
    const bool is_equal =
        has_direction && fabs(vector_dot(across, point->triad[0])) < nearly * length;
    if (!turned[node] || !mesh_depends_on_axes(support) || is_equal)
        return 0;
    return scene_fault(support->at, error,
                       "at %s another support has turned u1 and u2, along which this one acts; "
                       "give both the same direction, or leave the node out of one place",
                       mesh_node_text(mesh, node).text);
}

/*
 * Rotate the triads (local axes) of the nodes of all supports with the key `direction`, except
 * oblique ones: axis e1 becomes this direction, projected on the surface.
 *   turned [nodes] in/out  1 for the nodes whose triads were rotated
 *   node   [nodes] out     work array
 * Returns 0, or -1 with error filled.
 */
static int turn_all(mesh *mesh, unsigned char *turned, int *node, char *error)
{
    for (int k = 0; k < mesh->scene->supports; k++) {
        const scene_support *support = &mesh->scene->support[k];
        if (vector_length(support->direction) <= 0 || support->fix & FIX_OBLIQUE)
            continue;
        const int count = mesh_select(mesh, &support->where, node);
        for (int i = 0; i < count; i++) {
            if (turn_node(mesh, support, node[i], error) < 0)
                return -1;
            turned[node[i]] = 1;
        }
    }
    return 0;
}

static int check_all(const mesh *mesh, const unsigned char *turned, int *node, char *error)
{
    for (int k = 0; k < mesh->scene->supports; k++) {
        const scene_support *support = &mesh->scene->support[k];
        const int count = mesh_select(mesh, &support->where, node);
        for (int i = 0; i < count; i++)
            if (check_node(mesh, support, node[i], turned, error) < 0)
                return -1;
    }
    return 0;
}

/*
 * Refuse distributed loads along the tangential displacements u1 or u2 on nodes with rotated triads
 * (local axes), where the direction of the load would jump. Returns 0, or -1 with error filled.
 */
static int check_loads(const mesh *mesh, const unsigned char *turned, char *error)
{
    const scene *scene = mesh->scene;
    bool any = false;
    for (int node = 0; node < mesh->nodes; node++)
        any |= turned[node] != 0;
    for (int k = 0; k < scene->loads && any; k++)
        if ((scene->load[k].type == LOAD_FACE || scene->load[k].type == LOAD_LINE) &&
            scene->load[k].component < COMPONENT_U3)
            return scene_fault(scene->load[k].at, error,
                               "a support with a direction turns u1 and u2 at its nodes; give "
                               "this load along x, y or z");
    return 0;
}

int mesh_turn_axes(mesh *mesh, char *error)
{
    unsigned char *turned = calloc((size_t)mesh->nodes, 1);
    int *node = calloc((size_t)mesh->nodes, sizeof *node);
    int status = -1;
    if (!turned || !node)
        scene_fault(mesh->scene->line[0].at, error,
                    "%d nodes do not fit into memory; use fewer elements", mesh->nodes);
    else if (turn_all(mesh, turned, node, error) == 0 && check_all(mesh, turned, node, error) == 0)
        status = check_loads(mesh, turned, error);
    free(turned);
    free(node);
    return status;
}
