/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Contact with a rigid convex body (pzs_nonlinear.h), inside Newton's method: a primal-dual
 * active-set method, whose contact pressure is updated in each linear solve with a penalty
 * stiffness (proximal multiplier). A node in contact carries the force f and the stiffness -df/du:
 *
 *    f = w (p - e g) n,  -df/du = w (e n n' - p Hess g)
 *   w, u    area of the node, its displacement
 *   g, n    gap, gradient of the gap at the deformed position; Hess g: second derivatives
 *   p       contact pressure (negative multiplier): p - e (g + n . d) of the last linear solve
 *   d       displacement increment of the node in that solve
 *   e       penalty stiffness; the result does not depend on it, because g = 0 at convergence
 */
#include "contact_check.h"
#include "face.h"
#include "../core/guard.h"
#include "../core/vector3.h"
#include "../model/compact.h"
#include "../model/model.h"
#include "nonlinear.h"
#include "../model/shell.h"
#include <string.h>

#if PZS_NONLINEAR

/*
 * Factor f: a node stays in contact while its contact pressure (N/m2) exceeds f times its gap to
 * the body (m) times the stiffness of the shell at the node, per area (N/m3).
 */
#define PRESSURE_SCALE ((pzs_real)1e-5)
/*
 * Penalty stiffness of a contact, relative to the stiffness of the shell at the node, from which on
 * it is no longer doubled.
 */
#define LARGEST_STIFFNESS ((pzs_real)100)
/*
 * While Newton's method iterates in a load step, the set of nodes in contact stays that of the last
 * equilibrium until the increment of the displacement has fallen below this fraction of the
 * displacement of the load step.
 */
#define ACTIVE_SET_INCREMENT ((pzs_real)0.2)

/*
 * Largest accepted difference between the squared length of the axis of a contact body and 1,
 * because the axis must be a unit vector.
 */
#define UNIT_TOLERANCE ((pzs_real)1e-5)

enum {
    NO_MOTION_INPUT = 0xFFFF
}; /* value of pzs_contact_face.input where no input moves the contact body */

static pzs_contact *contact_of(pzs_solver_option *option)
{
    return (pzs_contact *)(void *)option;
}

/* ---- bodies ----------------------------------------------------------- */

/*
 * Compute the signed distance of a point from a sphere or a cylinder, with its gradient (the
 * normal) and its second derivatives. At the centre or on the axis, where they are undefined, both
 * derivatives are set to 0.
 *   from  [3] in  vector to the point from the centre or, at right angles, from the axis (m)
 *   along [3] in  unit vector along the axis of a cylinder; NULL: sphere
 */
static pzs_real gap_round(pzs_real radius, const pzs_real from[3], const pzs_real *along,
                          pzs_real normal[3], pzs_real hessian[3][3])
{
    const pzs_real distance = PZS_SQRT(vector3_dot(from, from));
    const pzs_real inverse = distance > radius * PZS_EPSILON ? 1 / distance : 0;
    for (int i = 0; i < 3; i++)
        normal[i] = inverse * from[i];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const pzs_real unit = i == j ? 1 : 0;
            const pzs_real across = along ? along[i] * along[j] : 0;
            hessian[i][j] = inverse * (unit - normal[i] * normal[j] - across);
        }
    return distance - radius;
}

pzs_real pzs_gap_plane(const pzs_body *body, const pzs_real position[3], pzs_real normal[3],
                       pzs_real hessian[3][3])
{
    memset(hessian, 0, sizeof(pzs_real[3][3]));
    memcpy(normal, body->axis, sizeof body->axis);
    const pzs_real from[3] = {position[0] - body->point[0], position[1] - body->point[1],
                              position[2] - body->point[2]};
    return vector3_dot(from, normal);
}

pzs_real pzs_gap_cylinder(const pzs_body *body, const pzs_real position[3], pzs_real normal[3],
                          pzs_real hessian[3][3])
{
    pzs_real from[3] = {position[0] - body->point[0], position[1] - body->point[1],
                        position[2] - body->point[2]};
    const pzs_real along = vector3_dot(from, body->axis);
    for (int i = 0; i < 3; i++)
        from[i] -= along * body->axis[i];
    return gap_round(body->radius, from, body->axis, normal, hessian);
}

