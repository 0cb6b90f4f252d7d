/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Compact element types of a mesh: element types without the matrices that the firmware computes
 * from the nodes (compact_types.h).
 */
#include "compact_types.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/model/compact.h"

/*
 * Choose a coordinate along one axis in space that is subtracted from all node positions in the
 * tables of a device, so that the numbers need fewer digits. The result is 0 unless the mesh lies
 * far from the origin; then it is a round number near the mesh.
 */
static double find_origin(const mesh *mesh, int axis)
{
    double least = HUGE_VAL, most = -HUGE_VAL;
    for (int node = 0; node < mesh->nodes; node++) {
        least = fmin(least, mesh->point[node].position[axis]);
        most = fmax(most, mesh->point[node].position[axis]);
    }
    const double extent = most - least, nearest = fmin(fabs(least), fabs(most));
    if (least * most <= 0 || nearest < extent)
        return 0;
    int exponent;
    frexp(nearest, &exponent);
    const double step = ldexp(1, exponent - 2);
    return step * round((least + most) / 2 / step);
}

static void fill_nodes(const compact_types *compact, const mesh *mesh)
{
    double origin[3];
    for (int axis = 0; axis < 3; axis++)
        origin[axis] = find_origin(mesh, axis);
    for (int node = 0; node < mesh->nodes; node++) {
        for (int axis = 0; axis < 3; axis++)
            compact->node[node].position[axis] = mesh->point[node].position[axis] - origin[axis];
        memcpy(compact->node[node].triad, mesh->point[node].triad, sizeof compact->node->triad);
    }
}

/*
 * Fill the compact type of an element from its full type in the mesh. Four members of the full type
 * (s, t, g_mean, g_diff) are not copied; the numbers from which the library computes them are
 * added.
 */
static void fill_type(const compact_types *compact, const mesh *mesh, int element)
{
    const pzs_element_type *full = &mesh->type[mesh->element_type[element]];
    pzs_compact_type *type = &compact->type[mesh->element_type[element]];
    memcpy(type->d, full->d, sizeof type->d);
    memcpy(type->warp, full->warp, sizeof type->warp);
    memcpy(type->skew, full->skew, sizeof type->skew);
    type->thickness = full->thickness;
    memcpy(type->height_squared, full->height_squared, sizeof type->height_squared);
    type->middle = (mesh->laminate.z[0] + mesh->laminate.z[1]) / 2;
    for (int direction = 0; direction < 2; direction++)
        type->inverse_length[direction] = -full->s[0][direction][0][0];
    memcpy(type->corner, mesh->element[element], sizeof type->corner);
}

/*
 * Fill all compact element types. A device computes the numbers that a compact type leaves out from
 * the nodes at the corners of the first element of this type.
 */
static void fill_types(const compact_types *compact, const mesh *mesh)
{
    for (int element = mesh->elements - 1; element >= 0; element--)
        fill_type(compact, mesh, element);
}

/*
 * Return whether the element types that the library computes from the compact types and the nodes
 * (pzs_rebuild_type) are bitwise equal to the element types of the mesh.
 */
static bool is_exact(const compact_types *compact, const mesh *mesh)
{
    for (int k = 0; k < mesh->types; k++) {
        pzs_element_type type;
        pzs_rebuild_type(&compact->type[k], compact->node, &type);
        if (memcmp(&type, &mesh->type[k], sizeof type) != 0)
            return false;
    }
    return true;
}

/* Return whether compact element types and nodes take less memory than full element types. */
static bool is_smaller(const mesh *mesh)
{
    return (size_t)mesh->types * sizeof(pzs_compact_type) + (size_t)mesh->nodes * sizeof(pzs_node) <
           (size_t)mesh->types * sizeof(pzs_element_type);
}

void compact_types_make(compact_types *compact, const mesh *mesh)
{
    memset(compact, 0, sizeof *compact);
    if (!is_smaller(mesh))
        return;
    compact->type = calloc((size_t)mesh->types, sizeof *compact->type);
    compact->node = calloc((size_t)mesh->nodes, sizeof *compact->node);
    if (compact->type && compact->node) {
        fill_nodes(compact, mesh);
        fill_types(compact, mesh);
    }
    if (!compact->type || !compact->node || !is_exact(compact, mesh))
        compact_types_free(compact);
}

void compact_types_free(compact_types *compact)
{
    free(compact->type);
    free(compact->node);
    memset(compact, 0, sizeof *compact);
}
