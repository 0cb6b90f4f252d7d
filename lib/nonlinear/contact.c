/*
 * Contact with a rigid convex body (pzs.h): a primal-dual active set with a proximal multiplier,
 * inside Newton's method.
 *
 * Per node of the face: reference area w, gap g and its gradient n at the moved place, pressure p
 * (minus the multiplier), stiffness e. A node in contact carries  f = w (p - e g) n,  -df/du = w (e
 * n n' - p Hess g)  with the p that the last system predicted, and each solve predicts  p <- p - e
 * (g + n . d).  At the end g = 0, so the answer is free of e.
 */
#include "contact_check.h"
#include "face.h"
#include "../core/guard.h"
#include "../model/model.h"
#include "nonlinear.h"
#include "../model/shell.h"
#include <string.h>

#if PZS_NONLINEAR

/* Gap and pressure are weighed against each other with this part of the structure's own stiffness.
 */
#define WEIGHING ((pzs_real)1e-5)
/* The stiffness against the body doubles while it is below this many times the structure's own. */
#define FIRM ((pzs_real)100)
/* While a warm step moves by more than this part of its way, its nodes stay as they were. */
#define QUIET ((pzs_real)0.2)

/* Squares of unit vectors are 1 to within this. */
#define UNIT ((pzs_real)1e-5)

enum { NO_MOTION = 0xFFFF }; /* as input of a face: the body stays */

static pzs_contact *contact_of(pzs_solver_option *option)
{
    return (pzs_contact *)(void *)option;
}

