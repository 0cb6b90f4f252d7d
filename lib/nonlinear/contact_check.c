/* SPDX-License-Identifier: BSD-2-Clause */
/* Penetration between the nodes and during a load step (contact_check.h). */
#include "contact_check.h"
#include "face.h"
#include "../model/model.h"
#include "../model/shell.h"
#include <string.h>

#if PZS_NONLINEAR

/* Bisections of a side of an element: points are found to within 1/512 of a side. */
enum { SIDE_BISECTIONS = 8 };
/* Bisections of the motion of a point, and steps of the body towards a node. */
enum { MOTION_BISECTIONS = 24, MOTION_STEPS = 32 };
/* Largest sag of an element into the body, relative to the radius of curvature of the body. */
#define SAG_LIMIT ((pzs_real)0.2)

static pzs_real dot(const pzs_real a[3], const pzs_real b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

pzs_real pzs_contact_closed_gap(const pzs_contact *contact)
{
    const pzs_real rounding = 32 * PZS_EPSILON;
    return contact->state.face->size * (rounding > (pzs_real)1e-8 ? rounding : (pzs_real)1e-8);
}

/* ---- positions relative to the body -------------------------------------- */

/* Input value that scales the motion of the body; 0 for a body that does not move. */
static pzs_real body_motion(const pzs_contact *contact, const pzs_solver *solver,
                            const pzs_real *value)
{
    return contact->state.face->input < solver->state.model->state.structure->input.count
               ? value[contact->state.face->input]
               : 0;
}

/*
 * Positions of `count` nodes relative to the moved body, on the face at height z.
 *   u     [free_dof] in  displacement
 *   value [inputs]   in  input values
 *   x     [count][3] out (m)
 */
static void node_positions(const pzs_contact *contact, const pzs_solver *solver,
                           const uint16_t *node, unsigned count, pzs_real z, const pzs_real *u,
                           const pzs_real *value, pzs_real (*x)[3])
{
    const pzs_contact_face *face = contact->state.face;
    const pzs_real up = z - pzs_face_height(solver->state.model->state.structure, face->face);
    const pzs_real moved = body_motion(contact, solver, value);
    pzs_face_gather(solver->state.model, node, count, z, u, x);
    for (unsigned r = 0; r < count; r++) {
        const pzs_real(*triad)[3] = face->triad[node[r]];
        const pzs_real w[3] = {x[r][0], x[r][1], x[r][2] + up};
        for (int i = 0; i < 3; i++)
            x[r][i] = face->place[node[r]][i] - moved * face->motion[i] + w[0] * triad[0][i] +
                      w[1] * triad[1][i] + w[2] * triad[2][i];
    }
}

pzs_real pzs_contact_reach(const pzs_contact *contact, const pzs_structure *structure)
{
    pzs_real most = 0;
    for (uint32_t e = 0; e < structure->elements; e++)
        for (int k = 0; k < 2; k++) {
            const pzs_real *a = contact->state.face->place[structure->element[e][k]];
            const pzs_real *b = contact->state.face->place[structure->element[e][k + 2]];
            const pzs_real d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
            const pzs_real size2 = dot(d, d);
            most = size2 > most ? size2 : most;
        }
    return PZS_SQRT(most) / 2;
}

/* ---- the body at a point ------------------------------------------------- */

typedef struct body_point {
    pzs_real gap, normal[3];
    pzs_real hessian[3][3]; /* second derivatives of the gap along the surface of the body (1/m);
                               the largest curvature is used for the normal direction */
    pzs_real radius;        /* smallest radius of curvature of the body (m); 0: flat */
} body_point;

static pzs_real gap_at(const pzs_contact *contact, const pzs_real x[3], pzs_real normal[3])
{
    pzs_real hessian[3][3];
    return contact->state.body->gap(contact->state.body, x, normal, hessian);
}

/*
 * Larger principal curvature (1/m) from h, the second derivatives of the gap along the surface. It
 * is the larger of the two eigenvalues that are not zero, from trace and Frobenius norm.
 */
static pzs_real largest_curvature(const pzs_real h[3][3])
{
    pzs_real trace = 0, square = 0;
    for (int i = 0; i < 3; i++) {
        trace += h[i][i];
        for (int j = 0; j < 3; j++)
            square += h[i][j] * h[i][j];
    }
    const pzs_real apart2 = 2 * square - trace * trace;
    return (trace + (apart2 > 0 ? PZS_SQRT(apart2) : 0)) / 2;
}

/*
 * Gap, normal and curvature of the body at point x. A surface of constant gap has the radius of the
 * body plus the gap, so the radius of the body is 1/curvature - gap.
 */
static body_point find_body_point(const pzs_contact *contact, const pzs_real x[3])
{
    body_point at;
    pzs_real h[3][3], left[3];
    at.gap = contact->state.body->gap(contact->state.body, x, at.normal, h);
    for (int i = 0; i < 3; i++)
        left[i] = dot(h[i], at.normal);
    const pzs_real across = dot(left, at.normal);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            at.hessian[i][j] = h[i][j] - at.normal[i] * left[j] - left[i] * at.normal[j] +
                               across * at.normal[i] * at.normal[j];
    const pzs_real curvature = largest_curvature((const pzs_real(*)[3])at.hessian);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            at.hessian[i][j] += curvature * at.normal[i] * at.normal[j];
    at.radius = curvature * contact->state.face->size > PZS_EPSILON ? 1 / curvature - at.gap : 0;
    return at;
}

/* d' H d, with H the second derivatives of the gap along the surface */
static pzs_real curvature_along(const body_point *at, const pzs_real d[3])
{
    const pzs_real h[3] = {dot(at->hessian[0], d), dot(at->hessian[1], d), dot(at->hessian[2], d)};
    return dot(h, d);
}

/* ---- one element -------------------------------------------------------- */

/* How and where the body penetrates an element, as in pzs_contact_info. */
typedef struct penetration {
    pzs_penetration how;
    bool is_behind; /* the point lies on a part of the shell that faces away from the body, while
                       another part is in contact */
    uint16_t node;
    pzs_real spot[3], depth;
} penetration;

/*
 * Search of one flat element (facet) for penetration: its corners at the last equilibrium (0) and
 * now (1), and the result.
 */
typedef struct facet_search {
    pzs_contact *contact;
    pzs_real corner[2][4][3];
    bool follows_motion; /* true: search the motion of the points during the load step; false:
                            search the present positions */
    bool is_supported;   /* one of the corners is in contact */
    penetration found;
    pzs_real slope[2]; /* derivatives of the gap by the facet coordinates a and b, at the last point
                          searched (m) */
} facet_search;

/* Point x of a facet at coordinates a, b from 0 to 1. */
static void facet_point(const pzs_real corner[4][3], pzs_real a, pzs_real b, pzs_real x[3])
{
    for (int i = 0; i < 3; i++)
        x[i] = (1 - b) * ((1 - a) * corner[0][i] + a * corner[1][i]) +
               b * ((1 - a) * corner[3][i] + a * corner[2][i]);
}

static pzs_real interpolate(pzs_real t, pzs_real x, pzs_real y)
{
    return x + t * (y - x);
}

/* Derivatives of n . x by a and b, with x the position at time t (0 to 1) of the load step. */
static void find_slopes(facet_search *search, pzs_real a, pzs_real b, pzs_real t,
                        const pzs_real n[3])
{
    pzs_real along[4];
    for (int r = 0; r < 4; r++)
        along[r] = interpolate(t, dot(n, search->corner[0][r]), dot(n, search->corner[1][r]));
    search->slope[0] = interpolate(b, along[1] - along[0], along[2] - along[3]);
    search->slope[1] = interpolate(a, along[3] - along[0], along[2] - along[1]);
}

/*
 * Allowed depth (m) of a point between nodes that lie outside the body. A facet whose corners touch
 * a body of radius R sags into it by the sum of its weights times |corner - point|^2 / (2 R), which
 * is (length)^2 / (8 R) in the middle of a side. This error of the mesh is allowed twice, because
 * the distance is below the gap that a gap function may return, and up to R/5; a facet with
 * diagonals of length R sags by R (1 - sqrt(3/4)). A body smaller than the diagonals may enter only
 * where a corner is in contact, because elsewhere nothing holds it back.
 */
static pzs_real allowed_sag(const facet_search *search, pzs_real a, pzs_real b, const pzs_real x[3],
                            const body_point *at)
{
    const pzs_real weight[4] = {(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b};
    const pzs_real(*corner)[3] = search->corner[1];
    pzs_real sag = 0, diagonal = 0;
    for (int r = 0; r < 4; r++) {
        const pzs_real d[3] = {corner[r][0] - x[0], corner[r][1] - x[1], corner[r][2] - x[2]};
        sag += weight[r] * curvature_along(at, d);
    }
    for (int r = 0; r < 2; r++) {
        const pzs_real *from = corner[r], *to = corner[r + 2];
        const pzs_real d[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
        const pzs_real length = curvature_along(at, d);
        diagonal = length > diagonal ? length : diagonal;
    }
    if (!search->is_supported && diagonal > at->radius)
        return 0;
    const pzs_real most = SAG_LIMIT * at->radius;
    return sag < most ? sag : most;
}

/* Whether a point now lies deeper in the body than is allowed at a node or between nodes. */
static bool is_penetrated(facet_search *search, pzs_real a, pzs_real b)
{
    const pzs_contact *contact = search->contact;
    const bool is_corner = (a == 0 || a == 1) && (b == 0 || b == 1);
    pzs_real x[3];
    facet_point((const pzs_real(*)[3])search->corner[1], a, b, x);
    const body_point at = find_body_point(contact, x);
    find_slopes(search, a, b, 1, at.normal);
    const pzs_real most = 2 * pzs_contact_closed_gap(contact);
    if (at.gap >= -most)
        return false;
    if (!is_corner && at.gap >= -most - allowed_sag(search, a, b, x, &at)) {
        search->contact->info.sag =
            -at.gap > search->contact->info.sag ? -at.gap : search->contact->info.sag;
        return false;
    }
    search->found.depth = -at.gap;
    memcpy(search->found.spot, x, sizeof x);
    return true;
}

/*
 * Follow a point from the front of the body to behind it. The normal at the smallest gap on this
 * way is returned in `normal`. Returns the time of the smallest gap (0 to 1), or -1 if the point
 * has passed through the body.
 */
static pzs_real crossing_time(const pzs_contact *contact, const pzs_real from[3],
                              const pzs_real to[3], pzs_real normal[3])
{
    const pzs_real d[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
    const pzs_real closed = 2 * pzs_contact_closed_gap(contact);
    pzs_real behind[3], low = 0, high = 1;
    const pzs_real gap = gap_at(contact, from, normal);
    if (gap < -closed || !(dot(normal, d) < 0))
        return 0;
    gap_at(contact, to, behind);
    const bool ends_behind = dot(normal, behind) < 0;
    memcpy(normal, behind, sizeof behind);
    if (!(dot(normal, d) > 0))
        return 1;
    for (int i = 0; i < MOTION_BISECTIONS; i++) {
        const pzs_real middle = (low + high) / 2;
        const pzs_real x[3] = {from[0] + middle * d[0], from[1] + middle * d[1],
                               from[2] + middle * d[2]};
        if (gap_at(contact, x, normal) < -closed && ends_behind)
            return -1;
        if (dot(normal, d) > 0)
            high = middle;
        else
            low = middle;
    }
    return low;
}

static bool has_passed(facet_search *search, pzs_real a, pzs_real b)
{
    pzs_real from[3], to[3], normal[3];
    facet_point((const pzs_real(*)[3])search->corner[0], a, b, from);
    facet_point((const pzs_real(*)[3])search->corner[1], a, b, to);
    const pzs_real time = crossing_time(search->contact, from, to, normal);
    find_slopes(search, a, b, time < 0 ? 1 : time, normal);
    if (time >= 0)
        return false;
    search->found.depth = 0;
    memcpy(search->found.spot, to, sizeof to);
    return true;
}

static bool is_faulty(facet_search *search, pzs_real a, pzs_real b)
{
    return search->follows_motion ? has_passed(search, a, b) : is_penetrated(search, a, b);
}

/*
 * Search the line a = constant of a facet, by bisection of the slope towards the smallest gap.
 * Returns whether a fault was found.
 */
static bool search_line(facet_search *search, pzs_real a)
{
    pzs_real low = 0, high = 1;
    for (int i = 0; i <= SIDE_BISECTIONS; i++) {
        const pzs_real middle = (low + high) / 2;
        if (is_faulty(search, a, middle))
            return true;
        if (search->slope[1] > 0)
            high = middle;
        else
            low = middle;
    }
    return false;
}

/*
 * Search the smallest gap of all lines by bisection of the slope. On a flat facet it is the
 * smallest gap of the facet, because both functions are convex. Returns whether a fault was found.
 */
static bool search_facet_points(facet_search *search)
{
    pzs_real low = 0, high = 1;
    for (int i = 0; i <= SIDE_BISECTIONS; i++) {
        const pzs_real middle = (low + high) / 2;
        if (search_line(search, middle))
            return true;
        if (search->slope[0] > 0)
            high = middle;
        else
            low = middle;
    }
    return false;
}

/*
 * Whether the facet stays in front of one tangent plane of the body at all times of the load step.
 * The plane is that nearest to the middle of the facet at time k; a convex body lies behind it.
 */
static bool is_separated(const facet_search *search, int k)
{
    pzs_real x[3], n[3];
    facet_point(search->corner[k], (pzs_real)0.5, (pzs_real)0.5, x);
    const pzs_real gap = gap_at(search->contact, x, n) - dot(n, x);
    for (int i = 0; i < 8; i++)
        if (!(gap + dot(n, search->corner[i / 4][i % 4]) > 0))
            return false;
    return true;
}

/*
 * Search a facet for penetration and passing through. The result is search->found; its node is a
 * corner number 0 to 3, or PZS_CONSTRAINED.
 */
static void search_facet(facet_search *search)
{
    static const uint8_t side[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    static const pzs_penetration at_node[2] = {PZS_PENETRATION_AT_NODE, PZS_PENETRATION_PASSED};
    static const pzs_penetration between[2] = {PZS_PENETRATION_BETWEEN_NODES,
                                               PZS_PENETRATION_PASSED};
    search->found.node = PZS_CONSTRAINED;
    if (is_separated(search, 1) || is_separated(search, 0))
        return;
    for (int k = 0; k < 2; k++) {
        search->follows_motion = k == 1;
        for (uint8_t r = 0; r < SHELL_NODES; r++)
            if (is_faulty(search, side[r][0], side[r][1])) {
                search->found.node = r;
                search->found.how = at_node[k];
                return;
            }
        if (search_facet_points(search)) {
            search->found.how = between[k];
            return;
        }
    }
}

/*
 * Whether the contact face points away from the body in the middle of the facet, now and at the
 * last equilibrium.
 */
static bool faces_away(const facet_search *search)
{
    for (int k = 0; k < 2; k++) {
        const pzs_real(*x)[3] = search->corner[k];
        const pzs_real d[3] = {x[2][0] - x[0][0], x[2][1] - x[0][1], x[2][2] - x[0][2]};
        const pzs_real e[3] = {x[3][0] - x[1][0], x[3][1] - x[1][1], x[3][2] - x[1][2]};
        pzs_real middle[3], normal[3], up[3];
        facet_point(x, (pzs_real)0.5, (pzs_real)0.5, middle);
        gap_at(search->contact, middle, normal);
        pzs_face_cross(d, e, up);
        const pzs_real facing = dot(up, normal);
        if ((search->contact->state.face->face == 0 ? -facing : facing) < 0)
            return false;
    }
    return true;
}

static penetration check_element(pzs_contact *contact, const pzs_solver *solver, uint32_t e,
                                 pzs_real z)
{
    const uint16_t *node = solver->state.model->state.structure->element[e];
    facet_search search = {.contact = contact};
    node_positions(contact, solver, node, SHELL_NODES, z, solver->state.converged_displacement,
                   solver->state.converged_input_value, search.corner[0]);
    node_positions(contact, solver, node, SHELL_NODES, z, solver->state.displacement,
                   solver->state.input_value, search.corner[1]);
    for (unsigned r = 0; r < SHELL_NODES; r++)
        search.is_supported |= contact->state.touching[node[r]] != 0;
    search_facet(&search);
    if (search.found.node != PZS_CONSTRAINED)
        search.found.node = node[search.found.node];
    search.found.is_behind = search.found.how != PZS_PENETRATION_NONE && contact->info.nodes > 0 &&
                             search.found.how != PZS_PENETRATION_PASSED && faces_away(&search);
    return search.found;
}

static void write_info(pzs_contact *contact, const pzs_solver *solver, const penetration *found,
                       uint32_t e, uint8_t side)
{
    const pzs_real moved = body_motion(contact, solver, solver->state.input_value);
    contact->info.penetration = found->how;
    contact->info.side = side;
    contact->info.element = (uint16_t)e;
    contact->info.node = found->node;
    contact->info.depth = found->depth;
    for (int i = 0; i < 3; i++)
        contact->info.spot[i] = found->spot[i] + moved * contact->state.face->motion[i];
}

pzs_status pzs_contact_check(pzs_contact *contact, const pzs_solver *solver)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    pzs_status status = PZS_OK;
    contact->info.sag = 0;
    contact->info.depth = 0;
    contact->info.penetration = PZS_PENETRATION_NONE;
    for (uint32_t i = 0; i < 2 * (uint32_t)structure->elements && !PZS_IS_ERROR(status); i++) {
        const uint32_t e = i % structure->elements;
        const uint8_t side =
            i < structure->elements ? contact->state.face->face : 1 - contact->state.face->face;
        const penetration found =
            check_element(contact, solver, e, pzs_face_height(structure, side));
        if (found.how == PZS_PENETRATION_NONE ||
            (found.is_behind && status == PZS_W_BEHIND && found.depth <= contact->info.depth))
            continue;
        status = found.is_behind ? PZS_W_BEHIND : PZS_E_PENETRATION;
        write_info(contact, solver, &found, e, side);
    }
    return status;
}

/* ---- length of a load step ---------------------------------------------- */

/*
 * Part (0 to 1) of the motion d of the body after which its gap to point x is `near`. The gap falls
 * by at most |d|, so each step moves by the remaining gap.
 */
static pzs_real free_motion(const pzs_contact *contact, const pzs_real x[3], const pzs_real d[3],
                            pzs_real near)
{
    const pzs_real length = PZS_SQRT(dot(d, d));
    pzs_real part = 0;
    for (int i = 0; i < MOTION_STEPS && part < 1; i++) {
        const pzs_real at[3] = {x[0] - part * d[0], x[1] - part * d[1], x[2] - part * d[2]};
        pzs_real normal[3];
        const pzs_real left = gap_at(contact, at, normal) - near;
        if (left > 0 && dot(normal, d) <= 0)
            return 1;
        if (!(left > near / 16))
            break;
        part += left / length;
    }
    return part < 1 ? part : 1;
}

pzs_real pzs_contact_largest_part(const pzs_contact *contact, const pzs_solver *solver,
                                  const pzs_real *value)
{
    const pzs_contact_face *face = contact->state.face;
    const pzs_real moved = body_motion(contact, solver, value) -
                           body_motion(contact, solver, solver->state.converged_input_value);
    const pzs_real d[3] = {moved * face->motion[0], moved * face->motion[1],
                           moved * face->motion[2]};
    const pzs_real length = PZS_SQRT(dot(d, d)),
                   z = pzs_face_height(solver->state.model->state.structure, face->face);
    pzs_real part = 1, radius = face->size;
    for (uint16_t n = 0; length > 0 && n < solver->state.model->state.structure->nodes; n++) {
        pzs_real x[1][3];
        node_positions(contact, solver, &n, 1, z, solver->state.converged_displacement,
                       solver->state.converged_input_value, x);
        const body_point at = find_body_point(contact, x[0]);
        const pzs_real most = free_motion(contact, x[0], d, contact->state.reach);
        part = most < part ? most : part;
        radius = at.radius > 0 && at.radius < radius ? at.radius : radius;
    }
    const pzs_real whole = length > 0 && part < 1 ? part + radius / (2 * length) : 1;
    return whole < 1 ? whole : 1;
}

#endif
