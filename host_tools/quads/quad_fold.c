/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Elements that are folded: their corners lie in a wrong order, so that two sides cross, or one
 * corner points inwards (quad_steps.h).
 */
#include "quad_steps.h"

#include "vector.h"

/*
 * Compute the unit normal of an element at one of its corners, perpendicular to both sides there.
 * Returns twice the area of the triangle that these sides span; 0 if they are parallel.
 */
static double normal_at(const quad_mesh *mesh, const uint32_t node[4], int corner, double normal[3])
{
    const double *at = mesh->position[node[corner]], *next = mesh->position[node[(corner + 1) % 4]],
                 *last = mesh->position[node[(corner + 3) % 4]];
    double first[3], second[3];
    for (int i = 0; i < 3; i++) {
        first[i] = next[i] - at[i];
        second[i] = last[i] - at[i];
    }
    vector_cross(first, second, normal);
    return vector_normalise(normal);
}

/*
 * Return a corner at which the normal of an element differs by more than 120 degrees from its
 * normal at another corner, or -1 if there is none or two sides at a corner are parallel. Of
 * several such corners, the one that differs from most others is returned.
 */
static int folded_corner(const quad_mesh *mesh, const uint32_t node[4])
{
    double normal[4][3];
    int off[4] = {0, 0, 0, 0}, worst = -1;
    for (int corner = 0; corner < 4; corner++)
        if (!(normal_at(mesh, node, corner, normal[corner]) > 0))
            return -1;
    for (int corner = 0; corner < 4; corner++)
        for (int other = 0; other < 4; other++)
            off[corner] += vector_dot(normal[corner], normal[other]) < -0.5;
    for (int corner = 0; corner < 4; corner++)
        if (off[corner] > (worst < 0 ? 0 : off[worst]))
            worst = corner;
    return worst;
}

int quad_check_folds(const quad_mesh *mesh, const quad_origin *origin)
{
    for (size_t element = 0; element < mesh->elements; element++) {
        const int corner = folded_corner(mesh, mesh->element[element]);
        if (corner >= 0)
            return quad_fault_at(origin->file, origin->element_at[element],
                                 "element %lld is folded at node %lld: its sides cross or its "
                                 "corner points inwards; list its nodes in order, or move the node",
                                 quad_element_label(mesh, element),
                                 quad_node_label(mesh, mesh->element[element][corner]));
    }
    return 0;
}
