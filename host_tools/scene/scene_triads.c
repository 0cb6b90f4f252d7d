/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Supports of a mesh from a file: they determine the local axes (triads) of their nodes and
 * constrain dof along these axes (scene_parts.h).
 */
#include "scene_parts.h"
#include "../quads/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/*
 * Bits of those dof of a node that act along the axes e1, e2 and e3 of its triad (local axes): for
 * each axis, the mean of the displacements of both faces of the shell and their difference; for e3
 * also the displacement of the middle surface relative to the faces.
 */
enum { ALONG_1 = 1 | 8, ALONG_2 = 2 | 16, ALONG_3 = 4 | 32 | 64, ALL = 127 };

/*
 * Sine of the largest deviation (angle) at which two directions still count as parallel or as
 * perpendicular.
 */
static const double nearly = 0.01;

/*
 * Cosine of the smallest angle between the normals of two adjacent edges of a set at which the node
 * between them counts as a corner.
 */
static const double corner = 0.85;

/* ---- vectors ----------------------------------------------------------- */

/*
 * Remove the component of a vector along a unit vector and scale the rest to length 1. Returns the
 * length of the rest before scaling.
 */
static double project(double vector[3], const double unit[3])
{
    const double along = vector_dot(vector, unit);
    for (int i = 0; i < 3; i++)
        vector[i] -= along * unit[i];
    return vector_normalise(vector);
}

/* ---- arrays of the computation of triads -------------------------------- */

/*
 * Normals, at one node, of those edges of a support (a constrained part of the boundary) that meet
 * at the node.
 */
typedef struct edge_normal {
    double sum[3];   /* sum of the unit normals of the edges that meet at the node; each normal is
                        tangent to the surface */
    double first[3]; /* unit normal of one of the edges that meet at the node, the one that was
                        first added to `sum` */
    int edges;
    bool is_corner; /* whether two edges of the support meet at an angle at the node */
} edge_normal;

typedef struct triads {
    scene *scene;
    quad_mesh *mesh;
    char *error;
    unsigned char *in_set; /* [nodes] 1 for the nodes of the support that is being applied */
    unsigned char *fixed; /* [nodes] 1 for the nodes whose local axis e1 a support has determined */
    edge_normal *normal; /* [nodes] at each node, sum of the normals of those edges of the supported
                            boundary that meet there */
} triads;

static long long label(const triads *triads, size_t node)
{
    return (long long)triads->mesh->node_label[node];
}

/* ---- normals of edges --------------------------------------------------- */

/*
 * Add the unit normal of one side of an element, tangent to the surface, to the sums of normals at
 * both nodes of the side.
 */
static void add_edge(triads *triads, size_t element, int side)
{
    const uint32_t node[2] = {triads->mesh->element[element][side],
                              triads->mesh->element[element][(side + 1) % 4]};
    double along[3], middle[3], normal[3];
    for (int i = 0; i < 3; i++) {
        along[i] = triads->mesh->position[node[1]][i] - triads->mesh->position[node[0]][i];
        middle[i] = triads->mesh->director[node[0]][i] + triads->mesh->director[node[1]][i];
    }
    vector_cross(along, middle, normal);
    const double length = sqrt(vector_dot(normal, normal));
    for (int k = 0; k < 2 && length > 0; k++) {
        edge_normal *own = &triads->normal[node[k]];
        for (int i = 0; i < 3; i++) {
            own->sum[i] += normal[i] / length;
            own->first[i] = own->edges == 0 ? normal[i] / length : own->first[i];
        }
        if (own->edges++ > 0 && vector_dot(own->first, normal) < corner * length)
            own->is_corner = true;
    }
}

/*
 * Return whether an edge set contains a side of an element; without an edge set, whether both nodes
 * of the side belong to the support.
 */
static bool has_side(const triads *triads, const quad_set *edges, size_t element, int side)
{
    const uint32_t edge = (uint32_t)(4 * element) + (uint32_t)side;
    if (!edges)
        return triads->in_set[triads->mesh->element[element][side]] &&
               triads->in_set[triads->mesh->element[element][(side + 1) % 4]];
    return quad_set_has(edges, edge);
}

/*
 * At each node of a support, sum the normals of those edges of the support that meet there. Returns
 * the number of edges.
 */