static pzs_real dot(const pzs_real a[3], const pzs_real b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* ---- bodies ----------------------------------------------------------- */

/*
 * Gap to the sphere or circle of radius about 0, at the vector from its centre; `along` is the unit
 * axis or NULL. In the centre itself all directions lead out: the normal and second derivatives are
 * 0 there.
 */
static pzs_real gap_round(pzs_real radius, const pzs_real from[3], const pzs_real *along,
                          pzs_real normal[3], pzs_real hessian[3][3])
{
    const pzs_real distance = PZS_SQRT(dot(from, from));
    const pzs_real inverse = distance > radius * PZS_EPSILON ? 1 / distance : 0;
    for (int i = 0; i < 3; i++)
        normal[i] = inverse * from[i];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            hessian[i][j] = inverse * ((i == j ? 1 : 0) - normal[i] * normal[j] -
                                       (along ? along[i] * along[j] : 0));
    return distance - radius;
}

pzs_real pzs_gap_plane(const pzs_body *body, const pzs_real x[3], pzs_real normal[3],
                       pzs_real hessian[3][3])
{
    memset(hessian, 0, sizeof(pzs_real[3][3]));
    memcpy(normal, body->axis, sizeof body->axis);
    const pzs_real from[3] = {x[0] - body->point[0], x[1] - body->point[1], x[2] - body->point[2]};
    return dot(from, normal);
}

pzs_real pzs_gap_cylinder(const pzs_body *body, const pzs_real x[3], pzs_real normal[3],
                          pzs_real hessian[3][3])
{
    pzs_real from[3] = {x[0] - body->point[0], x[1] - body->point[1], x[2] - body->point[2]};
    const pzs_real along = dot(from, body->axis);
    for (int i = 0; i < 3; i++)
        from[i] -= along * body->axis[i];
    return gap_round(body->radius, from, body->axis, normal, hessian);
}

pzs_real pzs_gap_sphere(const pzs_body *body, const pzs_real x[3], pzs_real normal[3],
                        pzs_real hessian[3][3])
{
    const pzs_real from[3] = {x[0] - body->point[0], x[1] - body->point[1], x[2] - body->point[2]};
    return gap_round(body->radius, from, NULL, normal, hessian);
}

/* ---- one node --------------------------------------------------------- */

/* A node against the body: gap, its gradient in global axes and in the node's triad, its second
 * derivatives there. */
typedef struct place {
    pzs_real gap, global[3], normal[3], hessian[3][3];
} place;

static pzs_real height(const pzs_contact *contact, const pzs_solver *solver)
{
    return pzs_face_height(solver->state.model->state.structure, contact->state.face->face);
}

/* Displacement of a node of the face, in its triad. p [dof] in */
static void displacement(const pzs_contact *contact, const pzs_solver *solver, uint16_t node,
                         const pzs_real *p, pzs_real w[3])
{
    pzs_real all[1][3];
    pzs_face_gather(solver->state.model, &node, 1, height(contact, solver), p, all);
    memcpy(w, all[0], sizeof all[0]);
}

static place place_of(const pzs_contact *contact, const pzs_solver *solver, uint16_t node)
{
    const pzs_contact_face *face = contact->state.face;
    const pzs_real(*triad)[3] = face->triad[node];
    const pzs_real moved = face->input < solver->state.model->state.structure->input.count
                               ? solver->state.input_value[face->input]
                               : 0;
    pzs_real w[3], x[3], global[3][3];
    place at;
    displacement(contact, solver, node, solver->state.displacement, w);
    for (int i = 0; i < 3; i++)
        x[i] = face->place[node][i] - moved * face->motion[i] + w[0] * triad[0][i] +
               w[1] * triad[1][i] + w[2] * triad[2][i];
    at.gap = contact->state.body->gap(contact->state.body, x, at.global, global);
    for (int i = 0; i < 3; i++) {
        const pzs_real turned[3] = {dot(triad[i], global[0]), dot(triad[i], global[1]),
                                    dot(triad[i], global[2])};
        at.normal[i] = dot(triad[i], at.global);
        for (int j = 0; j < 3; j++)
            at.hessian[i][j] = dot(triad[j], turned);
    }
    return at;
}

/* The structure's own stiffness per area at a node, by its unknowns along e3; 0 where nothing of
 * the face can move. */
static pzs_real own_stiffness(const pzs_contact *contact, const pzs_solver *solver, uint16_t node)
{
    static const uint8_t order[6] = {5, 2, 3, 4, 0, 1};
    const pzs_structure *structure = solver->state.model->state.structure;
    for (int k = 0; k < 6 && contact->state.face->area[node] > 0; k++) {
        const uint16_t dof = structure->node_dof[(size_t)node * structure->dof_per_node + order[k]];
        if (dof == PZS_CONSTRAINED ||
            (solver->state.model->state.constrained && solver->state.model->state.constrained[dof]))
            continue;
        const pzs_real scale = solver->state.model->state.scale[dof] *
                               (order[k] < 3 ? 1 : structure->type[0].thickness);
        return 1 / (scale * scale * contact->state.face->area[node]);
    }
    return 0;
}

/*
 * Stiffness per area against the body at a node. The gap of a soft structure on it closes by
 * own/(own + e) of itself a system, slowly where kappa is small, so e doubles with each system of a
 * load step.
 */
static pzs_real against(const pzs_contact *contact, const pzs_solver *solver, uint16_t node)
{
    pzs_real e = contact->settings.stiffness;
    for (uint32_t i = 0; i < solver->state.iteration && e < FIRM; i++)
        e *= 2;
    return e * own_stiffness(contact, solver, node);
}

/* ---- which nodes ------------------------------------------------------ */

/* facing = normal of the deformed face, out of the shell, times that of the body, summed over the
 * elements of a node. */
static void find_facing(pzs_contact *contact, const pzs_solver *solver)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    const pzs_real z = height(contact, solver);
    memset(contact->state.facing, 0, structure->nodes * sizeof *contact->state.facing);
    for (uint32_t e = 0; e < structure->elements; e++) {
        pzs_real w[SHELL_NODES][3];
        pzs_face_gather(solver->state.model, structure->element[e], SHELL_NODES, z,
                        solver->state.displacement, w);
        for (unsigned r = 0; r < SHELL_NODES; r++) {
            const uint16_t node = structure->element[e][r];
            const place at = place_of(contact, solver, node);
            pzs_real eta[3];
            pzs_face_normal(&structure->type[structure->element_type[e]], z,
                            (const pzs_real(*)[3])w, r, eta);
            contact->state.facing[node] +=
                contact->state.face->face == 0 ? -dot(eta, at.normal) : dot(eta, at.normal);
        }
    }
}

