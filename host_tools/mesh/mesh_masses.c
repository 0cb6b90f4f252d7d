/* SPDX-License-Identifier: BSD-2-Clause */
/* Concentrated masses of a scene as points in elements of a mesh (mesh.h). */
#include <stdlib.h>
#include <string.h>
#include "mesh.h"
#include "mesh_spot.h"

/* A mesh to which the masses of the scene are being added, the item of the scene's list `masses`
 * that is read now, and work arrays. */
typedef struct mass_list {
    mesh *mesh;
    const scene_mass *item;
    char *error;
    int *element;  /* [nodes] an element that has the node as a corner */
    int *node;     /* [nodes] nodes of an edge, region or set of the mesh */
    double *share; /* [nodes] length or area that belongs to each node */
} mass_list;

/* Return whether the corners of an element are the four nodes of a mesh point, in their order. */
static bool has_corners(const mesh *mesh, int element, const mesh_spot *spot)
{
    bool same = true;
    for (int corner = 0; corner < 4; corner++)
        same = same && mesh->element[element][corner] == spot->node[corner];
    return same;
}

/* Return the element of a mesh point. */
static int element_of(const mass_list *list, const mesh_spot *spot)
{
    int element = list->element[spot->node[0]];
    if (spot->count == 1 || has_corners(list->mesh, element, spot))
        return element;
    for (element = 0; element < list->mesh->elements - 1; element++)
        if (has_corners(list->mesh, element, spot))
            break;
    return element;
}

/* Append to the mesh a concentrated mass at a mesh point: its mass and its moment of inertia are
 * `size` times the values of the present item of the scene's list `masses`. */
static void append(const mass_list *list, const mesh_spot *spot, double size)
{
    mesh *mesh = list->mesh;
    mesh_mass *mass = &mesh->mass[mesh->masses++];
    mass->element = element_of(list, spot);
    mass->mass = size * list->item->mass;
    mass->inertia = size * list->item->inertia;
    mass->face = list->item->face;
    for (int corner = 0; corner < 4; corner++)
        for (int i = 0; i < spot->count; i++)
            if (mesh->element[mass->element][corner] == spot->node[i])
                mass->weight[corner] = spot->weight[i];
}

/* Make room for `count` more masses. Returns 0, or -1 with error filled. */
static int grow(const mass_list *list, int count)
{
    mesh *mesh = list->mesh;
    const size_t sum = (size_t)mesh->masses + (size_t)count;
    mesh_mass *mass = realloc(mesh->mass, (sum + 1) * sizeof *mass);
    if (!mass)
        return scene_fault(list->item->at, list->error, "the masses do not fit into memory");
    memset(mass + mesh->masses, 0, ((size_t)count + 1) * sizeof *mass);
    mesh->mass = mass;
    return 0;
}

static int append_points(const mass_list *list)
{
    const scene_mass *item = list->item;
    for (int k = 0; k < item->points; k++) {
        mesh_spot spot;
        if (mesh_spot_find(list->mesh, item->point[k], &spot) < 0)
            return mesh_spot_refuse(item->at, k, item->point[k], list->error);
        append(list, &spot, 1);
    }
    return 0;
}

/*
 * Compute the length of edge, or the area, that belongs to each node of an edge, region or set of
 * the mesh. Returns 0, or -1 with error filled.
 */
static int find_shares(const mass_list *list)
{
    const scene_where *where = &list->item->where;
    memset(list->share, 0, (size_t)list->mesh->nodes * sizeof *list->share);
    if (list->item->per == PER_AREA)
        mesh_area_shares(list->mesh, where, list->share);
    else if (mesh_length_shares(list->mesh, where, list->share) < 0)
        return scene_fault(where->at, list->error,
                           "'per: length' needs an edge, or an edge set of the mesh file");
    double sum = 0;
    for (int node = 0; node < list->mesh->nodes; node++)
        sum += list->share[node];
    if (sum > 0)
        return 0;
    return scene_fault(where->at, list->error, "this place has no %s; choose another",
                       list->item->per == PER_AREA ? "area: no element has all its nodes in it"
                                                   : "length");
}

static int append_nodes(const mass_list *list, int count)
{
    if (list->item->per != PER_POINT && find_shares(list) < 0)
        return -1;
    for (int k = 0; k < count; k++) {
        const mesh_spot spot = mesh_spot_of_node(list->node[k]);
        const double size = list->item->per == PER_POINT ? 1 : list->share[list->node[k]];
        if (size > 0)
            append(list, &spot, size);
    }
    return 0;
}

static int append_item(mass_list *list, const scene_mass *item)
{
    list->item = item;
    const int count =
        item->points > 0 ? item->points : mesh_select(list->mesh, &item->where, list->node);
    if (grow(list, count) < 0)
        return -1;
    return item->points > 0 ? append_points(list) : append_nodes(list, count);
}

static int append_all(mass_list *list)
{
    const mesh *mesh = list->mesh;
    for (int element = 0; element < mesh->elements; element++)
        for (int corner = 0; corner < 4; corner++)
            list->element[mesh->element[element][corner]] = element;
    for (int k = 0; k < mesh->scene->masses; k++)
        if (append_item(list, &mesh->scene->mass[k]) < 0)
            return -1;
    return 0;
}

int mesh_masses_build(mesh *mesh, char *error)
{
    const size_t nodes = (size_t)mesh->nodes;
    if (mesh->scene->masses == 0)
        return 0;
    mass_list list = {.mesh = mesh,
                      .error = error,
                      .element = calloc(nodes, sizeof *list.element),
                      .node = calloc(nodes, sizeof *list.node),
                      .share = calloc(nodes, sizeof *list.share)};
    int status = -1;
    if (list.element && list.node && list.share)
        status = append_all(&list);
    else
        scene_fault(mesh->scene->mass[0].at, error, "the masses do not fit into memory");
    free(list.element);
    free(list.node);
    free(list.share);
    return status;
}