static int find_normals(triads *triads, const scene_support *support)
{
    const quad_set *edges =
        support->where.type == WHERE_SET
            ? quad_set_find(triads->mesh->edge_set, triads->mesh->edge_sets, support->where.set)
            : NULL;
    int count = 0;
    memset(triads->normal, 0, triads->mesh->nodes * sizeof *triads->normal);
    for (size_t element = 0; element < triads->mesh->elements; element++)
        for (int side = 0; side < 4; side++)
            if (has_side(triads, edges, element, side)) {
                add_edge(triads, element, side);
                count++;
            }
    return count;
}

/* ---- symmetry planes ---------------------------------------------------- */

/*
 * Find the unit normal of the symmetry plane that a support of the type symmetric stands for: the
 * direction that the scene file gives, or the mean of the normals of the support's edges. Returns
 * 0, or -1 with the error filled.
 */
static int plane_normal(triads *triads, const scene_support *support, double normal[3])
{
    memcpy(normal, support->direction, 3 * sizeof *normal);
    for (size_t node = 0;
         vector_dot(support->direction, support->direction) == 0 && node < triads->mesh->nodes;
         node++)
        for (int i = 0; i < 3; i++)
            normal[i] += triads->normal[node].sum[i];
    const double length = sqrt(vector_dot(normal, normal));
    for (int i = 0; i < 3 && length > 0; i++)
        normal[i] /= length;
    if (length > 0)
        return 0;
    return scene_fault(support->at, triads->error,
                       "the edges of this set have no common normal; give direction: [x, y, z], "
                       "the normal of the symmetry plane");
}

/*
 * Turn the directors (directions through the thickness) of the nodes of a symmetry plane into this
 * plane. Returns 0, or -1 with the error filled if the nodes do not lie in one plane.
 */
static int apply_plane(triads *triads, const scene_support *support, const double normal[3])
{
    const quad_mesh *mesh = triads->mesh;
    double height = 0, low = HUGE_VAL, high = -HUGE_VAL, size = 0;
    for (size_t node = 0; node < mesh->nodes; node++) {
        if (!triads->in_set[node])
            continue;
        height = vector_dot(mesh->position[node], normal);
        low = fmin(low, height);
        high = fmax(high, height);
        for (int i = 0; i < 3; i++)
            size = fmax(size, fabs(mesh->position[node][i] - mesh->position[0][i]));
        if (!(project(mesh->director[node], normal) > 0.5))
            return scene_fault(support->at, triads->error,
                               "the director of node %lld of the mesh file stands across the "
                               "symmetry plane; give direction: [x, y, z], its normal",
                               label(triads, node));
    }
    if (high - low <= 1e-4 * size)
        return 0;
    return scene_fault(support->at, triads->error,
                       "the nodes of this symmetric support lie %g apart across the plane; a "
                       "symmetry plane is flat: divide the set, or give direction: [x, y, z]",
                       high - low);
}

/* ---- local axes and constrained dof ------------------------------------- */

/*
 * Exchange the bits of the dof along the local axes e1 and e2 in a set of dof, and return the
 * result.
 */
static unsigned exchanged(unsigned bits)
{
    return (bits & ALONG_3) | (bits & ALONG_1) << 1 | (bits & ALONG_2) >> 1;
}

/*
 * Constrain dof of a node, given as bits. A dof that was free before counts as held by the support.
 */
static void constrain(triads *triads, const scene_support *support, size_t node, unsigned bits)
{
    const unsigned fresh = bits & ~(unsigned)triads->mesh->constrained[node];
    for (unsigned i = 0; i < QUAD_DOF; i++)
        if (fresh >> i & 1u)
            triads->mesh->holder[node][i] = (int)(support - triads->scene->support);
    triads->mesh->constrained[node] |= (uint8_t)bits;
}

/*
 * Constrain dof of a node in the triad (local axes) whose axis e1 is the projection of a direction
 * on the surface. Where an earlier support has determined the triad, both directions must be
 * parallel or perpendicular. Returns 0, or -1 with the error filled.
 */
static int hold(triads *triads, const scene_support *support, size_t node,
                const double direction[3], unsigned bits)
{
    double axis[3];
    memcpy(axis, direction, sizeof axis);
    if (!(project(axis, triads->mesh->director[node]) > nearly))
        return scene_fault(support->at, triads->error,
                           "the direction of this support is that of the director at node %lld of "
                           "the mesh file; choose one in the surface, or fix u3",
                           label(triads, node));
    const double cosine =
        triads->fixed[node] ? fabs(vector_dot(axis, triads->mesh->axis[node])) : 1;
    if ((cosine > nearly || support->value) && cosine < sqrt(1 - nearly * nearly))
        return scene_fault(support->at, triads->error,
                           "node %lld of the mesh file has another support whose direction is "
                           "turned by %.1f degrees; supports at one node need equal or "
                           "perpendicular directions: clamp it, or leave it out of one set",
                           label(triads, node), acos(cosine) * 57.29577951308232);
    if (!triads->fixed[node])
        memcpy(triads->mesh->axis[node], axis, sizeof axis);
    triads->fixed[node] = 1;
    constrain(triads, support, node, cosine <= nearly ? exchanged(bits) : bits);
    return 0;
}