pzs_real pzs_gap_sphere(const pzs_body *body, const pzs_real position[3], pzs_real normal[3],
                        pzs_real hessian[3][3])
{
    const pzs_real from[3] = {position[0] - body->point[0], position[1] - body->point[1],
                              position[2] - body->point[2]};
    return gap_round(body->radius, from, NULL, normal, hessian);
}

/* ---- one node of the face ---------------------------------------------- */

/*
 * Position of a node relative to the contact body: gap (m), gradient of the gap (dimensionless) in
 * global axes (member global) and in the frame of the node (member normal), and second derivatives
 * of the gap in the frame of the node (1/m).
 */
typedef struct contact_point {
    pzs_real gap, global[3], normal[3], hessian[3][3];
} contact_point;

static pzs_real face_height(const pzs_contact *contact, const pzs_solver *solver)
{
    return pzs_face_height(solver->state.model->state.structure, contact->state.face->face);
}

/*
 * Compute the displacement of a node of the contact face in the local axes of the node.
 *   vector       [free_dof] in   displacement over the free degrees of freedom
 *                                (m, or 1 for differences over the thickness)
 *   displacement [3]        out  displacement of the node (m)
 */
static void node_displacement(const pzs_contact *contact, const pzs_solver *solver, uint16_t node,
                              const pzs_real *vector, pzs_real displacement[3])
{
    pzs_real all[1][3];
    pzs_face_gather(solver->state.model, &node, 1, face_height(contact, solver), vector, all);
    memcpy(displacement, all[0], sizeof all[0]);
}

static contact_point find_point(const pzs_contact *contact, const pzs_solver *solver, uint16_t node)
{
    const pzs_contact_face *face = contact->state.face;
    const pzs_real(*triad)[3] = face->triad[node];
    const pzs_real moved = face->input < solver->state.model->state.structure->input.count
                               ? solver->state.input_value[face->input]
                               : 0;
    pzs_real displacement[3], position[3], global[3][3];
    contact_point point;
    node_displacement(contact, solver, node, solver->state.displacement, displacement);
    for (int i = 0; i < 3; i++)
        position[i] = face->place[node][i] - moved * face->motion[i] +
                      displacement[0] * triad[0][i] + displacement[1] * triad[1][i] +
                      displacement[2] * triad[2][i];
    point.gap = contact->state.body->gap(contact->state.body, position, point.global, global);
    for (int i = 0; i < 3; i++) {
        const pzs_real derivative[3] = {vector3_dot(triad[i], global[0]),
                                        vector3_dot(triad[i], global[1]),
                                        vector3_dot(triad[i], global[2])};
        point.normal[i] = vector3_dot(triad[i], point.global);
        for (int j = 0; j < 3; j++)
            point.hessian[i][j] = vector3_dot(triad[j], derivative);
    }
    return point;
}

/*
 * Return the stiffness of the shell at a node, per area (N/m3), from the diagonal of the stiffness
 * matrix. It is the stiffness along the normal e3 of the shell if a degree of freedom in this
 * direction is free, otherwise that along e1 or e2. Returns 0 where the face has no free degree of
 * freedom.
 */
static pzs_real structure_stiffness(const pzs_contact *contact, const pzs_solver *solver,
                                    uint16_t node)
{
    static const uint8_t order[6] = {5, 2, 3, 4, 0, 1};
    const pzs_structure *structure = solver->state.model->state.structure;
    for (int k = 0; k < 6 && contact->state.face->area[node] > 0; k++) {
        const uint16_t dof = structure->node_dof[(size_t)node * structure->dof_per_node + order[k]];
        if (dof == PZS_CONSTRAINED ||
            (solver->state.model->state.constrained && solver->state.model->state.constrained[dof]))
            continue;
        const pzs_real scale = solver->state.model->state.scale[dof] *
                               (order[k] < 3 ? 1 : pzs_structure_thickness(structure));
        return 1 / (scale * scale * contact->state.face->area[node]);
    }
    return 0;
}

