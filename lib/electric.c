/*
 * Open electrodes at a shape (pzs.h). Their volts V are unknowns of the same Newton's method,
 *   K du - f dV = imbalance,  f' du + C dV = charge asked for - charge there is,
 * f the force of a volt, which turns with the shell. dV is taken out by a Schur complement on the factor of K.
 */
#include "electrode.h"
#include "guard.h"
#include "linalg.h"
#include "model.h"
#include "nonlinear.h"
#include "shell.h"
#include <string.h>

#if PZS_NONLINEAR

static pzs_circuit *circuit_of(pzs_option *option)
{
    return (pzs_circuit *)option;
}

/* Charge at path->u: the resultants of a volt times the strains, their sign turned, and what flows while these are held. */
static pzs_real charge_at(const pzs_path *path, const pzs_electrodes *t, uint32_t electrode)
{
    const pzs_structure *s = path->model->structure;
    const pzs_given *g = &path->tables->given;
    const uint16_t input = t->input[electrode];
    pzs_real charge = 0;
    for (uint32_t i = g->start[input]; i < g->start[input + 1]; i++) {
        pzs_real u[SHELL_MAX], e[SHELL_MODES][SHELL_STRAINS];
        model_gather(path->model, s->element[g->element[i]], SHELL_NODES, path->u, u);
        shell_strains_at(&s->kind[s->element_kind[g->element[i]]], s->unknowns, u, e);
        charge -= linalg_inner(g->value[g->which[i]], e[0], SHELL_STRAINS);
    }
    for (uint32_t i = t->direct.start[electrode]; i < t->direct.start[electrode + 1]; i++)
        charge += t->direct.value[i] * path->amount[t->direct.dof[i]];
    return charge;
}

pzs_status pzs_charges_at(const pzs_path *path, const pzs_electrodes *tables, pzs_real *charge)
{
    if (!path || !path->model || !tables || !charge || !path->tables->given.start)
        return PZS_E_ARGUMENT;
    for (uint32_t k = 0; k < tables->count; k++)
        charge[k] = charge_at(path, tables, k);
    return PZS_OK;
}

/* Force of a volt on open electrode a.  f [dof] out */
static void volt_force(const pzs_circuit *c, pzs_path *path, uint32_t a, pzs_real *f)
{
    memset(f, 0, path->model->structure->dof * sizeof *f);
    nonlinear_unit_force(path, electrode_open_input(c->tables, a), f);
}

/* z = K^-1 z, where prescribed unknowns do not move. */
static void solve_free(pzs_path *path, pzs_real *z)
{
    nonlinear_clear_prescribed(path, z);
    model_backsolve(path->model, z, z);
}

/* Charge per volt between open electrodes at path->u, factored; f, z [dof] work. Returns whether it can be solved. */
static int factor_open(pzs_circuit *c, pzs_path *path, pzs_real *f, pzs_real *z)
{
    const uint32_t dof = path->model->structure->dof;
    linalg_clear(&c->open);
    for (uint32_t a = 0; a < c->open.n; a++) {
        const uint32_t k = electrode_open(c->tables, a);
        volt_force(c, path, a, z);
        solve_free(path, z);
        for (uint32_t b = 0; b <= a; b++) {
            volt_force(c, path, b, f);
            *linalg_entry(&c->open, a, b) =
                linalg_inner(f, z, dof) + electrode_direct(c->tables, k, electrode_open_input(c->tables, b));
        }
    }
    const linalg_inertia inertia = linalg_factor(&c->open);
    /* Inertia is additive: a negative pivot of K that open electrodes stiffen away comes back here. */
    path->negative -= inertia.negative < path->negative ? inertia.negative : path->negative;
    return inertia.zero < 0;
}