/*
 * Constrain the displacements of a node along global axes (bits FIX_X, FIX_Y and FIX_Z). Returns 0,
 * or -1 with the error filled.
 */
static int hold_global(triads *triads, const scene_support *support, size_t node, unsigned bits)
{
    static const unsigned axis_bit[3] = {FIX_X, FIX_Y, FIX_Z};
    unsigned held = 0;
    int own = -1;
    for (int i = 0; i < 3; i++)
        held += (bits & axis_bit[i]) != 0;
    for (int i = 0; i < 3; i++) {
        const bool is_held = (bits & axis_bit[i]) != 0;
        if (is_held != (held == 1))
            continue;
        own = i; /* Index of the only global axis along which the node is constrained, or of the
                    only free axis if it is constrained along two. */
        if (fabs(triads->mesh->director[node][i]) > sqrt(1 - nearly * nearly)) {
            constrain(triads, support, node, held == 1 ? ALONG_3 : ALONG_1 | ALONG_2);
            return 0;
        }
    }
    if (held == 3) {
        constrain(triads, support, node, ALL);
        return 0;
    }
    double direction[3] = {own == 0, own == 1, own == 2};
    if (fabs(triads->mesh->director[node][own]) > nearly)
        return scene_fault(support->at, triads->error,
                           "at node %lld of the mesh file %c is neither in the surface nor along "
                           "the director; fix [x, y, z], or u3, or the mean displacement alone: "
                           "along",
                           label(triads, node), "xyz"[own]);
    return hold(triads, support, node, direction, held == 1 ? ALONG_1 : ALONG_2 | ALONG_3);
}

/*
 * Constrain a list of dof of a node. Dof along the tangential axes e1 and e2 need a support with a
 * direction, which determines these axes, unless the dof of both axes are constrained alike.
 * Returns 0, or -1 with the error filled.
 */
static int hold_listed(triads *triads, const scene_support *support, size_t node, unsigned bits)
{
    const bool is_oblique = support->fix & FIX_OBLIQUE;
    if (!is_oblique && vector_dot(support->direction, support->direction) > 0)
        return hold(triads, support, node, support->direction, bits);
    if (exchanged(bits) != bits)
        return scene_fault(support->at, triads->error,
                           "u1 and u2 are directions in the surface that a mesh from a file does "
                           "not have; add direction: [x, y, z] for u1, or fix x, y or z");
    constrain(triads, support, node, bits);
    return 0;
}

/*
 * Constrain a node of a simply supported edge: its displacement along the edge, and its
 * displacement normal to the surface. At a corner, displacements along both edges are constrained.
 * Returns 0, or -1 with the error filled.
 */
static int hold_simple(triads *triads, const scene_support *support, size_t node)
{
    const edge_normal *normal = &triads->normal[node];
    const bool is_given = vector_dot(support->direction, support->direction) > 0;
    if (!is_given && normal->is_corner) {
        constrain(triads, support, node, ALL);
        return 0;
    }
    return hold(triads, support, node, is_given ? support->direction : normal->sum,
                ALONG_2 | ALONG_3);
}

static int hold_node(triads *triads, const scene_support *support, size_t node,
                     const double plane[3])
{
    const unsigned global = support->fix & (FIX_X | FIX_Y | FIX_Z), listed = support->fix & ALL;
    if (support->fix & FIX_SYMMETRIC && hold(triads, support, node, plane, ALONG_1) != 0)
        return -1;
    if (support->fix & FIX_SIMPLE && hold_simple(triads, support, node) != 0)
        return -1;
    if (global && hold_global(triads, support, node, global) != 0)
        return -1;
    return listed ? hold_listed(triads, support, node, listed) : 0;
}

/* ---- supports ----------------------------------------------------------- */

/*
 * Find the nodes on which a support acts. If the support needs directions that the scene file does
 * not give, compute the normals of its edges too. Returns 0, or -1 with the error filled.
 */