/*
 * Return the penalty stiffness of the contact at a node, per area (N/m3). A linear solve reduces a
 * gap to the fraction s/(s + e) of its size, with the stiffness s of the shell and the penalty
 * stiffness e. Since a small e converges slowly, e doubles with each linear solve of a load step
 * until it is at least LARGEST_STIFFNESS times s.
 */
static pzs_real contact_stiffness(const pzs_contact *contact, const pzs_solver *solver,
                                  uint16_t node)
{
    pzs_real stiffness = contact->settings.stiffness;
    for (uint32_t i = 0; i < solver->state.iteration && stiffness < LARGEST_STIFFNESS; i++)
        stiffness *= 2;
    return stiffness * structure_stiffness(contact, solver, node);
}

/* ---- active set ------------------------------------------------------- */

/*
 * Compute state.facing [nodes], which is negative where the deformed shell points towards the
 * contact body. The entry of a node is a sum over the elements at the node: scalar product of the
 * outward normal of the deformed face and the normal of the body.
 */
static void find_facing(pzs_contact *contact, const pzs_solver *solver)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    const pzs_real height = face_height(contact, solver);
    memset(contact->state.facing, 0, structure->nodes * sizeof *contact->state.facing);
    for (uint32_t element = 0; element < structure->elements; element++) {
        const pzs_element_type *type = pzs_model_element_type(solver->state.model, element);
        pzs_real displacement[SHELL_NODES][3];
        pzs_face_gather(solver->state.model, structure->element[element], SHELL_NODES, height,
                        solver->state.displacement, displacement);
        for (unsigned corner = 0; corner < SHELL_NODES; corner++) {
            const uint16_t node = structure->element[element][corner];
            const contact_point point = find_point(contact, solver, node);
            pzs_real eta[3];
            pzs_face_normal(type, height, (const pzs_real(*)[3])displacement, corner, eta);
            contact->state.facing[node] += contact->state.face->face == 0
                                               ? -vector3_dot(eta, point.normal)
                                               : vector3_dot(eta, point.normal);
        }
    }
}

/*
 * Whether a node of the shell can come into contact: the contact face of the shell points towards
 * the body there, and the node has a free degree of freedom.
 */
static bool can_touch(const pzs_contact *contact, const pzs_solver *solver, uint16_t node)
{
    return contact->state.facing[node] < 0 && structure_stiffness(contact, solver, node) > 0;
}

/*
 * Whether a node belongs to the active set of a contact (the nodes held on the body), by its gap
 * and its contact pressure. A node whose gap is closed belongs to the set while its pressure is
 * positive.
 */
static bool is_active(const pzs_contact *contact, const pzs_solver *solver, uint16_t node)
{
    if (!can_touch(contact, solver, node))
        return false;
    const pzs_real gap = find_point(contact, solver, node).gap,
                   closed = pzs_contact_closed_gap(contact);
    const pzs_real least = gap < 0 && gap >= -closed ? 0 : gap;
    if (!contact->state.touching[node])
        return gap < -closed;
    return contact->state.pressure[node] >
           PRESSURE_SCALE * structure_stiffness(contact, solver, node) * least;
}

/*
 * Return the node of the shell with the smallest gap to the contact body among those that can come
 * into contact, or -1.
 */
static int32_t nearest_node(const pzs_contact *contact, const pzs_solver *solver)
{
    int32_t best = -1;
    pzs_real least = 0;
    for (uint16_t node = 0; node < solver->state.model->state.structure->nodes; node++) {
        const pzs_real gap =
            can_touch(contact, solver, node) ? find_point(contact, solver, node).gap : 0;
        if (can_touch(contact, solver, node) && (best < 0 || gap < least)) {
            best = node;
            least = gap;
        }
    }
    return best;
}

