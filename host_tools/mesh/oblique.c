/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Oblique rigid supports: mean displacements (of both faces) held along directions that are no axes
 * of the triads (local axes) of their nodes. The mean displacements of such a node act along
 * rotated axes, the first of which are held; triad and elements do not change.
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

/*
 * Directions along which supports hold the mean displacement (of both faces) of one node, or
 * prescribe its value.
 */
typedef struct held_axes {
    int count;
    double axis[3][3]; /* [count] orthogonal unit vectors in the triad (local axes) of the node that
                          span the held directions, followed by axes that complete them to three */
    double value[3]; /* [count] displacement that supports prescribe along each of the directions in
                        which they hold the node (length unit of the scene file) */
    int holder[3];   /* [count] index, among the scene's supports, of the one that holds the node
                        along each axis */
} held_axes;

/*
 * Direction along which one support holds or prescribes the mean displacement (of both faces) of a
 * node.
 */
typedef struct held_direction {
    double vector[3]; /* direction of the support: unit vector in the triad (local axes) of the node
                       */
    double value; /* displacement that the support prescribes along its direction (length unit of
                     the scene file) */
    int holder;   /* index of the support among those of the scene */
} held_direction;

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
 * Project the direction of a support on the space orthogonal to the axes that other supports of the
 * node hold, and subtract the displacement that these axes prescribe.
 *   rest  in/out  in: unit vector and prescribed displacement of the support; out: projected unit
 *       vector; `value` is the displacement along it times the returned sine
 * Returns the sine of the angle between the direction and the held axes.
 */
static double remove_held(const held_axes *held, held_direction *rest)
{
    for (int repeat = 0; repeat < 2; repeat++) /* The projection is repeated once: rounding errors
                                                  of the first one leave small components along the
                                                  axes that other supports hold. */
        for (int k = 0; k < held->count; k++) {
            const double along = vector_dot(rest->vector, held->axis[k]);
            rest->value -= along * held->value[k];
            for (int i = 0; i < 3; i++)
                rest->vector[i] -= along * held->axis[k][i];
        }
    return vector_normalise(rest->vector);
}

/*
 * Return the largest absolute displacement that supports prescribe at a node, from which relative
 * rounding limits are computed: along the axes in `held`, which earlier supports have added, and
 * along `direction`, which one more support prescribes.
 */
static double largest_value(const held_axes *held, const held_direction *direction)
{
    double most = fabs(direction->value);
    for (int k = 0; k < held->count; k++)
        most = fmax(most, fabs(held->value[k]));
    return most;
}

/*
 * Add a direction to those along which supports hold a node. Returns the sine of its angle to the
 * directions that were held before; where the sine is below `distinct`, nothing is added.
 */
static double add_direction(held_axes *held, const held_direction *direction)
{
    held_direction rest = *direction;
    const double sine = remove_held(held, &rest), most = largest_value(held, direction);
    if (sine < distinct || held->count == 3)
        return sine;
    memcpy(held->axis[held->count], rest.vector, sizeof rest.vector);
    held->value[held->count] = fabs(rest.value) > 1e-13 * most ? rest.value / sine : 0;
    held->holder[held->count++] = direction->holder;
    return sine;
}

/*
 * Complete the directions along which supports hold a node by further orthogonal axes. The axis of
 * the triad (local axes) that is farthest from the axes so far determines the next one.
 */
static void complete(held_axes *held)
{
    const int wanted = held->count;
    while (held->count < 3) {
        held_direction best = {.holder = -1};
        double largest = -1;
        for (int i = 0; i < 3; i++) {
            const double unit[3] = {i == 0, i == 1, i == 2};
            double left = 1;
            for (int k = 0; k < held->count; k++)
                left -= held->axis[k][i] * held->axis[k][i];
            if (left <= largest)
                continue;
            largest = left;
            memcpy(best.vector, unit, sizeof unit);
        }
        add_direction(held, &best);
    }
    held->count = wanted;
}

/*
 * Add a direction of a support to those along which supports hold a node. Returns 0, or -1 with
 * error filled if the direction, or its prescribed value, contradicts what other supports hold.
 */
static int hold_direction(const mesh *mesh, const scene_support *support, int node,
                          const held_direction *direction, held_axes *held, char *error)
{
    held_direction rest = *direction;
    const double sine = remove_held(held, &rest), most = largest_value(held, direction);
    if (sine > equal && sine < distinct)
        return scene_fault(support->at, error,
                           "at %s the direction of this support deviates by %.2g degrees from "
                           "what other supports hold, too little to hold both; give both the "
                           "same direction, or leave the node out of one place",
                           mesh_node_text(mesh, node).text, asin(sine) * 57.29577951308232);
    if (sine <= equal && fabs(rest.value) > 1e-9 * most)
        return scene_fault(support->at, error,
                           "at %s other supports prescribe %g along the direction of this one, "
                           "which prescribes %g; remove one, or leave the node out of one place",
                           mesh_node_text(mesh, node).text, direction->value - rest.value,
                           direction->value);
    add_direction(held, direction);
    return 0;
}

/*
 * Compute the displacement that an oblique support prescribes along its direction at a node.
 * Returns 0, or -1 with error filled if it is not a finite number.
 */
static int find_value(const mesh *mesh, const scene_support *support, int node, double *value,
                      char *error)
{
    const expr_point at = mesh_place(mesh, node);
    *value = support->move & FIX_ALONG ? expr_value(support->value, &at) : 0;
    if (isfinite(*value))
        return 0;
    return scene_fault(support->at, error,
                       "the value of the support is not a finite number at %s; correct its formula",
                       mesh_node_text(mesh, node).text);
}

