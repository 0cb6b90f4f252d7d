/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Supports of a mesh from a file: they choose the triads of their nodes and hold dof in them
 * (scene_parts.h).
 */
#include "scene_parts.h"
#include "../quads/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Bits of the dof along e1, e2 and e3: mean, difference, and for e3 the middle surface. */
enum { ALONG_1 = 1 | 8, ALONG_2 = 2 | 16, ALONG_3 = 4 | 32 | 64, ALL = 127 };

/* Sine of the largest angle at which two directions count as equal or as perpendicular. */
static const double nearly = 0.01;

/* Cosine of the angle of two edges of a set above which a node between them is a corner. */
static const double corner = 0.85;

/* ---- vectors ----------------------------------------------------------- */

/* Remove the part of a vector along a unit vector and scale it to 1. Returns the size that was
 * left. */
static double project(double a[3], const double unit[3])
{
    const double along = vector_dot(a, unit);
    for (int i = 0; i < 3; i++)
        a[i] -= along * unit[i];
    return vector_normalise(a);
}

/* ---- work --------------------------------------------------------------- */

/* What the edges of a set at one node say. */
typedef struct edge_normal {
    double sum[3];   /* sum of the unit normals of the edges, in the surface and out of it */
    double first[3]; /* normal of the first edge */
    int edges;
    bool is_corner; /* two edges meet at an angle */
} edge_normal;

typedef struct triads {
    scene *scene;
    quad_mesh *mesh;
    char *error;
    unsigned char *in_set; /* [nodes] nodes of the present support */
    unsigned char *fixed;  /* [nodes] whether a support has chosen the axis */
    edge_normal *normal;   /* [nodes] */
} triads;

static long long label(const triads *t, size_t node)
{
    return (long long)t->mesh->node_label[node];
}

/* ---- normals of edges --------------------------------------------------- */

/* Add the normal of side s of an element to both of its nodes. */
static void add_edge(triads *t, size_t element, int s)
{
    const uint32_t node[2] = {t->mesh->element[element][s], t->mesh->element[element][(s + 1) % 4]};
    double along[3], middle[3], normal[3];
    for (int i = 0; i < 3; i++) {
        along[i] = t->mesh->position[node[1]][i] - t->mesh->position[node[0]][i];
        middle[i] = t->mesh->director[node[0]][i] + t->mesh->director[node[1]][i];
    }
    vector_cross(along, middle, normal);
    const double length = sqrt(vector_dot(normal, normal));
    for (int k = 0; k < 2 && length > 0; k++) {
        edge_normal *own = &t->normal[node[k]];
        for (int i = 0; i < 3; i++) {
            own->sum[i] += normal[i] / length;
            own->first[i] = own->edges == 0 ? normal[i] / length : own->first[i];
        }
        if (own->edges++ > 0 && vector_dot(own->first, normal) < corner * length)
            own->is_corner = true;
    }
}

/* Whether an edge set, or a node set, contains side s of an element. */
static bool has_side(const triads *t, const quad_set *edges, size_t element, int s)
{
    const uint32_t edge = (uint32_t)(4 * element) + (uint32_t)s;
    if (!edges)
        return t->in_set[t->mesh->element[element][s]] &&
               t->in_set[t->mesh->element[element][(s + 1) % 4]];
    return quad_set_has(edges, edge);
}

/* Normals of the edges of a support's set at its nodes. Returns the number of edges. */
static int find_normals(triads *t, const scene_support *support)
{
    const quad_set *edges =
        support->where.type == WHERE_SET
            ? quad_set_find(t->mesh->edge_set, t->mesh->edge_sets, support->where.set)
            : NULL;
    int count = 0;
    memset(t->normal, 0, t->mesh->nodes * sizeof *t->normal);
    for (size_t e = 0; e < t->mesh->elements; e++)
        for (int s = 0; s < 4; s++)
            if (has_side(t, edges, e, s)) {
                add_edge(t, e, s);
                count++;
            }
    return count;
}

/* ---- symmetry planes ---------------------------------------------------- */

/* Normal of the plane of a symmetric support: given, or the mean of the normals of its edges. */
static int plane_normal(triads *t, const scene_support *support, double normal[3])
{
    memcpy(normal, support->direction, 3 * sizeof *normal);
    for (size_t n = 0;
         vector_dot(support->direction, support->direction) == 0 && n < t->mesh->nodes; n++)
        for (int i = 0; i < 3; i++)
            normal[i] += t->normal[n].sum[i];
    const double length = sqrt(vector_dot(normal, normal));
    for (int i = 0; i < 3 && length > 0; i++)
        normal[i] /= length;
    if (length > 0)
        return 0;
    return scene_fault(t->scene, support->at, t->error,
                       "the edges of this set have no common normal; give direction: [x, y, z], "
                       "the normal of the symmetry plane");
}