/*
 * Choose the active set of a contact (the nodes held on the body) for the first linear solve of a
 * load step: the nodes in contact at the last equilibrium, and those that the moving body has
 * reached. Without contact at the last equilibrium, these are the nodes whose gap is closed.
 */
static void start_active_set(pzs_contact *contact, const pzs_solver *solver)
{
    const uint16_t nodes = solver->state.model->state.structure->nodes;
    uint32_t before = 0, added = 0;
    for (uint16_t node = 0; node < nodes; node++)
        before += contact->state.touching[node];
    const pzs_real most =
        before > 0 ? -pzs_contact_closed_gap(contact) : pzs_contact_closed_gap(contact);
    for (uint16_t node = 0; node < nodes; node++)
        if (!contact->state.touching[node] && can_touch(contact, solver, node) &&
            find_point(contact, solver, node).gap <= most) {
            contact->state.touching[node] = 1;
            added++;
        }
    contact->state.is_warm = before > 0 && added == 0;
    contact->state.has_changed = added > 0;
    contact->state.lacks_contact = before + added == 0;
}

/*
 * Update the active set of a contact (the nodes held on the body) by the gaps and contact pressures
 * of the nodes.
 */
static void update_active_set(pzs_contact *contact, const pzs_solver *solver)
{
    const uint16_t nodes = solver->state.model->state.structure->nodes;
    uint32_t count = 0;
    for (uint16_t node = 0; node < nodes; node++) {
        const bool touches = is_active(contact, solver, node);
        contact->state.has_changed |= touches != (contact->state.touching[node] != 0);
        contact->state.touching[node] = touches;
        count += touches;
        if (!touches)
            contact->state.pressure[node] = 0;
    }
    // Without supports, an empty active set would make the tangent matrix singular. The node
    // nearest to the body then stays in contact; such a state never counts as converged.
    const int32_t closest =
        count == 0 && contact->state.is_loose ? nearest_node(contact, solver) : -1;
    contact->state.lacks_contact = closest >= 0;
    if (closest >= 0)
        contact->state.touching[closest] = 1;
}

static bool prepare_solve(pzs_solver_option *option, pzs_solver *solver)
{
    pzs_contact *contact = contact_of(option);
    contact->state.has_changed = false;
    find_facing(contact, solver);
    if (solver->state.iteration == 0)
        start_active_set(contact, solver);
    else if (!contact->state.is_warm || solver->info.relative_increment < ACTIVE_SET_INCREMENT)
        update_active_set(contact, solver);
    return solver->state.iteration > 0 || !contact->state.is_loose || !contact->state.lacks_contact;
}

static bool has_converged(pzs_solver_option *option, pzs_solver *solver)
{
    pzs_contact *contact = contact_of(option);
    if (contact->state.has_changed)
        return false;
    find_facing(contact, solver);
    const pzs_real closed = pzs_contact_closed_gap(contact);
    for (uint16_t node = 0; node < solver->state.model->state.structure->nodes; node++) {
        const pzs_real gap =
            contact->state.touching[node] ? find_point(contact, solver, node).gap : 0;
        if (gap > closed || gap < -closed ||
            is_active(contact, solver, node) != (contact->state.touching[node] != 0))
            return false;
    }
    return true;
}

static pzs_status check_step(pzs_solver_option *option, pzs_solver *solver)
{
    pzs_contact *contact = contact_of(option);
    const pzs_status status = pzs_contact_check(contact, solver);
    solver->state.refused_at = contact->info.element;
    return status;
}

static pzs_real largest_part(pzs_solver_option *option, const pzs_solver *solver,
                             const pzs_real *value)
{
    return pzs_contact_largest_part(contact_of(option), solver, value);
}

/* ---- forces ----------------------------------------------------------- */

/*
 * Add the contact stiffness of a node to the tangent matrix: the area of the node times (penalty
 * stiffness times n n' minus pressure times second derivatives of the gap), with the gradient n of
 * the gap and its transpose n'.
 */
