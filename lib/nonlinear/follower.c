/*
 * Follower loads: pressures that turn with a face of the shell (pzs.h).
 *
 * With G_a the base vectors of the deformed face at a corner, t = e3 + difference/h its director
 * and U_a = G_a - (g_a . e3) t,  n = U_1 x U_2,  side = lean_1 t x U_2 + lean_2 U_1 x t the
 * pressure pushes along n, on the loaded face, and, where the base vectors are chords, along side
 * on the middle: so it does at the end of an arc that is cut into sides. Everything is quadratic in
 * the unknowns; the unit normal divides by |n|.
 */
#include "face.h"
#include "../core/guard.h"
#include "../model/model.h"
#include "nonlinear.h"
#include "../model/shell.h"
#include <string.h>

#if PZS_NONLINEAR

/* A vector at a corner and its derivative by the displacement of normal_face at the four corners,
 * then by t. */
enum { BY_DIRECTOR = 12, SLOPES = 15 };
typedef struct turning {
    pzs_real v[3], slope[3][SLOPES];
} turning;

/* Unknowns of an element that a face has: mean and difference/h of four corners. */
enum { OWN = 6, ALL = 24 };

/* sum += factor x x y */
static void add_cross(pzs_real factor, const turning *x, const turning *y, turning *sum)
{
    pzs_real c[3], d[3];
    pzs_face_cross(x->v, y->v, c);
    for (int i = 0; i < 3; i++)
        sum->v[i] += factor * c[i];
    for (int j = 0; j < SLOPES; j++) {
        const pzs_real dx[3] = {x->slope[0][j], x->slope[1][j], x->slope[2][j]};
        const pzs_real dy[3] = {y->slope[0][j], y->slope[1][j], y->slope[2][j]};
        pzs_face_cross(dx, y->v, c);
        pzs_face_cross(x->v, dy, d);
        for (int i = 0; i < 3; i++)
            sum->slope[i][j] += factor * (c[i] + d[i]);
    }
}

/* x / |n| */
static void divide(const turning *n, pzs_real size, turning *x)
{
    const pzs_real inverse = size > 0 ? 1 / size : 0;
    for (int i = 0; i < 3; i++)
        x->v[i] *= inverse;
    for (int j = 0; j < SLOPES; j++) {
        const pzs_real longer = inverse * (n->v[0] * n->slope[0][j] + n->v[1] * n->slope[1][j] +
                                           n->v[2] * n->slope[2][j]);
        for (int i = 0; i < 3; i++)
            x->slope[i][j] = inverse * (x->slope[i][j] - longer * x->v[i]);
    }
}

/* U_a at corner r. */
static void set_base(const pzs_element_type *type, pzs_real z, unsigned r, unsigned a,
                     const pzs_real g[3], const turning *t, turning *base)
{
    const unsigned neighbour = a == 0 ? r ^ 1u : 3u - r;
    const pzs_real lean = type->g_mean[r][a][2] + z * type->g_diff[r][a][2];
    memset(base, 0, sizeof *base);
    for (unsigned i = 0; i < 3; i++) {
        base->v[i] = g[i] - lean * t->v[i];
        base->slope[i][BY_DIRECTOR + i] = -lean;
        for (unsigned j = 0; j < 3; j++) {
            base->slope[i][3 * r + j] = type->s[r][a][i][j];
            base->slope[i][3 * neighbour + j] = type->t[r][a][i][j];
        }
    }
}

/* n and side at corner r of an element of a kind, per reference area.  w [4][3], t [3] in */
static void push_at(const pzs_follower *load, const pzs_structure *structure, uint16_t kind,
                    const pzs_real (*w)[3], const pzs_real t[3], unsigned r, turning *n,
                    turning *side)
{
    const pzs_real z = pzs_face_height(structure, load->normal_face);
    pzs_real g[2][3];
    turning director = {{t[0], t[1], t[2]}, {{0}}}, base[2];
    pzs_face_base(&structure->type[kind], z, w, r, g);
    for (unsigned i = 0; i < 3; i++)
        director.slope[i][BY_DIRECTOR + i] = 1;
    for (unsigned a = 0; a < 2; a++)
        set_base(&structure->type[kind], z, r, a, g[a], &director, &base[a]);
    memset(n, 0, sizeof *n);
    memset(side, 0, sizeof *side);
    add_cross(1, &base[0], &base[1], n);
    if (load->lean) {
        add_cross(load->lean[kind][r][0], &director, &base[1], side);
        add_cross(load->lean[kind][r][1], &base[0], &director, side);
    }
    if (!load->true_area) {
        const turning whole = *n;
        const pzs_real size = PZS_SQRT(n->v[0] * n->v[0] + n->v[1] * n->v[1] + n->v[2] * n->v[2]);
        divide(&whole, size, side);
        divide(&whole, size, n);
    }
}