/* Put the directors of the nodes of a symmetry plane into the plane, which the nodes must lie in.
 */
static int apply_plane(triads *t, const scene_support *support, const double normal[3])
{
    const quad_mesh *mesh = t->mesh;
    double height = 0, low = HUGE_VAL, high = -HUGE_VAL, size = 0;
    for (size_t n = 0; n < mesh->nodes; n++) {
        if (!t->in_set[n])
            continue;
        height = vector_dot(mesh->position[n], normal);
        low = fmin(low, height);
        high = fmax(high, height);
        for (int i = 0; i < 3; i++)
            size = fmax(size, fabs(mesh->position[n][i] - mesh->position[0][i]));
        if (!(project(mesh->director[n], normal) > 0.5))
            return scene_fault(t->scene, support->at, t->error,
                               "the director of node %lld of the mesh file stands across the "
                               "symmetry plane; give direction: [x, y, z], its normal",
                               label(t, n));
    }
    if (high - low <= 1e-4 * size)
        return 0;
    return scene_fault(t->scene, support->at, t->error,
                       "the nodes of this symmetric support lie %g apart across the plane; a "
                       "symmetry plane is flat: divide the set, or give direction: [x, y, z]",
                       high - low);
}

/* ---- triads ------------------------------------------------------------- */

/* Exchange the bits of e1 and e2. */
static unsigned exchanged(unsigned bits)
{
    return (bits & ALONG_3) | (bits & ALONG_1) << 1 | (bits & ALONG_2) >> 1;
}

/*
 * Hold dof of a node in the triad whose e1 is the projection of a direction. Where an earlier
 * support has chosen the triad, the directions must be equal or perpendicular.
 */
static int hold(triads *t, const scene_support *support, size_t node, const double direction[3],
                unsigned bits)
{
    double axis[3];
    memcpy(axis, direction, sizeof axis);
    if (!(project(axis, t->mesh->director[node]) > nearly))
        return scene_fault(t->scene, support->at, t->error,
                           "the direction of this support is that of the director at node %lld of "
                           "the mesh file; choose one in the surface, or fix u3",
                           label(t, node));
    const double cosine = t->fixed[node] ? fabs(vector_dot(axis, t->mesh->axis[node])) : 1;
    if ((cosine > nearly || support->value) && cosine < sqrt(1 - nearly * nearly))
        return scene_fault(t->scene, support->at, t->error,
                           "node %lld of the mesh file has another support whose direction is "
                           "turned by %.1f degrees; supports at one node need equal or "
                           "perpendicular directions: clamp it, or leave it out of one set",
                           label(t, node), acos(cosine) * 57.29577951308232);
    if (!t->fixed[node])
        memcpy(t->mesh->axis[node], axis, sizeof axis);
    t->fixed[node] = 1;
    t->mesh->constrained[node] |= (uint8_t)(cosine <= nearly ? exchanged(bits) : bits);
    return 0;
}

/* Hold displacements along global axes. bits: FIX_X, FIX_Y, FIX_Z */
static int hold_global(triads *t, const scene_support *support, size_t node, unsigned bits)
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
        own = i; /* the held axis, or of two held ones the axis that is not */
        if (held == 1 && fabs(t->mesh->director[node][i]) > sqrt(1 - nearly * nearly)) {
            t->mesh->constrained[node] |= ALONG_3;
            return 0;
        }
    }
    if (held == 3) {
        t->mesh->constrained[node] |= ALL;
        return 0;
    }
    double direction[3] = {own == 0, own == 1, own == 2};
    if (fabs(t->mesh->director[node][own]) > nearly)
        return scene_fault(t->scene, support->at, t->error,
                           "at node %lld of the mesh file %c is neither in the surface nor along "
                           "the director; fix [x, y, z], or u3",
                           label(t, node), "xyz"[own]);
    return hold(t, support, node, direction, held == 1 ? ALONG_1 : ALONG_2 | ALONG_3);
}

/* Hold a list of dof. Those along e1 and e2 need a direction unless both are held alike. */
static int hold_listed(triads *t, const scene_support *support, size_t node, unsigned bits)
{
    if (vector_dot(support->direction, support->direction) > 0)
        return hold(t, support, node, support->direction, bits);
    if (exchanged(bits) != bits)
        return scene_fault(t->scene, support->at, t->error,
                           "u1 and u2 are directions in the surface that a mesh from a file does "
                           "not have; add direction: [x, y, z] for u1, or fix x, y or z");
    t->mesh->constrained[node] |= (uint8_t)bits;
    return 0;
}