static int find_nodes(triads *triads, const scene_support *support)
{
    const bool needs_edges = support->fix & (FIX_SIMPLE | FIX_SYMMETRIC) &&
                             vector_dot(support->direction, support->direction) == 0;
    if (scene_mark_nodes(triads->scene, &support->where, triads->in_set) == 0)
        return scene_fault(support->at, triads->error, "set '%s' of the mesh has no nodes",
                           support->where.set);
    if (!needs_edges || find_normals(triads, support) > 0)
        return 0;
    return scene_fault(support->at, triads->error,
                       "this set has no edges, so that '%s' has no direction; name a set of edges, "
                       "or add direction: [x, y, z]",
                       support->fix & FIX_SIMPLE ? "simple" : "symmetric");
}

/*
 * Turn the directors (directions through the thickness) at the nodes of a support on a symmetry
 * plane into that plane. All such supports are treated before the first triad (local axes) is
 * determined, because triads depend on directors.
 */
static int turn_directors(triads *triads, const scene_support *support)
{
    double normal[3];
    if (!(support->fix & FIX_SYMMETRIC))
        return 0;
    if (find_nodes(triads, support) != 0 || plane_normal(triads, support, normal) != 0)
        return -1;
    return apply_plane(triads, support, normal);
}

static int hold_support(triads *triads, const scene_support *support)
{
    double plane[3] = {0, 0, 0};
    if (support->value && support->fix & ~(unsigned)(ALL | FIX_ALONG))
        return scene_fault(support->at, triads->error,
                           "on a mesh from a file a prescribed displacement is u3, or u1 or along "
                           "with direction: [x, y, z]");
    if (find_nodes(triads, support) != 0)
        return -1;
    if (support->fix & FIX_SYMMETRIC && plane_normal(triads, support, plane) != 0)
        return -1;
    for (size_t node = 0; node < triads->mesh->nodes; node++)
        if (triads->in_set[node] && hold_node(triads, support, node, plane) != 0)
            return -1;
    return 0;
}

/* Choose the local axis e1 of every node at which no support has determined it. */
static void finish_axes(triads *triads)
{
    const int common = quad_common_axis(triads->mesh);
    for (size_t node = 0; node < triads->mesh->nodes; node++)
        if (!triads->fixed[node])
            quad_default_axis(triads->mesh->director[node], common, triads->mesh->axis[node]);
}

/*
 * Apply all supports of the scene to the mesh: to its directors (directions through the thickness),
 * local axes and constrained dof. Supports with a prescribed value leave their dof free here; the
 * displacement is prescribed later. Returns 0, or -1 with the error filled.
 */
static int apply_supports(triads *triads)
{
    for (int k = 0; k < triads->scene->supports; k++)
        if (turn_directors(triads, &triads->scene->support[k]) != 0)
            return -1;
    /*
     * The first iteration applies the supports with a prescribed value, the second one the
     * others. The first support that needs a direction at a node sets the triad (local axes) of
     * the node, and a support with a prescribed value requires its own direction as axis e1.
     */
    for (int pass = 0; pass < 2; pass++)
        for (int k = 0; k < triads->scene->supports; k++) {
            const scene_support *support = &triads->scene->support[k];
            if ((support->value != NULL) != (pass == 0))
                continue;
            if (hold_support(triads, support) != 0)
                return -1;
            if (pass == 0)
                memset(triads->mesh->constrained, 0, triads->mesh->nodes);
        }
    finish_axes(triads);
    return 0;
}

int check_triads(scene *scene, char *error)
{
    triads triads = {.scene = scene, .mesh = &scene->quads->mesh, .error = error};
    const size_t nodes = triads.mesh->nodes;
    int status = -1;
    triads.mesh->constrained = calloc(nodes, sizeof *triads.mesh->constrained);
    free(triads.mesh->holder);
    triads.mesh->holder = calloc(nodes, sizeof *triads.mesh->holder);
    triads.in_set = calloc(nodes, 1);
    triads.fixed = calloc(nodes, 1);
    triads.normal = calloc(nodes, sizeof *triads.normal);
    if (triads.mesh->constrained && triads.mesh->holder && triads.in_set && triads.fixed &&
        triads.normal)
        status = apply_supports(&triads);
    else
        scene_fault(scene->quads->at, error, "the mesh does not fit into memory");
    free(triads.in_set);
    free(triads.fixed);
    free(triads.normal);
    return status;
}