/* May a node touch at all: does it point at the body, and can it move? */
static int may_touch(const pzs_contact *contact, const pzs_solver *solver, uint16_t node)
{
    return contact->state.facing[node] < 0 && own_stiffness(contact, solver, node) > 0;
}

/* Does a node belong into contact, by its gap and pressure? A closed one does while it is pressed.
 */
static int belongs(const pzs_contact *contact, const pzs_solver *solver, uint16_t node)
{
    if (!may_touch(contact, solver, node))
        return 0;
    const pzs_real gap = place_of(contact, solver, node).gap, closed = contact_closed(contact);
    const pzs_real least = gap < 0 && gap >= -closed ? 0 : gap;
    if (!contact->state.touching[node])
        return gap < -closed;
    return contact->state.pressure[node] > WEIGHING * own_stiffness(contact, solver, node) * least;
}

/* The node of smallest gap that may touch, or -1. */
static int32_t nearest(const pzs_contact *contact, const pzs_solver *solver)
{
    int32_t best = -1;
    pzs_real least = 0;
    for (uint16_t n = 0; n < solver->state.model->state.structure->nodes; n++) {
        const pzs_real gap = may_touch(contact, solver, n) ? place_of(contact, solver, n).gap : 0;
        if (may_touch(contact, solver, n) && (best < 0 || gap < least)) {
            best = n;
            least = gap;
        }
    }
    return best;
}

/* Nodes in contact for the first system of a load step: those of the last equilibrium and those
 * that a motion of the body ran into; without any of the former, those whose gap is closed. */
static void begin(pzs_contact *contact, const pzs_solver *solver)
{
    const uint16_t nodes = solver->state.model->state.structure->nodes;
    uint32_t given = 0, added = 0;
    for (uint16_t n = 0; n < nodes; n++)
        given += contact->state.touching[n];
    const pzs_real most = given > 0 ? -contact_closed(contact) : contact_closed(contact);
    for (uint16_t n = 0; n < nodes; n++)
        if (!contact->state.touching[n] && may_touch(contact, solver, n) &&
            place_of(contact, solver, n).gap <= most) {
            contact->state.touching[n] = 1;
            added++;
        }
    contact->state.is_warm = given > 0 && added == 0;
    contact->state.has_changed = added > 0;
    contact->state.is_adrift = given + added == 0;
}

/* Nodes in contact by gap and pressure; of a loose shell the nearest one stays, which nothing
 * settles with (settled). */
static void choose(pzs_contact *contact, const pzs_solver *solver)
{
    const uint16_t nodes = solver->state.model->state.structure->nodes;
    uint32_t count = 0;
    for (uint16_t n = 0; n < nodes; n++) {
        const uint8_t now = (uint8_t)belongs(contact, solver, n);
        contact->state.has_changed =
            (uint8_t)(contact->state.has_changed || now != contact->state.touching[n]);
        contact->state.touching[n] = now;
        count += now;
        if (!now)
            contact->state.pressure[n] = 0;
    }
    const int32_t lone = count == 0 && contact->state.is_loose ? nearest(contact, solver) : -1;
    contact->state.is_adrift = lone >= 0;
    if (lone >= 0)
        contact->state.touching[lone] = 1;
}

static int prepare(pzs_solver_option *option, pzs_solver *solver)
{
    pzs_contact *contact = contact_of(option);
    contact->state.has_changed = 0;
    find_facing(contact, solver);
    if (solver->state.iteration == 0)
        begin(contact, solver);
    else if (!contact->state.is_warm || solver->info.relative_increment < QUIET)
        choose(contact, solver);
    return solver->state.iteration > 0 || !contact->state.is_loose || !contact->state.is_adrift;
}

