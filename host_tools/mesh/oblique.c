/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Oblique rigid supports: mean displacements that are held along directions in space which are no
 * axes of the triads (local axes) of their nodes. The mean displacements of such a node act along
 * rotated axes, of which the first ones are held; the triad of the node and its elements do not
 * change.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../quads/vector.h"
#include "mesh.h"

/*
 * Sines of angles: below `equal`, a direction counts as one that is held already; between `equal`
 * and `distinct`, two directions are too close to each other to be held both.
 */
static const double equal = 1e-6, distinct = 0.01;

/* Directions along which supports hold the mean displacement of one node. */
typedef struct held_axes {
    int count;
    double axis[3][3]; /* [count] orthogonal unit vectors in the triad (local axes) of the node,
                          which span the directions that are held; then any axes that complete them
                        */
} held_axes;

/* ---- directions at a node ------------------------------------------------ */

/*
 * Compute the direction of an oblique support at a node, in the triad (local axes) of the node.
 * Returns 0, or -1 with error filled if its formulas give no direction there.
 */
static int find_direction(const mesh *mesh, const scene_support *support, int node,
                          double direction[3], char *error)
{
    const expr_point at = mesh_place(mesh, node);
    double vector[3];
    for (int i = 0; i < 3; i++)
        vector[i] =
            support->formula[0] ? expr_value(support->formula[i], &at) : support->direction[i];
    if (!(vector_normalise(vector) > 0))
        return scene_fault(support->at, error,
                           "the direction of this support is no finite vector other than zero at "
                           "%s; correct its formulas, or leave the node out",
                           mesh_node_text(mesh, node).text);
    for (int i = 0; i < 3; i++)
        direction[i] = vector_dot(mesh->point[node].triad[i], vector);
    return 0;
}

/*
 * Add a direction, a unit vector in the triad (local axes) of the node, to the held directions.
 * Returns the sine of its angle to the directions that were held before; below `distinct` nothing
 * is added.
 */
static double add_direction(held_axes *held, const double direction[3])
{
    double rest[3];
    memcpy(rest, direction, sizeof rest);
    for (int repeat = 0; repeat < 2; repeat++) /* the components along the directions that are held
                                                  are removed twice, so that no rounding errors of
                                                  the first removal are left */
        for (int k = 0; k < held->count; k++) {
            const double along = vector_dot(rest, held->axis[k]);
            for (int i = 0; i < 3; i++)
                rest[i] -= along * held->axis[k][i];
        }
    const double sine = vector_normalise(rest);
    if (sine >= distinct && held->count < 3)
        memcpy(held->axis[held->count++], rest, sizeof rest);
    return sine;
}

/*
 * Complete the held directions of a node by further orthogonal axes. Of the axes of the triad
 * (local axes), the one that is farthest from the axes so far determines the next axis.
 */
static void complete(held_axes *held)
{
    const int wanted = held->count;
    while (held->count < 3) {
        double best[3] = {0, 0, 0}, largest = -1;
        for (int i = 0; i < 3; i++) {
            double unit[3] = {i == 0, i == 1, i == 2}, left = 1;
            for (int k = 0; k < held->count; k++)
                left -= held->axis[k][i] * held->axis[k][i];
            if (left <= largest)
                continue;
            largest = left;
            memcpy(best, unit, sizeof best);
        }
        add_direction(held, best);
    }
    held->count = wanted;
}

/*
 * Add the direction of a support that holds the displacement along it, or two directions across it,
 * to the held directions of a node. Returns 0, or -1 with error filled.
 */
static int add_support(const mesh *mesh, const scene_support *support, int node, held_axes *held,
                       char *error)
{
    held_axes own = {0};
    if (find_direction(mesh, support, node, own.axis[0], error) < 0)
        return -1;
    own.count = 1;
    complete(&own);
    for (int k = 0; k < 3; k++) {
        const unsigned bit = k == 0 ? FIX_ALONG : FIX_ACROSS;
        const double sine = support->fix & bit ? add_direction(held, own.axis[k]) : 0;
        if (sine > equal && sine < distinct)
            return scene_fault(support->at, error,
                               "at %s the direction of this support deviates by %.2g degrees from "
                               "what other supports hold, too little to hold both; give both the "
                               "same direction, or leave the node out of one place",
                               mesh_node_text(mesh, node).text, asin(sine) * 57.29577951308232);
    }
    return 0;
}

/* ---- dof of a node --------------------------------------------------------- */

/*
 * Collect the mean displacements of a node that other supports have constrained. Returns 0, or -1
 * with error filled if one of them has a prescribed value.
 */
static int begin_node(const mesh *mesh, const scene_support *support, int node,
                      const double *values, held_axes *held, char *error)
{
    memset(held, 0, sizeof *held);
    for (int i = 0; i < 3; i++) {
        const size_t dof = (size_t)node * mesh->dof_per_node + (size_t)i;
        const double unit[3] = {i == 0, i == 1, i == 2};
        if (!isnan(values[dof]))
            return scene_fault(support->at, error,
                               "at %s another support prescribes the value of a displacement; "
                               "leave the node out of one place",
                               mesh_node_text(mesh, node).text);
        if (mesh->node_dof[dof] == PZS_CONSTRAINED)
            add_direction(held, unit);
    }
    return 0;
}