/* Force on corner r of `part` of what corner `from` gives, and its slope over the own unknowns;
 * slope may be NULL. */
static void add_part(const turning *x, pzs_real part, pzs_real z_load, pzs_real z, unsigned from,
                     unsigned r, pzs_real *force, pzs_real (*slope)[ALL])
{
    for (unsigned i = 0; i < 6; i++) {
        const pzs_real factor = i < 3 ? part : part * z_load;
        force[OWN * r + i] += factor * x->v[i % 3];
        for (unsigned j = 0; slope && factor != 0 && j < SLOPES; j++) {
            const unsigned column =
                j < BY_DIRECTOR ? OWN * (j / 3) + j % 3 : OWN * from + j - BY_DIRECTOR + 3;
            const pzs_real change = factor * x->slope[i % 3][j];
            slope[OWN * r + i][column] += change;
            if (j < BY_DIRECTOR)
                slope[OWN * r + i][column + 3] += z * change;
        }
    }
}

/*
 * Forces of one element at path->u for `amount` of the load, in the frames of its corners.
 *   force [24]     out
 *   slope [24][24] out their derivative S; NULL: not wanted
 */
static void element_force(const pzs_follower *load, const pzs_solver *solver, uint32_t e,
                          pzs_real amount, pzs_real *force, pzs_real (*slope)[ALL])
{
    const pzs_structure *structure = solver->state.model->state.structure;
    const uint16_t *node = structure->element[e], kind = structure->element_type[e];
    const pzs_real z = pzs_face_height(structure, load->normal_face),
                   z_load = pzs_face_height(structure, load->load_face);
    pzs_real u[SHELL_MAX], w[SHELL_NODES][3];
    pzs_model_gather(solver->state.model, node, SHELL_NODES, solver->state.displacement, u);
    pzs_face_gather(solver->state.model, node, SHELL_NODES, z, solver->state.displacement, w);
    memset(force, 0, ALL * sizeof *force);
    if (slope)
        memset(slope, 0, ALL * sizeof *slope);
    for (unsigned from = 0; from < SHELL_NODES; from++) {
        const pzs_real size = amount * load->pressure[node[from]] * load->area[kind][from],
                       *d = u + from * structure->dof_per_node + 3;
        const pzs_real t[3] = {d[0], d[1], 1 + d[2]};
        turning n, side;
        push_at(load, structure, kind, (const pzs_real(*)[3])w, t, from, &n, &side);
        for (unsigned r = 0; r < SHELL_NODES; r++) {
            const pzs_real part = size * load->share[r == from ? 0 : (r ^ from) == 2 ? 2 : 1];
            if (part != 0)
                add_part(&n, part, z_load, z, from, r, force, slope);
            if (part != 0 && load->lean)
                add_part(&side, part, 0, z, from, r, force, slope);
        }
    }
}

/* ---- over the element's unknowns --------------------------------------- */

/* Own unknown of an element's unknown i, or ALL for one that moves no face. */
static unsigned own_of(unsigned i, unsigned dof_per_node)
{
    return i % dof_per_node < OWN ? i / dof_per_node * OWN + i % dof_per_node : ALL;
}

/* f [dof] += factor times the forces [24] of an element */
static void scatter(const pzs_solver *solver, uint32_t e, pzs_real factor, const pzs_real *force,
                    pzs_real *f)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    pzs_real all[SHELL_MAX];
    for (unsigned i = 0; i < SHELL_NODES * (unsigned)structure->dof_per_node; i++)
        all[i] = own_of(i, structure->dof_per_node) < ALL
                     ? force[own_of(i, structure->dof_per_node)]
                     : 0;
    pzs_model_scatter(solver->state.model, structure->element[e], SHELL_NODES, factor, all, f);
}

/* k [packed] = -(S + S')/2 */
static void symmetric_tangent(pzs_real (*slope)[ALL], unsigned dof_per_node, pzs_real *k)
{
    unsigned own[SHELL_MAX];
    for (unsigned i = 0; i < SHELL_NODES * dof_per_node; i++) {
        own[i] = own_of(i, dof_per_node);
        for (unsigned j = 0; j <= i; j++)
            *k++ = own[i] < ALL && own[j] < ALL
                       ? -(slope[own[i]][own[j]] + slope[own[j]][own[i]]) / 2
                       : 0;
    }
}

/* ---- calls -------------------------------------------------------------- */