static int condense(pzs_option *option, pzs_path *path, uint32_t input, pzs_real *du)
{
    pzs_circuit *c = circuit_of(option);
    const uint32_t dof = path->model->structure->dof;
    pzs_real *z = path->model->work + 2 * (size_t)dof, *f = z + dof;
    if (input == NEWTON && !factor_open(c, path, f, z))
        return 0;
    for (uint32_t a = 0; a < c->open.n; a++) {
        const uint32_t k = electrode_open(c->tables, a);
        volt_force(c, path, a, f);
        c->change[a] = input == NEWTON ? c->charge[k] - charge_at(path, c->tables, k)
                                       : (c->tables->input[k] == input) - electrode_direct(c->tables, k, input);
        c->change[a] -= linalg_inner(f, du, dof);
    }
    linalg_solve(&c->open, c->change);
    memset(z, 0, dof * sizeof *z);
    for (uint32_t a = 0; a < c->open.n; a++) {
        volt_force(c, path, a, f);
        for (uint32_t i = 0; i < dof; i++)
            z[i] += c->change[a] * f[i];
    }
    solve_free(path, z);
    for (uint32_t i = 0; i < dof; i++)
        du[i] += z[i];
    return 1;
}

/* The volts into the path's amounts and resultants. */
static void apply(const pzs_circuit *c, pzs_path *path)
{
    for (uint32_t a = 0; a < c->open.n; a++)
        path->amount[electrode_open_input(c->tables, a)] = c->volt[a];
    nonlinear_set_given(path);
}

static int prepare(pzs_option *option, pzs_path *path)
{
    if (path->iteration == 0)
        apply(circuit_of(option), path);
    return 1;
}

static void solved(pzs_option *option, pzs_path *path, const pzs_real *du)
{
    pzs_circuit *c = circuit_of(option);
    (void)du;
    for (uint32_t a = 0; a < c->open.n; a++)
        c->volt[a] += c->change[a];
    apply(c, path);
}

static int settled(pzs_option *option, pzs_path *path)
{
    const pzs_circuit *c = circuit_of(option);
    const pzs_real volt2 = linalg_inner(c->volt, c->volt, c->open.n);
    const pzs_real change2 = linalg_inner(c->change, c->change, c->open.n);
    return change2 <= path->change * path->change * volt2;
}

static void keep(pzs_option *option, pzs_path *path)
{
    const pzs_circuit *c = circuit_of(option);
    (void)path;
    memcpy(c->kept_volt, c->volt, c->open.n * sizeof *c->volt);
}

static void restore(pzs_option *option, pzs_path *path)
{
    const pzs_circuit *c = circuit_of(option);
    memcpy(c->volt, c->kept_volt, c->open.n * sizeof *c->volt);
    apply(c, path);
}

static void rest(pzs_option *option, pzs_path *path)
{
    const pzs_circuit *c = circuit_of(option);
    memset(c->kept_volt, 0, c->open.n * sizeof *c->volt);
    restore(option, path);
}

static const struct pzs_option_calls calls = {
    .prepare = prepare, .solved = solved, .settled = settled, .unsettled = PZS_E_DIVERGED, .keep = keep,
    .restore = restore, .rest = rest, .condense = condense,
};

pzs_status pzs_attach_circuit(pzs_path *path, pzs_circuit *c, const pzs_electrodes *tables, void *work, size_t bytes)
{
    if (!path || !path->model || !c || !work || !path->tables->given.start)
        return PZS_E_ARGUMENT;
    const pzs_status status = electrode_check(tables, path->model->structure);
    if (status != PZS_OK)
        return status;
    const uint32_t open = electrode_open_count(tables);
    const int32_t lacking = guard_short(work, bytes, PZS_CIRCUIT_BYTES(tables->count, open));
    if (lacking >= 0) {
        path->where = lacking;
        return PZS_E_WORKSPACE;
    }
    if (nonlinear_is_attached(path, &c->option))
        return PZS_E_ARGUMENT;
    memset(c, 0, sizeof *c);
    c->tables = tables;
    c->charge = work;
    c->volt = c->charge + tables->count;
    c->kept_volt = c->volt + open;
    c->change = c->kept_volt + open;
    memset(work, 0, sizeof *c->charge * ((size_t)tables->count + 3 * (size_t)open));
    electrode_layout(&c->open, open, c->change + open, c->change + open + PZS_DENSE(open));
    nonlinear_attach(path, &c->option, &calls);
    return PZS_OK;
}

#endif