static int settled(pzs_solver_option *option, pzs_solver *solver)
{
    pzs_contact *contact = contact_of(option);
    if (contact->state.has_changed)
        return 0;
    find_facing(contact, solver);
    const pzs_real closed = contact_closed(contact);
    for (uint16_t n = 0; n < solver->state.model->state.structure->nodes; n++) {
        const pzs_real gap = contact->state.touching[n] ? place_of(contact, solver, n).gap : 0;
        if (gap > closed || gap < -closed ||
            belongs(contact, solver, n) != contact->state.touching[n])
            return 0;
    }
    return 1;
}

static pzs_status refuses(pzs_solver_option *option, pzs_solver *solver)
{
    pzs_contact *contact = contact_of(option);
    const pzs_status status = contact_check(contact, solver);
    solver->state.refused_at = contact->info.element;
    return status;
}

static pzs_real longest(pzs_solver_option *option, const pzs_solver *solver, const pzs_real *amount)
{
    return contact_longest(contact_of(option), solver, amount);
}

/* ---- forces ----------------------------------------------------------- */

/* Stiffness w (e n n' - p Hess g) of a node's face onto its unknowns. */
static void add_stiffness(const pzs_contact *contact, pzs_solver *solver, uint16_t node,
                          const place *at, pzs_real e)
{
    const pzs_real z = height(contact, solver);
    pzs_real k[SHELL_PACKED(7)] = {0};
    for (unsigned i = 0; i < 6; i++)
        for (unsigned j = 0; j <= i; j++)
            k[SHELL_PACKED(i) + j] = (i < 3 ? 1 : z) * (j < 3 ? 1 : z) *
                                     (e * at->normal[i % 3] * at->normal[j % 3] -
                                      contact->state.pressure[node] * at->hessian[i % 3][j % 3]);
    pzs_model_add_matrix(solver->state.model, &node, 1, contact->state.face->area[node], k);
}

static void add(pzs_solver_option *option, pzs_solver *solver, pzs_real *load)
{
    pzs_contact *contact = contact_of(option);
    memset(contact->info.force, 0, sizeof contact->info.force);
    contact->info.nodes = 0;
    for (uint16_t n = 0; n < solver->state.model->state.structure->nodes; n++) {
        if (!contact->state.touching[n])
            continue;
        const place at = place_of(contact, solver, n);
        const pzs_real e = against(contact, solver, n);
        const pzs_real push =
            contact->state.face->area[n] * (contact->state.pressure[n] - e * at.gap);
        pzs_real force[1][3];
        for (int i = 0; i < 3; i++) {
            force[0][i] = push * at.normal[i];
            contact->info.force[i] +=
                contact->state.face->area[n] * contact->state.pressure[n] * at.global[i];
        }
        pzs_face_scatter(solver->state.model, &n, 1, height(contact, solver),
                         (const pzs_real(*)[3])force, load);
        add_stiffness(contact, solver, n, &at, e);
        contact->info.nodes++;
    }
}

static void solved(pzs_solver_option *option, pzs_solver *solver, const pzs_real *du)
{
    pzs_contact *contact = contact_of(option);
    for (uint16_t n = 0; n < solver->state.model->state.structure->nodes; n++) {
        if (!contact->state.touching[n])
            continue;
        const place at = place_of(contact, solver, n);
        pzs_real d[3];
        displacement(contact, solver, n, du, d);
        contact->state.pressure[n] -= against(contact, solver, n) * (at.gap + dot(at.normal, d));
    }
}

/* Force per unit of the body's motion m: its gap falls by n . m, its normal turns by -Hess g m. */
static void unit(pzs_solver_option *option, pzs_solver *solver, uint32_t input, pzs_real *out)
{
    const pzs_contact *contact = contact_of(option);
    for (uint16_t n = 0;
         input == contact->state.face->input && n < solver->state.model->state.structure->nodes;
         n++) {
        if (!contact->state.touching[n])
            continue;
        const place at = place_of(contact, solver, n);
        const pzs_real e = against(contact, solver, n);
        pzs_real force[1][3], m[3];
        for (int i = 0; i < 3; i++)
            m[i] = dot(contact->state.face->triad[n][i], contact->state.face->motion);
        for (int i = 0; i < 3; i++)
            force[0][i] =
                contact->state.face->area[n] * (e * dot(at.normal, m) * at.normal[i] -
                                                contact->state.pressure[n] * dot(at.hessian[i], m));
        pzs_face_scatter(solver->state.model, &n, 1, height(contact, solver),
                         (const pzs_real(*)[3])force, out);
    }
}