/*
 * Return whether each direction along which supports hold a node is an axis of its triad (local
 * axes).
 */
static bool along_triad(const held_axes *held)
{
    int found = 0;
    for (int k = 0; k < held->count; k++)
        for (int i = 0; i < 3; i++)
            found += fabs(held->axis[k][i]) > 1 - 1e-14;
    return found == held->count;
}

/*
 * Constrain the held directions of a node: along axes of its triad (local axes) if possible, else
 * along rotated axes, which are stored in the mesh.
 */
static void hold_node(mesh *mesh, int node, held_axes *held)
{
    uint16_t *dof = mesh->node_dof + (size_t)node * mesh->dof_per_node;
    if (held->count == 3 || along_triad(held)) {
        for (int k = 0; k < held->count; k++)
            for (int i = 0; i < 3; i++)
                if (held->count == 3 || fabs(held->axis[k][i]) > 0.5)
                    dof[i] = PZS_CONSTRAINED;
        return;
    }
    complete(held);
    for (int i = 0; i < 3; i++)
        dof[i] = i < held->count ? PZS_CONSTRAINED : 0;
    memcpy(mesh->turn[mesh->turns], held->axis, sizeof held->axis);
    mesh->node_turn[node] = (uint16_t)mesh->turns++;
}

/* ---- supports ---------------------------------------------------------------- */

/*
 * Add an oblique support to the held directions of its nodes.
 *   held [nodes] in/out  held directions of each node
 *   seen [nodes] in/out  whether a node belongs to an oblique support
 * Returns 0, or -1 with error filled.
 */
static int hold_support(const mesh *mesh, const scene_support *support, const double *values,
                        int *node, held_axes *held, bool *seen, char *error)
{
    const int count = mesh_select(mesh, &support->where, node);
    for (int k = 0; k < count; k++) {
        held_axes *own = &held[node[k]];
        if (!seen[node[k]] && begin_node(mesh, support, node[k], values, own, error) < 0)
            return -1;
        seen[node[k]] = true;
        if (add_support(mesh, support, node[k], own, error) < 0)
            return -1;
    }
    return 0;
}

static int hold_all(mesh *mesh, const double *values, int *node, held_axes *held, bool *seen,
                    char *error)
{
    for (int k = 0; k < mesh->scene->supports; k++)
        if (mesh->scene->support[k].fix & FIX_OBLIQUE &&
            hold_support(mesh, &mesh->scene->support[k], values, node, held, seen, error) < 0)
            return -1;
    for (int i = 0; i < mesh->nodes; i++) {
        mesh->node_turn[i] = PZS_UNTURNED;
        if (seen[i])
            hold_node(mesh, i, &held[i]);
    }
    return 0;
}

int mesh_hold_oblique(mesh *mesh, const double *values, int *node, char *error)
{
    const size_t nodes = (size_t)mesh->nodes;
    unsigned any = 0;
    int status = -1;
    for (int k = 0; k < mesh->scene->supports; k++)
        any |= mesh->scene->support[k].fix & FIX_OBLIQUE;
    if (!any)
        return 0;
    held_axes *held = calloc(nodes, sizeof *held);
    bool *seen = calloc(nodes, sizeof *seen);
    mesh->node_turn = calloc(nodes, sizeof *mesh->node_turn);
    mesh->turn = calloc(nodes, sizeof *mesh->turn);
    if (!held || !seen || !mesh->node_turn || !mesh->turn)
        scene_fault(mesh->scene->at_surface, error,
                    "%d nodes do not fit into memory; use fewer elements", mesh->nodes);
    else
        status = hold_all(mesh, values, node, held, seen, error);
    free(held);
    free(seen);
    return status;
}

/* ---- use ------------------------------------------------------------------------ */

/* Return the rotated axes of a node at an oblique support, else NULL. */
static const double (*turn_of(const mesh *mesh, int node))[3]
{
    if (mesh->turns == 0 || mesh->node_turn[node] == PZS_UNTURNED)
        return NULL;
    return (const double(*)[3])mesh->turn[mesh->node_turn[node]];
}

void mesh_turn_to_dof(const mesh *mesh, int node, double mean[3])
{
    const double(*turn)[3] = turn_of(mesh, node);
    const double in_triad[3] = {mean[0], mean[1], mean[2]};
    for (int i = 0; turn && i < 3; i++)
        mean[i] = vector_dot(turn[i], in_triad);
}

void mesh_turn_to_triad(const mesh *mesh, int node, double mean[3])
{
    const double(*turn)[3] = turn_of(mesh, node);
    const double along[3] = {mean[0], mean[1], mean[2]};
    for (int i = 0; turn && i < 3; i++)
        mean[i] = turn[0][i] * along[0] + turn[1][i] * along[1] + turn[2][i] * along[2];
}