static void add(pzs_solver_option *option, pzs_solver *solver, pzs_real *load)
{
    const pzs_follower *tables = ((pzs_follower_load *)option)->state.tables;
    const pzs_structure *structure = solver->state.model->state.structure;
    const pzs_real amount = solver->state.input_value[tables->input];
    for (uint32_t e = 0; amount != 0 && e < structure->elements; e++) {
        pzs_real force[ALL], slope[ALL][ALL], k[SHELL_PACKED(SHELL_MAX)];
        element_force(tables, solver, e, amount, force, slope);
        scatter(solver, e, 1, force, load);
        symmetric_tangent(slope, structure->dof_per_node, k);
        pzs_model_add_matrix(solver->state.model, structure->element[e], SHELL_NODES, 1, k);
    }
}

static void unit(pzs_solver_option *option, pzs_solver *solver, uint32_t input, pzs_real *out)
{
    const pzs_follower *tables = ((pzs_follower_load *)option)->state.tables;
    for (uint32_t e = 0;
         input == tables->input && e < solver->state.model->state.structure->elements; e++) {
        pzs_real force[ALL];
        element_force(tables, solver, e, 1, force, NULL);
        scatter(solver, e, 1, force, out);
    }
}

/* (S - S')/2 x */
static void skew(pzs_solver_option *option, pzs_solver *solver, const pzs_real *x, pzs_real factor,
                 pzs_real *y)
{
    const pzs_follower *tables = ((pzs_follower_load *)option)->state.tables;
    const pzs_structure *structure = solver->state.model->state.structure;
    const pzs_real amount = solver->state.input_value[tables->input];
    for (uint32_t e = 0; amount != 0 && e < structure->elements; e++) {
        pzs_real force[ALL], slope[ALL][ALL], u[SHELL_MAX], own[ALL];
        element_force(tables, solver, e, amount, force, slope);
        pzs_model_gather(solver->state.model, structure->element[e], SHELL_NODES, x, u);
        for (unsigned i = 0; i < ALL; i++) {
            own[i] = u[i / OWN * structure->dof_per_node + i % OWN];
            force[i] = 0;
        }
        for (unsigned i = 0; i < ALL; i++)
            for (unsigned j = 0; j < ALL; j++)
                force[i] += (slope[i][j] - slope[j][i]) * own[j];
        scatter(solver, e, factor / 2, force, y);
    }
}

static const struct pzs_solver_option_calls calls = {.add = add, .unit = unit, .skew = skew};

uint32_t pzs_follower_crc(const pzs_follower *tables, const pzs_structure *structure)
{
    const uint16_t whole[4] = {tables->input, tables->load_face, tables->normal_face,
                               tables->true_area};
    uint32_t crc = pzs_guard_crc(GUARD_CRC_START, whole, sizeof whole);
    crc = pzs_guard_crc(crc, tables->share, sizeof tables->share);
    crc = pzs_guard_crc(crc, tables->area, structure->types * sizeof *tables->area);
    if (tables->lean)
        crc = pzs_guard_crc(crc, tables->lean, structure->types * sizeof *tables->lean);
    return ~pzs_guard_crc(crc, tables->pressure, structure->nodes * sizeof *tables->pressure);
}

pzs_status pzs_follower_seal(pzs_follower *tables, const pzs_structure *structure)
{
    if (!tables || !structure || !tables->area || !tables->pressure)
        return PZS_E_ARGUMENT;
    tables->format = PZS_TABLE_FORMAT;
    tables->scene = structure->scene;
    tables->crc = pzs_follower_crc(tables, structure);
    return PZS_OK;
}

static pzs_status check(const pzs_follower *tables, const pzs_structure *structure)
{
    if (!tables->area || !tables->pressure)
        return PZS_E_ARGUMENT;
    if (tables->format != PZS_TABLE_FORMAT || tables->scene != structure->scene)
        return PZS_E_FORMAT;
    if (pzs_follower_crc(tables, structure) != tables->crc)
        return PZS_E_CRC;
    return tables->load_face <= 2 && tables->normal_face <= 1 &&
                   tables->input < structure->input.count
               ? PZS_OK
               : PZS_E_ARGUMENT;
}

pzs_status pzs_attach_follower(pzs_solver *solver, pzs_follower_load *load,
                               const pzs_follower *tables)
{
    if (!solver || !solver->state.model || !load || !tables ||
        pzs_nonlinear_is_attached(solver, &load->option))
        return PZS_E_ARGUMENT;
    const pzs_status status = check(tables, solver->state.model->state.structure);
    if (status != PZS_OK)
        return status;
    load->state.tables = tables;
    pzs_nonlinear_attach(solver, &load->option, &calls);
    return PZS_OK;
}

#endif