/* ---- state ------------------------------------------------------------ */

static void keep(pzs_solver_option *option, pzs_solver *solver)
{
    pzs_contact *contact = contact_of(option);
    memcpy(contact->state.kept_pressure, contact->state.pressure,
           solver->state.model->state.structure->nodes * sizeof *contact->state.pressure);
    memcpy(contact->state.kept_touching, contact->state.touching,
           solver->state.model->state.structure->nodes);
}

static void restore(pzs_solver_option *option, pzs_solver *solver)
{
    pzs_contact *contact = contact_of(option);
    memcpy(contact->state.pressure, contact->state.kept_pressure,
           solver->state.model->state.structure->nodes * sizeof *contact->state.pressure);
    memcpy(contact->state.touching, contact->state.kept_touching,
           solver->state.model->state.structure->nodes);
}

static void rest(pzs_solver_option *option, pzs_solver *solver)
{
    pzs_contact *contact = contact_of(option);
    memset(contact->state.pressure, 0,
           solver->state.model->state.structure->nodes * sizeof *contact->state.pressure);
    memset(contact->state.touching, 0, solver->state.model->state.structure->nodes);
    memset(contact->info.force, 0, sizeof contact->info.force);
    contact->info.nodes = 0;
    contact->info.penetration = 0;
    contact->info.sag = 0;
    contact->info.depth = 0;
    keep(option, solver);
}

/* ---- supports --------------------------------------------------------- */

static int is_fixed(const pzs_solver *solver, uint16_t dof)
{
    const pzs_prescribed_motion *p = &solver->state.tables->prescribed;
    int fixed = dof == PZS_CONSTRAINED || (solver->state.model->state.constrained &&
                                           solver->state.model->state.constrained[dof]);
    for (uint32_t i = 0; i < p->count && !fixed; i++)
        fixed = p->dof[i] == dof;
    return fixed;
}

/* gram [6][6] += row row', row = what a rigid motion (translation, rotation times size) does to
 * unknown k < 6 of a node. */
static void add_support(const pzs_contact *contact, pzs_real z, uint16_t node, int k,
                        pzs_real gram[6][6])
{
    const pzs_real(*triad)[3] = contact->state.face->triad[node], *e = triad[k % 3];
    pzs_real arm[3], row[6];
    for (int i = 0; i < 3; i++)
        arm[i] = k < 3 ? (contact->state.face->place[node][i] - z * triad[2][i] -
                          contact->state.face->place[0][i]) /
                             contact->state.face->size
                       : triad[2][i];
    for (int i = 0; i < 3; i++) {
        row[i] = k < 3 ? e[i] : 0;
        row[3 + i] = arm[(i + 1) % 3] * e[(i + 2) % 3] - arm[(i + 2) % 3] * e[(i + 1) % 3];
    }
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++)
            gram[i][j] += row[i] * row[j];
}

/*
 * Do the supports leave the shell a rigid motion? Then its nearest node stays in contact. Each
 * support is a row of size 1; what is left of a motion after the others must be above the rounding
 * of their sum, and a thousandth of a row.
 */