static void add_tangent(const pzs_contact *contact, pzs_solver *solver, uint16_t node,
                        const contact_point *point, pzs_real stiffness)
{
    const pzs_real height = face_height(contact, solver);
    pzs_real tangent[SHELL_PACKED(7)] = {0};
    for (unsigned i = 0; i < 6; i++)
        for (unsigned j = 0; j <= i; j++) {
            const pzs_real row_arm = i < 3 ? 1 : height;
            const pzs_real column_arm = j < 3 ? 1 : height;
            tangent[SHELL_PACKED(i) + j] =
                row_arm * column_arm *
                (stiffness * point->normal[i % 3] * point->normal[j % 3] -
                 contact->state.pressure[node] * point->hessian[i % 3][j % 3]);
        }
    pzs_model_add_matrix(solver->state.model, &node, 1, contact->state.face->area[node], tangent);
}

static void add_forces(pzs_solver_option *option, pzs_solver *solver, pzs_real *load)
{
    pzs_contact *contact = contact_of(option);
    memset(contact->info.force, 0, sizeof contact->info.force);
    contact->info.nodes = 0;
    for (uint16_t node = 0; node < solver->state.model->state.structure->nodes; node++) {
        if (!contact->state.touching[node])
            continue;
        const contact_point point = find_point(contact, solver, node);
        const pzs_real stiffness = contact_stiffness(contact, solver, node);
        const pzs_real push = contact->state.face->area[node] *
                              (contact->state.pressure[node] - stiffness * point.gap);
        pzs_real force[1][3];
        for (int i = 0; i < 3; i++) {
            force[0][i] = push * point.normal[i];
            contact->info.force[i] +=
                contact->state.face->area[node] * contact->state.pressure[node] * point.global[i];
        }
        pzs_face_scatter(solver->state.model, &node, 1, face_height(contact, solver),
                         (const pzs_real(*)[3])force, load);
        add_tangent(contact, solver, node, &point, stiffness);
        contact->info.nodes++;
    }
}

static void after_solve(pzs_solver_option *option, pzs_solver *solver, const pzs_real *du)
{
    pzs_contact *contact = contact_of(option);
    for (uint16_t node = 0; node < solver->state.model->state.structure->nodes; node++) {
        if (!contact->state.touching[node])
            continue;
        const contact_point point = find_point(contact, solver, node);
        pzs_real increment[3];
        node_displacement(contact, solver, node, du, increment);
        contact->state.pressure[node] -= contact_stiffness(contact, solver, node) *
                                         (point.gap + vector3_dot(point.normal, increment));
    }
}

/*
 * Add the contact forces per unit of the input that moves the contact body. A motion of the body
 * closes the gap at a node by the component of the motion along the normal of the body there. The
 * motion also turns this normal, by the second derivatives of the gap times the motion.
 */
static void add_unit_force(pzs_solver_option *option, pzs_solver *solver, uint32_t input,
                           pzs_real *out)
{
    const pzs_contact *contact = contact_of(option);
    for (uint16_t node = 0;
         input == contact->state.face->input && node < solver->state.model->state.structure->nodes;
         node++) {
        if (!contact->state.touching[node])
            continue;
        const contact_point point = find_point(contact, solver, node);
        const pzs_real stiffness = contact_stiffness(contact, solver, node);
        pzs_real force[1][3], motion[3];
        for (int i = 0; i < 3; i++)
            motion[i] =
                vector3_dot(contact->state.face->triad[node][i], contact->state.face->motion);
        for (int i = 0; i < 3; i++)
            force[0][i] = contact->state.face->area[node] *
                          (stiffness * vector3_dot(point.normal, motion) * point.normal[i] -
                           contact->state.pressure[node] * vector3_dot(point.hessian[i], motion));
        pzs_face_scatter(solver->state.model, &node, 1, face_height(contact, solver),
                         (const pzs_real(*)[3])force, out);
    }
}

/* ---- state ------------------------------------------------------------ */

static void save(pzs_solver_option *option, pzs_solver *solver)
{
    pzs_contact *contact = contact_of(option);
    memcpy(contact->state.converged_pressure, contact->state.pressure,
           solver->state.model->state.structure->nodes * sizeof *contact->state.pressure);
    memcpy(contact->state.converged_touching, contact->state.touching,
           solver->state.model->state.structure->nodes);
}