/*
 * Combine the directions along which supports hold a node with those of one more support, which
 * holds the displacement along its direction or along the two directions across it. Returns 0, or
 * -1 with error filled.
 */
static int add_support(const mesh *mesh, const scene_support *support, int node, held_axes *held,
                       char *error)
{
    held_axes own = {0};
    held_direction direction = {.holder = (int)(support - mesh->scene->support)};
    double value;
    if (find_direction(mesh, support, node, own.axis[0], error) < 0 ||
        find_value(mesh, support, node, &value, error) < 0)
        return -1;
    own.count = 1;
    complete(&own);
    for (int k = 0; k < 3; k++) {
        if (!(support->fix & (k == 0 ? FIX_ALONG : FIX_ACROSS)))
            continue;
        memcpy(direction.vector, own.axis[k], sizeof direction.vector);
        direction.value = k == 0 ? value : 0;
        if (hold_direction(mesh, support, node, &direction, held, error) < 0)
            return -1;
    }
    return 0;
}

/* ---- dof of a node --------------------------------------------------------- */

/*
 * Collect the mean displacements (of both faces) of a node that other supports hold or prescribe
 * along the axes of its triad (local axes).
 */
static void begin_node(const mesh *mesh, int node, const double *values, held_axes *held)
{
    memset(held, 0, sizeof *held);
    for (int i = 0; i < 3; i++) {
        const size_t dof = (size_t)node * mesh->dof_per_node + (size_t)i;
        const bool is_prescribed = !isnan(values[dof]);
        const held_direction own = {.vector = {i == 0, i == 1, i == 2},
                                    .value = is_prescribed ? values[dof] : 0,
                                    .holder = mesh->holder[dof]};
        if (is_prescribed || mesh->node_dof[dof] == PZS_CONSTRAINED)
            add_direction(held, &own);
    }
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
 * Return whether supports prescribe a displacement other than 0 along a direction in which they
 * hold a node.
 */
static bool has_value(const held_axes *held)
{
    bool found = false;
    for (int k = 0; k < held->count; k++)
        found |= held->value[k] != 0;
    return found;
}

/*
 * Constrain a node whose held directions are axes of its triad (local axes), or which is held in
 * all directions. The reaction of each constrained mean displacement (of both faces) along an axis
 * counts for the support whose direction has the smallest angle to this axis.
 */
static void hold_along_triad(mesh *mesh, int node, const held_axes *held)
{
    const size_t first = (size_t)node * mesh->dof_per_node;
    for (int i = 0; i < 3; i++) {
        int nearest = 0;
        for (int k = 1; k < held->count; k++)
            nearest = fabs(held->axis[k][i]) > fabs(held->axis[nearest][i]) ? k : nearest;
        if (held->count < 3 && fabs(held->axis[nearest][i]) <= 0.5)
            continue;
        mesh->node_dof[first + (size_t)i] = PZS_CONSTRAINED;
        mesh->holder[first + (size_t)i] = held->holder[nearest];
    }
}

/*
 * Mark the dof of a node that supports hold or prescribe. The node gets new axes, which begin with
 * the held directions. It keeps the axes of its triad (local axes) if all prescribed displacements
 * are 0 and the directions are such axes, or span the space.
 *   values [nodes][dof_per_node] in/out  prescribed displacement of each dof, NAN where none
 */
static void hold_node(mesh *mesh, int node, double *values, held_axes *held)
{
    const size_t first = (size_t)node * mesh->dof_per_node;
    if (!has_value(held) && (held->count == 3 || along_triad(held))) {
        hold_along_triad(mesh, node, held);
        return;
    }
    complete(held);
    for (int i = 0; i < 3; i++) {
        const size_t dof = first + (size_t)i;
        const bool is_held = i < held->count, is_moved = is_held && held->value[i] != 0;
        mesh->node_dof[dof] = is_held && !is_moved ? PZS_CONSTRAINED : 0;
        mesh->holder[dof] = is_held ? held->holder[i] : -1;
        values[dof] = is_moved ? held->value[i] : (double)NAN;
    }
    memcpy(mesh->turn[mesh->turns], held->axis, sizeof held->axis);
    mesh->node_turn[node] = (uint16_t)mesh->turns++;
}

/* ---- supports ---------------------------------------------------------------- */

/*
 * Add the directions of an oblique support to those along which its nodes are held.
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
        if (!seen[node[k]])
            begin_node(mesh, node[k], values, own);
        seen[node[k]] = true;
        if (add_support(mesh, support, node[k], own, error) < 0)
            return -1;
    }
    return 0;
}

static int hold_all(mesh *mesh, double *values, int *node, held_axes *held, bool *seen, char *error)
{
    for (int k = 0; k < mesh->scene->supports; k++)
        if (mesh->scene->support[k].fix & FIX_OBLIQUE &&
            hold_support(mesh, &mesh->scene->support[k], values, node, held, seen, error) < 0)
            return -1;
    for (int i = 0; i < mesh->nodes; i++) {
        mesh->node_turn[i] = PZS_UNTURNED;
        if (seen[i])
            hold_node(mesh, i, values, &held[i]);
    }
    return 0;
}

int mesh_hold_oblique(mesh *mesh, double *values, int *node, char *error)
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
