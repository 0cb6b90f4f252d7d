/* Penetration between the nodes and on the way (contact_check.h). */
#include "contact_check.h"
#include "face.h"
#include "../model/model.h"
#include "../model/shell.h"
#include <string.h>

#if PZS_NONLINEAR

/* Bisections of an element's sides: points are found to 1/512 of a side. */
enum { HALVINGS = 8 };
/* Bisections of the way of a point, and steps along it up to the body. */
enum { WAY_HALVINGS = 24, WAY_STEPS = 32 };
/* A facet may sag into the body by this part of its radius (see allowed). */
#define MOST_SAG ((pzs_real)0.2)

static pzs_real dot(const pzs_real a[3], const pzs_real b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

pzs_real contact_closed(const pzs_contact *contact)
{
    const pzs_real rounding = 32 * PZS_EPSILON;
    return contact->state.face->size * (rounding > (pzs_real)1e-8 ? rounding : (pzs_real)1e-8);
}

/* ---- places in the frame of the body ------------------------------------ */

/* Amount of the body's motion among the amounts; 0 for a body that stays. */
static pzs_real motion_of(const pzs_contact *contact, const pzs_solver *solver,
                          const pzs_real *amount)
{
    return contact->state.face->input < solver->state.model->state.structure->input.count
               ? amount[contact->state.face->input]
               : 0;
}

/*
 * Places of `count` nodes, on the face at height z, as the body sees them.
 *   u      [dof]      in
 *   amount [inputs]   in
 *   x      [count][3] out
 */
static void find_places(const pzs_contact *contact, const pzs_solver *solver, const uint16_t *node,
                        unsigned count, pzs_real z, const pzs_real *u, const pzs_real *amount,
                        pzs_real (*x)[3])
{
    const pzs_contact_face *face = contact->state.face;
    const pzs_real up = z - pzs_face_height(solver->state.model->state.structure, face->face);
    const pzs_real moved = motion_of(contact, solver, amount);
    pzs_face_gather(solver->state.model, node, count, z, u, x);
    for (unsigned r = 0; r < count; r++) {
        const pzs_real(*triad)[3] = face->triad[node[r]];
        const pzs_real w[3] = {x[r][0], x[r][1], x[r][2] + up};
        for (int i = 0; i < 3; i++)
            x[r][i] = face->place[node[r]][i] - moved * face->motion[i] + w[0] * triad[0][i] +
                      w[1] * triad[1][i] + w[2] * triad[2][i];
    }
}

pzs_real contact_reach(const pzs_contact *contact, const pzs_structure *structure)
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

/* ---- the body near a point ---------------------------------------------- */

typedef struct nearby {
    pzs_real gap, normal[3];
    pzs_real bend[3][3]; /* second derivatives along the surface; the largest curvature stands in
                            for that across it */
    pzs_real radius;     /* smallest radius of curvature of the body; 0: flat */
} nearby;

static pzs_real gap_at(const pzs_contact *contact, const pzs_real x[3], pzs_real normal[3])
{
    pzs_real hessian[3][3];
    return contact->state.body->gap(contact->state.body, x, normal, hessian);
}

/* The larger eigenvalue of P H P, P = 1 - n n'. Its trace and Frobenius norm give both of them. */
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

/* Distances grow by 1 with each unit of the gap, and so do their radii: the body's own is
 * 1/curvature - gap. */
static nearby body_at(const pzs_contact *contact, const pzs_real x[3])
{
    nearby at;
    pzs_real h[3][3], left[3];
    at.gap = contact->state.body->gap(contact->state.body, x, at.normal, h);
    for (int i = 0; i < 3; i++)
        left[i] = dot(h[i], at.normal);
    const pzs_real across = dot(left, at.normal);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            at.bend[i][j] = h[i][j] - at.normal[i] * left[j] - left[i] * at.normal[j] +
                            across * at.normal[i] * at.normal[j];
    const pzs_real curvature = largest_curvature((const pzs_real(*)[3])at.bend);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            at.bend[i][j] += curvature * at.normal[i] * at.normal[j];
    at.radius = curvature * contact->state.face->size > PZS_EPSILON ? 1 / curvature - at.gap : 0;
    return at;
}

/* d' bend d */
static pzs_real bend_along(const nearby *at, const pzs_real d[3])
{
    const pzs_real h[3] = {dot(at->bend[0], d), dot(at->bend[1], d), dot(at->bend[2], d)};
    return dot(h, d);
}

/* ---- one element -------------------------------------------------------- */

/* How and where the body penetrates an element, as in pzs_contact. how 0: it does not. */
typedef struct finding {
    uint8_t how;
    int is_behind; /* on a part of the shell that faces away from the body, which another part
                      carries */
    uint16_t node;
    pzs_real spot[3], depth;
} finding;

/* A facet between the corners of an element, at the last equilibrium and now, and what is found
 * on it. */
typedef struct facet {
    pzs_contact *contact;
    pzs_real corner[2][4][3];
    int on_the_way; /* search the way of its points, not only where they are */
    int supported;  /* one of its corners is in contact */
    finding found;
    pzs_real slope[2]; /* of the least gap of a point with a, b, at the last one visited */
} facet;

/* Place at a, b in 0 ... 1. */
static void place_in(const pzs_real corner[4][3], pzs_real a, pzs_real b, pzs_real x[3])
{
    for (int i = 0; i < 3; i++)
        x[i] = (1 - b) * ((1 - a) * corner[0][i] + a * corner[1][i]) +
               b * ((1 - a) * corner[3][i] + a * corner[2][i]);
}

static pzs_real mix(pzs_real t, pzs_real x, pzs_real y)
{
    return x + t * (y - x);
}

/* Slopes of n . x with a and b, x at time t of the way. */
static void find_slopes(facet *f, pzs_real a, pzs_real b, pzs_real t, const pzs_real n[3])
{
    pzs_real along[4];
    for (int r = 0; r < 4; r++)
        along[r] = mix(t, dot(n, f->corner[0][r]), dot(n, f->corner[1][r]));
    f->slope[0] = mix(b, along[1] - along[0], along[2] - along[3]);
    f->slope[1] = mix(a, along[3] - along[0], along[2] - along[1]);
}

/*
 * How deep a point between nodes that are outside may lie in the body. A facet whose corners touch
 * a body of radius R sags into it by the sum of its weights times |corner - point|^2 / (2 R):
 * (length)^2 / (8 R) in the middle of a side. This error of the mesh is allowed twice, as the gap
 * of a formula may exceed the distance, and up to R/5: a facet with diagonals of R sags by R (1 -
 * sqrt(3/4)). A body smaller than the diagonals may only enter next to a node that it touches:
 * elsewhere nothing holds it back.
 */
static pzs_real allowed(const facet *f, pzs_real a, pzs_real b, const pzs_real x[3],
                        const nearby *at)
{
    const pzs_real weight[4] = {(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b};
    const pzs_real(*corner)[3] = f->corner[1];
    pzs_real sag = 0, diagonal = 0;
    for (int r = 0; r < 4; r++) {
        const pzs_real d[3] = {corner[r][0] - x[0], corner[r][1] - x[1], corner[r][2] - x[2]};
        sag += weight[r] * bend_along(at, d);
    }
    for (int r = 0; r < 2; r++) {
        const pzs_real *from = corner[r], *to = corner[r + 2];
        const pzs_real d[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
        const pzs_real length = bend_along(at, d);
        diagonal = length > diagonal ? length : diagonal;
    }
    if (!f->supported && diagonal > at->radius)
        return 0;
    const pzs_real most = MOST_SAG * at->radius;
    return sag < most ? sag : most;
}

/* Is a point now deeper in the body than a node or a sagging facet may be? */
static int is_inside(facet *f, pzs_real a, pzs_real b)
{
    const pzs_contact *contact = f->contact;
    const int is_corner = (a == 0 || a == 1) && (b == 0 || b == 1);
    pzs_real x[3];
    place_in((const pzs_real(*)[3])f->corner[1], a, b, x);
    const nearby at = body_at(contact, x);
    find_slopes(f, a, b, 1, at.normal);
    const pzs_real most = 2 * contact_closed(contact);
    if (at.gap >= -most)
        return 0;
    if (!is_corner && at.gap >= -most - allowed(f, a, b, x, &at)) {
        f->contact->info.sag = -at.gap > f->contact->info.sag ? -at.gap : f->contact->info.sag;
        return 0;
    }
    f->found.depth = -at.gap;
    memcpy(f->found.spot, x, sizeof x);
    return 1;
}

/*
 * Has a point come from before the body to behind it, through the body? The normal of the least gap
 * on the way into `normal`; returns the time, 0 to 1, or -1: it has.
 */
static pzs_real follow(const pzs_contact *contact, const pzs_real from[3], const pzs_real to[3],
                       pzs_real normal[3])
{
    const pzs_real d[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
    const pzs_real closed = 2 * contact_closed(contact);
    pzs_real behind[3], low = 0, high = 1;
    const pzs_real gap = gap_at(contact, from, normal);
    if (gap < -closed || !(dot(normal, d) < 0))
        return 0;
    gap_at(contact, to, behind);
    const int passes = dot(normal, behind) < 0;
    memcpy(normal, behind, sizeof behind);
    if (!(dot(normal, d) > 0))
        return 1;
    for (int i = 0; i < WAY_HALVINGS; i++) {
        const pzs_real middle = (low + high) / 2;
        const pzs_real x[3] = {from[0] + middle * d[0], from[1] + middle * d[1],
                               from[2] + middle * d[2]};
        if (gap_at(contact, x, normal) < -closed && passes)
            return -1;
        if (dot(normal, d) > 0)
            high = middle;
        else
            low = middle;
    }
    return low;
}

static int has_passed(facet *f, pzs_real a, pzs_real b)
{
    pzs_real from[3], to[3], normal[3];
    place_in((const pzs_real(*)[3])f->corner[0], a, b, from);
    place_in((const pzs_real(*)[3])f->corner[1], a, b, to);
    const pzs_real time = follow(f->contact, from, to, normal);
    find_slopes(f, a, b, time < 0 ? 1 : time, normal);
    if (time >= 0)
        return 0;
    f->found.depth = 0;
    memcpy(f->found.spot, to, sizeof to);
    return 1;
}

static int visit(facet *f, pzs_real a, pzs_real b)
{
    return f->on_the_way ? has_passed(f, a, b) : is_inside(f, a, b);
}

/* From a side of the facet at `a` to the other, towards the least gap. */
static int search_line(facet *f, pzs_real a)
{
    pzs_real low = 0, high = 1;
    for (int i = 0; i <= HALVINGS; i++) {
        const pzs_real middle = (low + high) / 2;
        if (visit(f, a, middle))
            return 1;
        if (f->slope[1] > 0)
            high = middle;
        else
            low = middle;
    }
    return 0;
}

/* The least of the least gaps on its lines: on a flat facet the least of all, as both are
 * convex. */
static int search(facet *f)
{
    pzs_real low = 0, high = 1;
    for (int i = 0; i <= HALVINGS; i++) {
        const pzs_real middle = (low + high) / 2;
        if (search_line(f, middle))
            return 1;
        if (f->slope[0] > 0)
            high = middle;
        else
            low = middle;
    }
    return 0;
}

/* Has the body, at every time of the way, been behind its tangent plane next to the middle of
 * the facet at time k? */
static int is_apart(const facet *f, int k)
{
    pzs_real x[3], n[3];
    place_in(f->corner[k], (pzs_real)0.5, (pzs_real)0.5, x);
    const pzs_real gap = gap_at(f->contact, x, n) - dot(n, x);
    for (int i = 0; i < 8; i++)
        if (!(gap + dot(n, f->corner[i / 4][i % 4]) > 0))
            return 0;
    return 1;
}

/* Search a facet; f->found tells. Corners are corner numbers yet. */
static void search_facet(facet *f)
{
    static const uint8_t side[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    f->found.node = PZS_CONSTRAINED;
    if (is_apart(f, 1) || is_apart(f, 0))
        return;
    for (f->on_the_way = 0; f->on_the_way < 2; f->on_the_way++) {
        for (uint8_t r = 0; r < SHELL_NODES; r++)
            if (visit(f, side[r][0], side[r][1])) {
                f->found.node = r;
                f->found.how = f->on_the_way ? PZS_PENETRATION_PASSED : PZS_PENETRATION_AT_NODE;
                return;
            }
        if (search(f)) {
            f->found.how = f->on_the_way ? PZS_PENETRATION_PASSED : PZS_PENETRATION_BETWEEN_NODES;
            return;
        }
    }
}

/* Does the face that may touch look away from the body, in the middle of a facet, now and at the
 * last equilibrium? */
static int looks_away(const facet *f)
{
    for (int k = 0; k < 2; k++) {
        const pzs_real(*x)[3] = f->corner[k];
        const pzs_real d[3] = {x[2][0] - x[0][0], x[2][1] - x[0][1], x[2][2] - x[0][2]};
        const pzs_real e[3] = {x[3][0] - x[1][0], x[3][1] - x[1][1], x[3][2] - x[1][2]};
        pzs_real middle[3], normal[3], up[3];
        place_in(x, (pzs_real)0.5, (pzs_real)0.5, middle);
        gap_at(f->contact, middle, normal);
        pzs_face_cross(d, e, up);
        const pzs_real facing = dot(up, normal);
        if ((f->contact->state.face->face == 0 ? -facing : facing) < 0)
            return 0;
    }
    return 1;
}

static finding element_fault(pzs_contact *contact, const pzs_solver *solver, uint32_t e, pzs_real z)
{
    const uint16_t *node = solver->state.model->state.structure->element[e];
    facet f = {.contact = contact};
    find_places(contact, solver, node, SHELL_NODES, z, solver->state.kept_displacement,
                solver->state.kept_input_value, f.corner[0]);
    find_places(contact, solver, node, SHELL_NODES, z, solver->state.displacement,
                solver->state.input_value, f.corner[1]);
    for (unsigned r = 0; r < SHELL_NODES; r++)
        f.supported |= contact->state.touching[node[r]];
    search_facet(&f);
    if (f.found.node != PZS_CONSTRAINED)
        f.found.node = node[f.found.node];
    f.found.is_behind = f.found.how && contact->info.nodes > 0 &&
                        f.found.how != PZS_PENETRATION_PASSED && looks_away(&f);
    return f.found;
}

static void report(pzs_contact *contact, const pzs_solver *solver, const finding *found, uint32_t e,
                   uint8_t side)
{
    const pzs_real moved = motion_of(contact, solver, solver->state.input_value);
    contact->info.penetration = found->how;
    contact->info.side = side;
    contact->info.element = (uint16_t)e;
    contact->info.node = found->node;
    contact->info.depth = found->depth;
    for (int i = 0; i < 3; i++)
        contact->info.spot[i] = found->spot[i] + moved * contact->state.face->motion[i];
}

pzs_status contact_check(pzs_contact *contact, const pzs_solver *solver)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    pzs_status status = PZS_OK;
    contact->info.sag = 0;
    contact->info.depth = 0;
    contact->info.penetration = 0;
    for (uint32_t i = 0; i < 2 * (uint32_t)structure->elements && !PZS_IS_ERROR(status); i++) {
        const uint32_t e = i % structure->elements;
        const uint8_t side =
            i < structure->elements ? contact->state.face->face : 1 - contact->state.face->face;
        const finding found = element_fault(contact, solver, e, pzs_face_height(structure, side));
        if (!found.how ||
            (found.is_behind && status == PZS_W_BEHIND && found.depth <= contact->info.depth))
            continue;
        status = found.is_behind ? PZS_W_BEHIND : PZS_E_PENETRATION;
        report(contact, solver, &found, e, side);
    }
    return status;
}

/* ---- length of a load step ---------------------------------------------- */

/* Part of the body's way d, from 0 to 1, after which it is as near to x as `near`: gaps fall by
 * at most |d|. */
static pzs_real free_part(const pzs_contact *contact, const pzs_real x[3], const pzs_real d[3],
                          pzs_real near)
{
    const pzs_real length = PZS_SQRT(dot(d, d));
    pzs_real part = 0;
    for (int i = 0; i < WAY_STEPS && part < 1; i++) {
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

pzs_real contact_longest(const pzs_contact *contact, const pzs_solver *solver,
                         const pzs_real *amount)
{
    const pzs_contact_face *face = contact->state.face;
    const pzs_real moved = motion_of(contact, solver, amount) -
                           motion_of(contact, solver, solver->state.kept_input_value);
    const pzs_real d[3] = {moved * face->motion[0], moved * face->motion[1],
                           moved * face->motion[2]};
    const pzs_real length = PZS_SQRT(dot(d, d)),
                   z = pzs_face_height(solver->state.model->state.structure, face->face);
    pzs_real part = 1, radius = face->size;
    for (uint16_t n = 0; length > 0 && n < solver->state.model->state.structure->nodes; n++) {
        pzs_real x[1][3];
        find_places(contact, solver, &n, 1, z, solver->state.kept_displacement,
                    solver->state.kept_input_value, x);
        const nearby at = body_at(contact, x[0]);
        const pzs_real most = free_part(contact, x[0], d, contact->state.reach);
        part = most < part ? most : part;
        radius = at.radius > 0 && at.radius < radius ? at.radius : radius;
    }
    const pzs_real whole = length > 0 && part < 1 ? part + radius / (2 * length) : 1;
    return whole < 1 ? whole : 1;
}

#endif