static void restore(pzs_solver_option *option, pzs_solver *solver)
{
    pzs_contact *contact = contact_of(option);
    memcpy(contact->state.pressure, contact->state.converged_pressure,
           solver->state.model->state.structure->nodes * sizeof *contact->state.pressure);
    memcpy(contact->state.touching, contact->state.converged_touching,
           solver->state.model->state.structure->nodes);
}

static void reset(pzs_solver_option *option, pzs_solver *solver)
{
    pzs_contact *contact = contact_of(option);
    memset(contact->state.pressure, 0,
           solver->state.model->state.structure->nodes * sizeof *contact->state.pressure);
    memset(contact->state.touching, 0, solver->state.model->state.structure->nodes);
    memset(contact->info.force, 0, sizeof contact->info.force);
    contact->info.nodes = 0;
    contact->info.penetration = PZS_PENETRATION_NONE;
    contact->info.sag = 0;
    contact->info.depth = 0;
    save(option, solver);
}

/* ---- supports --------------------------------------------------------- */

static bool is_fixed(const pzs_solver *solver, uint16_t dof)
{
    const pzs_prescribed_motion *motion = &solver->state.tables->prescribed;
    bool fixed = dof == PZS_CONSTRAINED || (solver->state.model->state.constrained &&
                                            solver->state.model->state.constrained[dof]);
    for (uint32_t i = 0; i < motion->count && !fixed; i++)
        fixed = motion->dof[i] == dof;
    return fixed;
}

/*
 * Compute the unit vector in space along which degree of freedom k (0 to 5) of a node acts: an axis
 * of the node's triad (local axes), or of its rotated axes at an oblique support.
 */
static void axis_of_dof(const pzs_structure *structure, const pzs_real triad[3][3], uint16_t node,
                        int k, pzs_real unit[3])
{
    const pzs_real(*turn)[3] = k < 3 ? pzs_model_turn(structure, node) : NULL;
    for (int i = 0; i < 3; i++)
        unit[i] =
            turn ? turn[k][0] * triad[0][i] + turn[k][1] * triad[1][i] + turn[k][2] * triad[2][i]
                 : triad[k % 3][i];
}

/*
 * Add one constrained degree of freedom to the Gram matrix [6][6] with which is_loose finds out
 * whether the supports prevent every rigid motion. The matrix receives r'r, where r [6] holds the
 * displacement along this degree of freedom in three unit translations and three unit rotations of
 * the shell.
 *   height in  height of the contact face above the middle between both faces (m)
 *   k      in  number of the degree of freedom at its node (0 to 5)
 */
static void add_support(const pzs_contact *contact, const pzs_solver *solver, pzs_real height,
                        uint16_t node, int k, pzs_real gram[6][6])
{
    const pzs_real(*triad)[3] = contact->state.face->triad[node];
    pzs_real unit[3], arm[3], row[6];
    axis_of_dof(solver->state.model->state.structure, triad, node, k, unit);
    // Divide displacements by rotations by the size of the mesh, so that the entries of the Gram
    // matrix for translations and rotations are of the same size.
    for (int i = 0; i < 3; i++)
        arm[i] = k < 3 ? (contact->state.face->place[node][i] - height * triad[2][i] -
                          contact->state.face->place[0][i]) /
                             contact->state.face->size
                       : triad[2][i];
    for (int i = 0; i < 3; i++) {
        row[i] = k < 3 ? unit[i] : 0;
        row[3 + i] = arm[(i + 1) % 3] * unit[(i + 2) % 3] - arm[(i + 2) % 3] * unit[(i + 1) % 3];
    }
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++)
            gram[i][j] += row[i] * row[j];
}

/*
 * Whether the supports let the shell move as a rigid body: some rigid motion moves no supported
 * degree of freedom. The Gram matrix [6][6] of the supports (add_support) is then singular.
 */