static int is_loose(const pzs_contact *contact, const pzs_solver *solver)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    pzs_real gram[6][6] = {{0}}, least[6];
    for (uint16_t n = 0; n < structure->nodes; n++)
        for (int k = 0; k < 6; k++)
            if (is_fixed(solver,
                         structure->node_dof[(size_t)n * structure->dof_per_node + (size_t)k]))
                add_support(contact, height(contact, solver), n, k, gram);
    for (int i = 0; i < 6; i++)
        least[i] = (pzs_real)1e-6 + 16 * PZS_EPSILON * gram[i][i];
    for (int p = 0; p < 6; p++) {
        if (!(gram[p][p] > least[p]))
            return 1;
        for (int i = p + 1; i < 6; i++)
            for (int j = p + 1; j < 6; j++)
                gram[i][j] -= gram[i][p] * gram[p][j] / gram[p][p];
    }
    return 0;
}

/* ---- choices and errors ------------------------------------------------- */

static int choices_in_range(const pzs_solver_option *option)
{
    const pzs_real stiffness = ((const pzs_contact *)(const void *)option)->settings.stiffness;
    return stiffness > 0 && pzs_guard_nonfinite(&stiffness, 1) < 0;
}

/* A loose shell: it does not touch the body or is not pressed onto it; or its first contact leaves
 * it free to slide. */
static int adrift(const pzs_solver_option *option, const pzs_solver *solver)
{
    const pzs_contact *contact = (const pzs_contact *)(const void *)option;
    uint32_t kept = 0;
    for (uint16_t n = 0; n < solver->state.model->state.structure->nodes; n++)
        kept += contact->state.kept_touching[n];
    return contact->state.is_loose &&
           (contact->state.is_adrift ||
            (kept == 0 && (solver->info.where >= 0 || solver->info.negative_pivots > 0)));
}

static const struct pzs_solver_option_calls calls = {
    .choices_in_range = choices_in_range,
    .prepare = prepare,
    .add = add,
    .solved = solved,
    .settled = settled,
    .unsettled = PZS_E_CONTACT,
    .refuses = refuses,
    .longest = longest,
    .adrift = adrift,
    .keep = keep,
    .restore = restore,
    .rest = rest,
    .unit = unit,
};

/* ---- attach ------------------------------------------------------------- */

uint32_t pzs_contact_crc(const pzs_contact_face *face, const pzs_structure *structure)
{
    const uint16_t whole[2] = {face->face, face->input};
    uint32_t crc = pzs_guard_crc(GUARD_CRC_START, whole, sizeof whole);
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

/* Is a body one that its gap function can take? *where = index of a number that is none: point,
 * axis, radius. */
static pzs_status check_body(const pzs_body *body, int32_t *where)
{
    const int has_axis = body->gap == pzs_gap_plane || body->gap == pzs_gap_cylinder;
    const int has_radius = body->gap == pzs_gap_cylinder || body->gap == pzs_gap_sphere;
    const pzs_real off = dot(body->axis, body->axis) - 1;
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
    return has_axis && !(PZS_ABS(off) <= UNIT) ? PZS_E_ARGUMENT : PZS_OK;
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
                   (face->input < structure->input.count || face->input == NO_MOTION)
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
    const int32_t lacking = guard_missing_bytes(work, bytes, PZS_CONTACT_BYTES(nodes));
    if (lacking >= 0) {
        solver->info.where = lacking;
        return PZS_E_WORKSPACE;
    }
    if (pzs_nonlinear_is_attached(solver, &contact->option))
        return PZS_E_ARGUMENT;
    memset(contact, 0, sizeof *contact);
    contact->state.face = face;
    contact->state.body = body;
    contact->state.pressure = work;
    contact->state.kept_pressure = contact->state.pressure + nodes;
    contact->state.facing = contact->state.kept_pressure + nodes;
    contact->state.touching = (uint8_t *)(contact->state.facing + nodes);
    contact->state.kept_touching = contact->state.touching + nodes;
    contact->info.pressure = contact->state.pressure;
    contact->settings.stiffness = 10;
    contact->info.node = PZS_CONSTRAINED;
    contact->state.reach = contact_reach(contact, solver->state.model->state.structure);
    contact->state.is_loose = is_loose(contact, solver);
    rest(&contact->option, solver);
    pzs_nonlinear_attach(solver, &contact->option, &calls);
    return PZS_OK;
}

#endif
