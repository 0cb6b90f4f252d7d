/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Check of a contact for penetration of the shell by the body, between the nodes and during a load
 * step (contact_check.h).
 */
#include "contact_check.h"
#include "face.h"
#include "../core/vector3.h"
#include "../model/model.h"
#include "../model/shell.h"
#include <string.h>

#if PZS_NONLINEAR

/*
 * Number of bisections in the search for the smallest gap to the contact body along a side of an
 * element; it finds positions to within 1/512 of the length of the side.
 */
enum { SIDE_BISECTIONS = 8 };
/*
 * MOTION_BISECTIONS: number of bisections that find the smallest gap between a point of the shell
 * and the contact body during a load step. MOTION_STEPS: largest number of steps that find how far
 * the body may move in a load step before its gap to a point of the shell falls below a bound.
 */
enum { MOTION_BISECTIONS = 24, MOTION_STEPS = 32 };
/*
 * Largest accepted depth to which a flat element may enter a curved contact body, relative to the
 * radius of curvature of the body.
 */
#define SAG_LIMIT ((pzs_real)0.2)

pzs_real pzs_contact_closed_gap(const pzs_contact *contact)
{
    const pzs_real rounding = 32 * PZS_EPSILON;
    return contact->state.face->size * (rounding > (pzs_real)1e-8 ? rounding : (pzs_real)1e-8);
}

/* ---- positions relative to the body -------------------------------------- */

/*
 * Return the input value that scales the motion of the contact body, or 0 for a body that does not
 * move.
 */
static pzs_real body_motion(const pzs_contact *contact, const pzs_solver *solver,
                            const pzs_real *value)
{
    return contact->state.face->input < solver->state.model->state.structure->input.count
               ? value[contact->state.face->input]
               : 0;
}

/*
 * Compute the positions of `count` nodes of one face of the shell relative to the moved contact
 * body.
 *   height                  in   height of the face above the middle of the shell (m)
 *   displacement [free_dof] in   displacement (m, or 1 for differences over the thickness)
 *   value        [inputs]   in   input values
 *   position     [count][3] out  positions (m)
 */
static void node_positions(const pzs_contact *contact, const pzs_solver *solver,
                           const uint16_t *node, unsigned count, pzs_real height,
                           const pzs_real *displacement, const pzs_real *value,
                           pzs_real (*position)[3])
{
    const pzs_contact_face *face = contact->state.face;
    const pzs_real up = height - pzs_face_height(solver->state.model->state.structure, face->face);
    const pzs_real moved = body_motion(contact, solver, value);
    pzs_face_gather(solver->state.model, node, count, height, displacement, position);
    for (unsigned corner = 0; corner < count; corner++) {
        const pzs_real(*triad)[3] = face->triad[node[corner]];
        const pzs_real offset[3] = {position[corner][0], position[corner][1],
                                    position[corner][2] + up};
        for (int i = 0; i < 3; i++)
            position[corner][i] = face->place[node[corner]][i] - moved * face->motion[i] +
                                  offset[0] * triad[0][i] + offset[1] * triad[1][i] +
                                  offset[2] * triad[2][i];
    }
}