static bool is_loose(const pzs_contact *contact, const pzs_solver *solver)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    pzs_real gram[6][6] = {{0}}, least[6];
    for (uint16_t node = 0; node < structure->nodes; node++)
        for (int k = 0; k < 6; k++)
            if (is_fixed(solver,
                         structure->node_dof[(size_t)node * structure->dof_per_node + (size_t)k]))
                add_support(contact, solver, face_height(contact, solver), node, k, gram);
    for (int i = 0; i < 6; i++)
        // Bound below which a pivot of the supports' Gram matrix, whose entries are about 1, counts
        // as zero: 1e-6, plus a bound of the rounding error of the pivot.
        least[i] = (pzs_real)1e-6 + 16 * PZS_EPSILON * gram[i][i];
    for (int pivot = 0; pivot < 6; pivot++) {
        if (!(gram[pivot][pivot] > least[pivot]))
            return true;
        for (int i = pivot + 1; i < 6; i++)
            for (int j = pivot + 1; j < 6; j++)
                gram[i][j] -= gram[i][pivot] * gram[pivot][j] / gram[pivot][pivot];
    }
    return false;
}

/* ---- settings and errors ------------------------------------------------ */

static bool settings_in_range(const pzs_solver_option *option)
{
    const pzs_real stiffness = ((const pzs_contact *)(const void *)option)->settings.stiffness;
    return stiffness > 0 && pzs_guard_nonfinite(&stiffness, 1) < 0;
}

/*
 * Whether the shell can move as a rigid body because neither its supports nor the contact body
 * prevent it.
 */
static bool is_unsupported(const pzs_solver_option *option, const pzs_solver *solver)
{
    const pzs_contact *contact = (const pzs_contact *)(const void *)option;
    uint32_t kept = 0;
    for (uint16_t node = 0; node < solver->state.model->state.structure->nodes; node++)
        kept += contact->state.converged_touching[node];
    /*
     * The body does not hold the shell in two cases: the last linear solve found no node pressed
     * onto it; or no node touched it at the last equilibrium, and the tangent matrix was singular
     * or had negative pivots.
     */
    return contact->state.is_loose &&
           (contact->state.lacks_contact ||
            (kept == 0 && (solver->info.where >= 0 || solver->info.negative_pivots > 0)));
}

static const struct pzs_solver_option_calls calls = {
    .settings_in_range = settings_in_range,
    .prepare_solve = prepare_solve,
    .add_forces = add_forces,
    .after_solve = after_solve,
    .has_converged = has_converged,
    .not_converged = PZS_E_CONTACT,
    .check_step = check_step,
    .largest_part = largest_part,
    .is_unsupported = is_unsupported,
    .save = save,
    .restore = restore,
    .reset = reset,
    .add_unit_force = add_unit_force,
};

/* ---- attach ------------------------------------------------------------- */

uint32_t pzs_contact_crc(const pzs_contact_face *face, const pzs_structure *structure)
{
    const uint16_t codes[2] = {face->face, face->input};
    uint32_t crc = pzs_guard_crc(GUARD_CRC_START, codes, sizeof codes);
    crc = pzs_guard_crc(crc, face->motion, sizeof face->motion);
    crc = pzs_guard_crc(crc, &face->size, sizeof face->size);
    crc = pzs_guard_crc(crc, face->place, structure->nodes * sizeof *face->place);
    crc = pzs_guard_crc(crc, face->triad, structure->nodes * sizeof *face->triad);
    return ~pzs_guard_crc(crc, face->area, structure->nodes * sizeof *face->area);
}

pzs_status pzs_contact_face_seal(pzs_contact_face *tables, const pzs_structure *structure)
{
    if (!tables || !structure || !tables->place || !tables->triad || !tables->area)
        return PZS_E_ARGUMENT;
    tables->format = PZS_TABLE_FORMAT;
    tables->scene = structure->scene;
    tables->crc = pzs_contact_crc(tables, structure);
    return PZS_OK;
}