/* Hold a node of a set of edges: along the edge and u3. A corner holds both directions. */
static int hold_simple(triads *t, const scene_support *support, size_t node)
{
    const edge_normal *normal = &t->normal[node];
    const bool is_given = vector_dot(support->direction, support->direction) > 0;
    if (!is_given && normal->is_corner) {
        t->mesh->constrained[node] |= ALL;
        return 0;
    }
    return hold(t, support, node, is_given ? support->direction : normal->sum, ALONG_2 | ALONG_3);
}

static int hold_node(triads *t, const scene_support *support, size_t node, const double plane[3])
{
    const unsigned global = support->fix & (FIX_X | FIX_Y | FIX_Z), listed = support->fix & ALL;
    if (support->fix & FIX_SYMMETRIC && hold(t, support, node, plane, ALONG_1) != 0)
        return -1;
    if (support->fix & FIX_SIMPLE && hold_simple(t, support, node) != 0)
        return -1;
    if (global && hold_global(t, support, node, global) != 0)
        return -1;
    return listed ? hold_listed(t, support, node, listed) : 0;
}

/* ---- supports ----------------------------------------------------------- */

/* Find the nodes of a support and, where it depends on edges, their normals. */
static int find_nodes(triads *t, const scene_support *support)
{
    const bool needs_edges = support->fix & (FIX_SIMPLE | FIX_SYMMETRIC) &&
                             vector_dot(support->direction, support->direction) == 0;
    if (scene_mark_nodes(t->scene, &support->where, t->in_set) == 0)
        return scene_fault(t->scene, support->at, t->error,
                           "set '%s' of the mesh file has no nodes", support->where.set);
    if (!needs_edges || find_normals(t, support) > 0)
        return 0;
    return scene_fault(t->scene, support->at, t->error,
                       "this set has no edges, so that '%s' has no direction; name a set of edges, "
                       "or add direction: [x, y, z]",
                       support->fix & FIX_SIMPLE ? "simple" : "symmetric");
}

/* First the directors of all symmetry planes are turned, then the triads are built on them. */
static int turn_directors(triads *t, const scene_support *support)
{
    double normal[3];
    if (!(support->fix & FIX_SYMMETRIC))
        return 0;
    if (find_nodes(t, support) != 0 || plane_normal(t, support, normal) != 0)
        return -1;
    return apply_plane(t, support, normal);
}

static int hold_support(triads *t, const scene_support *support)
{
    double plane[3] = {0, 0, 0};
    if (support->value && support->fix & ~(unsigned)ALL)
        return scene_fault(t->scene, support->at, t->error,
                           "on a mesh from a file a prescribed displacement is u3, or u1 with "
                           "direction: [x, y, z]");
    if (find_nodes(t, support) != 0)
        return -1;
    if (support->fix & FIX_SYMMETRIC && plane_normal(t, support, plane) != 0)
        return -1;
    for (size_t n = 0; n < t->mesh->nodes; n++)
        if (t->in_set[n] && hold_node(t, support, n, plane) != 0)
            return -1;
    return 0;
}

/* Axes that no support has chosen follow the turned directors. */
static void finish_axes(triads *t)
{
    const int common = quad_common_axis(t->mesh);
    for (size_t n = 0; n < t->mesh->nodes; n++)
        if (!t->fixed[n])
            quad_default_axis(t->mesh->director[n], common, t->mesh->axis[n]);
}

/* Apply the supports; those with a value leave their dof free, which the mesh prescribes later. */
static int apply_supports(triads *t)
{
    for (int k = 0; k < t->scene->supports; k++)
        if (turn_directors(t, &t->scene->support[k]) != 0)
            return -1;
    for (int pass = 0; pass < 2; pass++) /* first those whose values may not lose their triad */
        for (int k = 0; k < t->scene->supports; k++) {
            const scene_support *support = &t->scene->support[k];
            if ((support->value != NULL) != (pass == 0))
                continue;
            if (hold_support(t, support) != 0)
                return -1;
            if (pass == 0)
                memset(t->mesh->constrained, 0, t->mesh->nodes);
        }
    finish_axes(t);
    return 0;
}

int check_triads(scene *scene, char *error)
{
    triads t = {.scene = scene, .mesh = &scene->quads->mesh, .error = error};
    const size_t nodes = t.mesh->nodes;
    int status = -1;
    t.mesh->constrained = calloc(nodes, sizeof *t.mesh->constrained);
    t.in_set = calloc(nodes, 1);
    t.fixed = calloc(nodes, 1);
    t.normal = calloc(nodes, sizeof *t.normal);
    if (t.mesh->constrained && t.in_set && t.fixed && t.normal)
        status = apply_supports(&t);
    else
        scene_fault(scene, scene->quads->at, error, "the mesh does not fit into memory");
    free(t.in_set);
    free(t.fixed);
    free(t.normal);
    return status;
}