pzs_real pzs_contact_reach(const pzs_contact *contact, const pzs_structure *structure)
{
    pzs_real most = 0;
    for (uint32_t element = 0; element < structure->elements; element++)
        for (int k = 0; k < 2; k++) {
            const pzs_real *from = contact->state.face->place[structure->element[element][k]];
            const pzs_real *to = contact->state.face->place[structure->element[element][k + 2]];
            const pzs_real diagonal[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
            const pzs_real size2 = vector3_dot(diagonal, diagonal);
            most = size2 > most ? size2 : most;
        }
    return PZS_SQRT(most) / 2;
}

/* ---- the body at a point ------------------------------------------------- */

typedef struct body_point {
    pzs_real gap, normal[3];
    /*
     * matrix H that bounds the curvature of the contact body (1/m): d'H d is the second derivative
     * of the gap along a vector d in the tangent plane of the body. Along the normal, H has the
     * largest curvature, so that d'H d is not too small for any d
     */
    pzs_real hessian[3][3];
    pzs_real radius; /* smallest radius of curvature of the contact body (m); 0: the body is flat */
} body_point;

static pzs_real gap_at(const pzs_contact *contact, const pzs_real position[3], pzs_real normal[3])
{
    pzs_real hessian[3][3];
    return contact->state.body->gap(contact->state.body, position, normal, hessian);
}

/*
 * Return the larger principal curvature (1/m) of the contact body, from the second derivatives of
 * the gap along its surface. Their matrix has two eigenvalues that may differ from zero; the larger
 * one follows from trace and Frobenius norm.
 */
static pzs_real largest_curvature(const pzs_real hessian[3][3])
{
    pzs_real trace = 0, square = 0;
    for (int i = 0; i < 3; i++) {
        trace += hessian[i][i];
        for (int j = 0; j < 3; j++)
            square += hessian[i][j] * hessian[i][j];
    }
    const pzs_real apart2 = 2 * square - trace * trace;
    return (trace + (apart2 > 0 ? PZS_SQRT(apart2) : 0)) / 2;
}

/*
 * Compute the gap between a point and the contact body, and the normal and curvature of the body
 * there. A surface of constant gap has the radius of the body plus the gap, so the radius of the
 * body is 1/curvature - gap.
 */
static body_point find_body_point(const pzs_contact *contact, const pzs_real position[3])
{
    body_point at;
    pzs_real hessian[3][3], left[3];
    at.gap = contact->state.body->gap(contact->state.body, position, at.normal, hessian);
    for (int i = 0; i < 3; i++)
        left[i] = vector3_dot(hessian[i], at.normal);
    const pzs_real across = vector3_dot(left, at.normal);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            at.hessian[i][j] = hessian[i][j] - at.normal[i] * left[j] - left[i] * at.normal[j] +
                               across * at.normal[i] * at.normal[j];
    const pzs_real curvature = largest_curvature((const pzs_real(*)[3])at.hessian);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            at.hessian[i][j] += curvature * at.normal[i] * at.normal[j];
    at.radius = curvature * contact->state.face->size > PZS_EPSILON ? 1 / curvature - at.gap : 0;
    return at;
}

/*
 * Return the second derivative d'H d of the gap along a vector d. The matrix H holds the second
 * derivatives of the gap along the surface of the body.
 */
static pzs_real curvature_along(const body_point *at, const pzs_real direction[3])
{
    const pzs_real product[3] = {vector3_dot(at->hessian[0], direction),
                                 vector3_dot(at->hessian[1], direction),
                                 vector3_dot(at->hessian[2], direction)};
    return vector3_dot(product, direction);
}

/* ---- one element -------------------------------------------------------- */

/*
 * Place and kind of a penetration of an element by the contact body, which pzs_contact_info
 * reports.
 */
typedef struct penetration {
    pzs_penetration how;
    bool is_behind; /* whether the penetrated point lies on a part of the shell that faces away from
                       the contact body, while another part of the shell is in contact */
    uint16_t node;
    pzs_real spot[3], depth;
} penetration;

/*
 * Search for points where the contact body penetrates one element of the shell, which is taken as a
 * flat facet. corner[0][4] are the positions of the corners of the facet at the last equilibrium,
 * corner[1][4] those at the present displacement (m).
 */
typedef struct facet_search {
    pzs_contact *contact;
    pzs_real corner[2][4][3];
    bool follows_motion; /* true: the search for penetration follows the motion of the points of the
                            facet (element) during the load step; false: it checks their present
                            positions */
    bool is_supported;   /* whether at least one corner of the facet (element of the shell) is in
                            contact with the body */
    penetration found;
    pzs_real slope[2]; /* derivatives of the gap to the contact body with respect to the two
                          coordinates (0 to 1) of the facet, an element of the shell, at the last
                          point searched (m) */
} facet_search;

/*
 * Compute the position of a point of a flat facet (element of the shell), given its two facet
 * coordinates from 0 to 1.
 */
static void facet_point(const pzs_real corner[4][3], pzs_real along, pzs_real across,
                        pzs_real position[3])
{
    for (int i = 0; i < 3; i++)
        position[i] = (1 - across) * ((1 - along) * corner[0][i] + along * corner[1][i]) +
                      across * ((1 - along) * corner[3][i] + along * corner[2][i]);
}

static pzs_real interpolate(pzs_real part, pzs_real from, pzs_real to)
{
    return from + part * (to - from);
}

/*
 * Compute into search->slope (m) how the distance of a point of a flat facet (element of the shell)
 * from the contact body, along the normal of the body, changes with the two facet coordinates of
 * the point: its two derivatives.
 *   along, across in  facet coordinates of the point (0 to 1)
 *   time          in  time within the load step (0 to 1), at which the positions are interpolated
 *   normal [3]    in  normal of the body (dimensionless)
 */
static void find_slopes(facet_search *search, pzs_real along, pzs_real across, pzs_real time,
                        const pzs_real normal[3])
{
    pzs_real distance[4];
    for (int corner = 0; corner < 4; corner++)
        distance[corner] = interpolate(time, vector3_dot(normal, search->corner[0][corner]),
                                       vector3_dot(normal, search->corner[1][corner]));
    search->slope[0] = interpolate(across, distance[1] - distance[0], distance[2] - distance[3]);
    search->slope[1] = interpolate(along, distance[3] - distance[0], distance[2] - distance[1]);
}

/*
 * Return the depth (m) to which a point of a flat facet may lie in the contact body although all
 * nodes of the facet lie outside. It is twice the depth that a body of radius R has in a facet
 * whose corners it touches, about
 *   sum over the corners of N d^2 / (2 R)
 *   d  distance from the point to the corner
 *   N  shape function of the corner at the point
 */
static pzs_real allowed_sag(const facet_search *search, pzs_real along, pzs_real across,
                            const pzs_real position[3], const body_point *at)
{
    const pzs_real weight[4] = {(1 - along) * (1 - across), along * (1 - across), along * across,
                                (1 - along) * across};
    const pzs_real(*corner)[3] = search->corner[1];
    // curvature_along returns about d^2 / R for a corner at the distance d (m), so that `sag`
    // becomes twice the depth sum(N d^2 / (2 R)) of the body between the corners. The factor of two
    // is a reserve, because the gap function of a body may exceed its true distance.
    pzs_real sag = 0, diagonal = 0;
    for (int index = 0; index < 4; index++) {
        const pzs_real offset[3] = {corner[index][0] - position[0], corner[index][1] - position[1],
                                    corner[index][2] - position[2]};
        sag += weight[index] * curvature_along(at, offset);
    }
    for (int index = 0; index < 2; index++) {
        const pzs_real *from = corner[index], *to = corner[index + 2];
        const pzs_real offset[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
        const pzs_real length = curvature_along(at, offset);
        diagonal = length > diagonal ? length : diagonal;
    }
    // If a diagonal of the facet is longer than the body's radius of curvature, the body could slip
    // between the nodes. It must then not enter the facet at all, unless a corner of the facet is
    // in contact.
    if (!search->is_supported && diagonal > at->radius)
        return 0;
    // The body may enter a facet by at most SAG_LIMIT (a fifth) of its radius of curvature. This is
    // enough for all facets whose diagonals are not longer than that radius.
    const pzs_real most = SAG_LIMIT * at->radius;
    return sag < most ? sag : most;
}

/*
 * Whether a point of a facet of the shell lies, at the present displacement, deeper in the contact
 * body than is allowed at a node or between nodes.
 */
static bool is_penetrated(facet_search *search, pzs_real along, pzs_real across)
{
    const pzs_contact *contact = search->contact;
    const bool is_corner = (along == 0 || along == 1) && (across == 0 || across == 1);
    pzs_real position[3];
    facet_point((const pzs_real(*)[3])search->corner[1], along, across, position);
    const body_point at = find_body_point(contact, position);
    find_slopes(search, along, across, 1, at.normal);
    const pzs_real most = 2 * pzs_contact_closed_gap(contact);
    if (at.gap >= -most)
        return false;
    if (!is_corner && at.gap >= -most - allowed_sag(search, along, across, position, &at)) {
        search->contact->info.sag =
            -at.gap > search->contact->info.sag ? -at.gap : search->contact->info.sag;
        return false;
    }
    search->found.depth = -at.gap;
    memcpy(search->found.spot, position, sizeof position);
    return true;
}

/*
 * Follow a point of the shell on its way relative to the contact body and find the smallest gap
 * between them. Returns the time (0 to 1) of the smallest gap, or -1 if the point has come from the
 * front of the body to behind it, through the body.
 *   normal [3] out  normal of the body at the smallest gap
 */
static pzs_real crossing_time(const pzs_contact *contact, const pzs_real from[3],
                              const pzs_real to[3], pzs_real normal[3])
{
    const pzs_real motion[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
    const pzs_real closed = 2 * pzs_contact_closed_gap(contact);
    pzs_real behind[3], low = 0, high = 1;
    const pzs_real gap = gap_at(contact, from, normal);
    if (gap < -closed || !(vector3_dot(normal, motion) < 0))
        return 0;
    gap_at(contact, to, behind);
    const bool ends_behind = vector3_dot(normal, behind) < 0;
    memcpy(normal, behind, sizeof behind);
    if (!(vector3_dot(normal, motion) > 0))
        return 1;
    for (int i = 0; i < MOTION_BISECTIONS; i++) {
        const pzs_real middle = (low + high) / 2;
        const pzs_real position[3] = {from[0] + middle * motion[0], from[1] + middle * motion[1],
                                      from[2] + middle * motion[2]};
        if (gap_at(contact, position, normal) < -closed && ends_behind)
            return -1;
        if (vector3_dot(normal, motion) > 0)
            high = middle;
        else
            low = middle;
    }
    return low;
}

static bool has_passed(facet_search *search, pzs_real along, pzs_real across)
{
    pzs_real from[3], to[3], normal[3];
    facet_point((const pzs_real(*)[3])search->corner[0], along, across, from);
    facet_point((const pzs_real(*)[3])search->corner[1], along, across, to);
    const pzs_real time = crossing_time(search->contact, from, to, normal);
    find_slopes(search, along, across, time < 0 ? 1 : time, normal);
    if (time >= 0)
        return false;
    search->found.depth = 0;
    memcpy(search->found.spot, to, sizeof to);
    return true;
}

static bool is_faulty(facet_search *search, pzs_real along, pzs_real across)
{
    return search->follows_motion ? has_passed(search, along, across)
                                  : is_penetrated(search, along, across);
}

/*
 * Search a line on a flat facet (element of the shell) for its smallest gap to the contact body.
 * The first facet coordinate is constant along the line. Bisection finds the point where the
 * derivative of the gap along the line is zero. Returns whether a point has penetrated or passed
 * through the body.
 */
static bool search_line(facet_search *search, pzs_real along)
{
    pzs_real low = 0, high = 1;
    for (int i = 0; i <= SIDE_BISECTIONS; i++) {
        const pzs_real middle = (low + high) / 2;
        if (is_faulty(search, along, middle))
            return true;
        if (search->slope[1] > 0)
            high = middle;
        else
            low = middle;
    }
    return false;
}

/*
 * Search a facet of the shell for its smallest gap to the contact body, by bisection over the first
 * facet coordinate (search_line). On a flat facet the gap is a convex function, so that this is the
 * smallest gap of all points. Returns whether a point has penetrated or passed through the body.
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
 * Whether a facet of the shell stays in front of a tangent plane of the convex contact body during
 * the whole load step, so that it cannot touch the body. The plane touches the body at the point
 * nearest to the middle of the facet.
 *   k in  position of the facet for which the plane is chosen: 0 start, 1 end of the load step
 */
static bool is_separated(const facet_search *search, int k)
{
    pzs_real position[3], normal[3];
    facet_point(search->corner[k], (pzs_real)0.5, (pzs_real)0.5, position);
    const pzs_real gap = gap_at(search->contact, position, normal) - vector3_dot(normal, position);
    for (int i = 0; i < 8; i++)
        if (!(gap + vector3_dot(normal, search->corner[i / 4][i % 4]) > 0))
            return false;
    return true;
}

/*
 * Search a facet of the shell for points that have penetrated or passed through the contact body.
 * The point of penetration is written to search->found, whose node is a corner number from 0 to 3,
 * or PZS_CONSTRAINED for a point between the corners.
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
        for (uint8_t corner = 0; corner < SHELL_NODES; corner++)
            if (is_faulty(search, side[corner][0], side[corner][1])) {
                search->found.node = corner;
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
 * Whether the contact face of the shell points away from the contact body in the middle of a facet
 * (element), both now and at the last equilibrium.
 */
static bool faces_away(const facet_search *search)
{
    for (int k = 0; k < 2; k++) {
        const pzs_real(*corner)[3] = search->corner[k];
        const pzs_real diagonal[3] = {corner[2][0] - corner[0][0], corner[2][1] - corner[0][1],
                                      corner[2][2] - corner[0][2]};
        const pzs_real other_diagonal[3] = {
            corner[3][0] - corner[1][0], corner[3][1] - corner[1][1], corner[3][2] - corner[1][2]};
        pzs_real middle[3], normal[3], up[3];
        facet_point(corner, (pzs_real)0.5, (pzs_real)0.5, middle);
        gap_at(search->contact, middle, normal);
        pzs_face_cross(diagonal, other_diagonal, up);
        const pzs_real facing = vector3_dot(up, normal);
        if ((search->contact->state.face->face == 0 ? -facing : facing) < 0)
            return false;
    }
    return true;
}

static penetration check_element(pzs_contact *contact, const pzs_solver *solver, uint32_t element,
                                 pzs_real height)
{
    const uint16_t *node = solver->state.model->state.structure->element[element];
    facet_search search = {.contact = contact};
    node_positions(contact, solver, node, SHELL_NODES, height, solver->state.converged_displacement,
                   solver->state.converged_input_value, search.corner[0]);
    node_positions(contact, solver, node, SHELL_NODES, height, solver->state.displacement,
                   solver->state.input_value, search.corner[1]);
    for (unsigned corner = 0; corner < SHELL_NODES; corner++)
        search.is_supported |= contact->state.touching[node[corner]] != 0;
    search_facet(&search);
    if (search.found.node != PZS_CONSTRAINED)
        search.found.node = node[search.found.node];
    search.found.is_behind = search.found.how != PZS_PENETRATION_NONE && contact->info.nodes > 0 &&
                             search.found.how != PZS_PENETRATION_PASSED && faces_away(&search);
    return search.found;
}

static void write_info(pzs_contact *contact, const pzs_solver *solver, const penetration *found,
                       uint32_t element, uint8_t side)
{
    const pzs_real moved = body_motion(contact, solver, solver->state.input_value);
    contact->info.penetration = found->how;
    contact->info.side = side;
    contact->info.element = (uint16_t)element;
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
        const uint32_t element = i % structure->elements;
        const uint8_t side =
            i < structure->elements ? contact->state.face->face : 1 - contact->state.face->face;
        const penetration found =
            check_element(contact, solver, element, pzs_face_height(structure, side));
        if (found.how == PZS_PENETRATION_NONE ||
            (found.is_behind && status == PZS_W_BEHIND && found.depth <= contact->info.depth))
            continue;
        status = found.is_behind ? PZS_W_BEHIND : PZS_E_PENETRATION;
        write_info(contact, solver, &found, element, side);
    }
    return status;
}

/* ---- length of a load step ---------------------------------------------- */

/*
 * Return how far the contact body may move before its gap to a point of the shell has shrunk to
 * `near` (m), as a part (0 to 1) of its motion. The gap falls by at most the length of the motion.
 * Each step therefore moves the body by the gap that is left, less `near`.
 */
static pzs_real free_motion(const pzs_contact *contact, const pzs_real position[3],
                            const pzs_real motion[3], pzs_real near)
{
    const pzs_real length = PZS_SQRT(vector3_dot(motion, motion));
    pzs_real part = 0;
    for (int i = 0; i < MOTION_STEPS && part < 1; i++) {
        const pzs_real at[3] = {position[0] - part * motion[0], position[1] - part * motion[1],
                                position[2] - part * motion[2]};
        pzs_real normal[3];
        const pzs_real left = gap_at(contact, at, normal) - near;
        if (left > 0 && vector3_dot(normal, motion) <= 0)
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
    const pzs_real motion[3] = {moved * face->motion[0], moved * face->motion[1],
                                moved * face->motion[2]};
    const pzs_real length = PZS_SQRT(vector3_dot(motion, motion)),
                   height = pzs_face_height(solver->state.model->state.structure, face->face);
    pzs_real part = 1, radius = face->size;
    for (uint16_t node = 0; length > 0 && node < solver->state.model->state.structure->nodes;
         node++) {
        pzs_real position[1][3];
        node_positions(contact, solver, &node, 1, height, solver->state.converged_displacement,
                       solver->state.converged_input_value, position);
        const body_point at = find_body_point(contact, position[0]);
        const pzs_real most = free_motion(contact, position[0], motion, contact->state.reach);
        part = most < part ? most : part;
        radius = at.radius > 0 && at.radius < radius ? at.radius : radius;
    }
    const pzs_real whole = length > 0 && part < 1 ? part + radius / (2 * length) : 1;
    return whole < 1 ? whole : 1;
}

#endif