uint32_t pzs_body_crc(const pzs_body *body)
{
    uint32_t crc = pzs_guard_crc(GUARD_CRC_START, body->point, sizeof body->point);
    crc = pzs_guard_crc(crc, body->axis, sizeof body->axis);
    return ~pzs_guard_crc(crc, &body->radius, sizeof body->radius);
}

/*
 * Check that the numbers that describe a contact body (point, axis, radius) suit its distance
 * function. *where is the index of the first number that is not finite: 0 to 2 for the point, 3 to
 * 5 for the axis, 6 for the radius.
 */
static pzs_status check_body(const pzs_body *body, int32_t *where)
{
    const bool has_axis = body->gap == pzs_gap_plane || body->gap == pzs_gap_cylinder;
    const bool has_radius = body->gap == pzs_gap_cylinder || body->gap == pzs_gap_sphere;
    const pzs_real off = vector3_dot(body->axis, body->axis) - 1;
    pzs_real number[7] = {0};
    if (body->crc != pzs_body_crc(body))
        return PZS_E_CRC;
    memcpy(number, body->point, sizeof body->point);
    memcpy(number + 3, body->axis, sizeof body->axis);
    number[6] = body->radius;
    *where = pzs_guard_nonfinite(number, 7);
    if (*where >= 0)
        return PZS_E_NONFINITE;
    if (has_radius && !(body->radius > 0))
        return PZS_E_ARGUMENT;
    return has_axis && !(PZS_ABS(off) <= UNIT_TOLERANCE) ? PZS_E_ARGUMENT : PZS_OK;
}

static pzs_status check(const pzs_contact_face *face, const pzs_structure *structure)
{
    if (!face->place || !face->triad || !face->area)
        return PZS_E_ARGUMENT;
    if (face->format != PZS_TABLE_FORMAT || face->scene != structure->scene)
        return PZS_E_FORMAT;
    if (pzs_contact_crc(face, structure) != face->crc)
        return PZS_E_CRC;
    if (pzs_guard_nonfinite(face->motion, 3) >= 0 || pzs_guard_nonfinite(&face->size, 1) >= 0)
        return PZS_E_ARGUMENT;
    return face->face <= 1 && face->size > 0 &&
                   (face->input < structure->input.count || face->input == NO_MOTION_INPUT)
               ? PZS_OK
               : PZS_E_ARGUMENT;
}

pzs_status pzs_attach_contact(pzs_solver *solver, pzs_contact *contact,
                              const pzs_contact_face *face, const pzs_body *body, void *work,
                              size_t bytes)
{
    if (!solver || !solver->state.model || !contact || !face || !body || !body->gap || !work)
        return PZS_E_ARGUMENT;
    pzs_status status = check(face, solver->state.model->state.structure);
    if (status == PZS_OK)
        status = check_body(body, &solver->info.where);
    if (status != PZS_OK)
        return status;
    const uint16_t nodes = solver->state.model->state.structure->nodes;
    const int32_t missing = guard_missing_bytes(work, bytes, PZS_CONTACT_BYTES(nodes));
    if (missing >= 0) {
        solver->info.where = missing;
        return PZS_E_WORKSPACE;
    }
    if (pzs_nonlinear_is_attached(solver, &contact->option))
        return PZS_E_ARGUMENT;
    memset(contact, 0, sizeof *contact);
    contact->state.face = face;
    contact->state.body = body;
    contact->state.pressure = work;
    contact->state.converged_pressure = contact->state.pressure + nodes;
    contact->state.facing = contact->state.converged_pressure + nodes;
    contact->state.touching = (uint8_t *)(contact->state.facing + nodes);
    contact->state.converged_touching = contact->state.touching + nodes;
    contact->info.pressure = contact->state.pressure;
    contact->settings.stiffness = 10;
    contact->info.node = PZS_CONSTRAINED;
    contact->state.reach = pzs_contact_reach(contact, solver->state.model->state.structure);
    contact->state.is_loose = is_loose(contact, solver);
    reset(&contact->option, solver);
    pzs_nonlinear_attach(solver, &contact->option, &calls);
    return PZS_OK;
}

#endif
