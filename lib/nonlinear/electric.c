/*
 * Open electrodes at a shape (pzs.h). Their volts V are unknowns of the same Newton's method,
 *   K du - f dV = imbalance,  f' du + C dV = charge asked for - charge there is,
 * f the force of a volt, which turns with the shell. dV is taken out by a Schur complement on the
 * factor of K.
 */
#include "../model/electrode.h"
#include "../core/guard.h"
#include "../core/linalg.h"
#include "../model/model.h"
#include "nonlinear.h"
#include "../model/shell.h"
#include <string.h>

#if PZS_NONLINEAR

static pzs_circuit *circuit_of(pzs_solver_option *option)
{
    return (pzs_circuit *)option;
}

/* Charge at path->u: the resultants of a volt times the strains, their sign turned, and what flows
 * while these are held. */
static pzs_real charge_at(const pzs_solver *path, const pzs_electrodes *t, uint32_t electrode)
{
    const pzs_structure *s = path->state.model->state.structure;
    const pzs_prescribed_resultants *g = &path->state.tables->given;
    const uint16_t input = t->input[electrode];
    pzs_real charge = 0;
    for (uint32_t i = g->start[input]; i < g->start[input + 1]; i++) {
        pzs_real u[SHELL_MAX], e[SHELL_MODES][SHELL_STRAINS];
        pzs_model_gather(path->state.model, s->element[g->element[i]], SHELL_NODES,
                         path->state.displacement, u);
        pzs_shell_strains_at(&s->type[s->element_type[g->element[i]]], s->dof_per_node, u, e);
        charge -= pzs_linalg_inner(g->value[g->which[i]], e[0], SHELL_STRAINS);
    }
    for (uint32_t i = t->direct.start[electrode]; i < t->direct.start[electrode + 1]; i++)
        charge += t->direct.value[i] * path->state.input_value[t->direct.dof[i]];
    return charge;
}

pzs_status pzs_charges_at(const pzs_solver *path, const pzs_electrodes *tables, pzs_real *charge)
{
    if (!path || !path->state.model || !tables || !charge || !path->state.tables->given.start)
        return PZS_E_ARGUMENT;
    for (uint32_t k = 0; k < tables->count; k++)
        charge[k] = charge_at(path, tables, k);
    return PZS_OK;
}

/* Force of a volt on open electrode a.  f [dof] out */
static void volt_force(const pzs_circuit *c, pzs_solver *path, uint32_t a, pzs_real *f)
{
    memset(f, 0, path->state.model->state.structure->free_dof * sizeof *f);
    pzs_nonlinear_unit_force(path, pzs_electrode_open_input(c->state.tables, a), f);
}

/* z = K^-1 z, where prescribed unknowns do not move. */
static void solve_free(pzs_solver *path, pzs_real *z)
{
    pzs_nonlinear_clear_prescribed(path, z);
    pzs_model_backsolve(path->state.model, z, z);
}

/* Charge per volt between open electrodes at path->u, factored; f, z [dof] work. Returns whether it
 * can be solved. */
static int factor_open(pzs_circuit *c, pzs_solver *path, pzs_real *f, pzs_real *z)
{
    const uint32_t dof = path->state.model->state.structure->free_dof;
    pzs_linalg_clear(&c->state.open);
    for (uint32_t a = 0; a < c->state.open.n; a++) {
        const uint32_t k = pzs_electrode_open(c->state.tables, a);
        volt_force(c, path, a, z);
        solve_free(path, z);
        for (uint32_t b = 0; b <= a; b++) {
            volt_force(c, path, b, f);
            *pzs_linalg_entry(&c->state.open, a, b) =
                pzs_linalg_inner(f, z, dof) +
                pzs_electrode_direct(c->state.tables, k,
                                     pzs_electrode_open_input(c->state.tables, b));
        }
    }
    const linalg_inertia inertia = pzs_linalg_factor(&c->state.open);
    /* Inertia is additive: a negative pivot of K that open electrodes stiffen away comes back here.
     */
    path->info.negative_pivots -= inertia.negative < path->info.negative_pivots
                                      ? inertia.negative
                                      : path->info.negative_pivots;
    return inertia.zero < 0;
}

static int condense(pzs_solver_option *option, pzs_solver *path, uint32_t input, pzs_real *du)
{
    pzs_circuit *c = circuit_of(option);
    const uint32_t dof = path->state.model->state.structure->free_dof;
    pzs_real *z = path->state.model->state.work + 2 * (size_t)dof, *f = z + dof;
    if (input == NEWTON && !factor_open(c, path, f, z))
        return 0;
    for (uint32_t a = 0; a < c->state.open.n; a++) {
        const uint32_t k = pzs_electrode_open(c->state.tables, a);
        volt_force(c, path, a, f);
        c->state.voltage_change[a] =
            input == NEWTON ? c->settings.charge[k] - charge_at(path, c->state.tables, k)
                            : (c->state.tables->input[k] == input) -
                                  pzs_electrode_direct(c->state.tables, k, input);
        c->state.voltage_change[a] -= pzs_linalg_inner(f, du, dof);
    }
    pzs_linalg_solve(&c->state.open, c->state.voltage_change);
    memset(z, 0, dof * sizeof *z);
    for (uint32_t a = 0; a < c->state.open.n; a++) {
        volt_force(c, path, a, f);
        for (uint32_t i = 0; i < dof; i++)
            z[i] += c->state.voltage_change[a] * f[i];
    }
    solve_free(path, z);
    for (uint32_t i = 0; i < dof; i++)
        du[i] += z[i];
    return 1;
}

/* The volts into the path's amounts and resultants. */
static void apply(const pzs_circuit *c, pzs_solver *path)
{
    for (uint32_t a = 0; a < c->state.open.n; a++)
        path->state.input_value[pzs_electrode_open_input(c->state.tables, a)] = c->state.voltage[a];
    pzs_nonlinear_set_given(path);
}

static int prepare(pzs_solver_option *option, pzs_solver *path)
{
    if (path->state.iteration == 0)
        apply(circuit_of(option), path);
    return 1;
}

static void solved(pzs_solver_option *option, pzs_solver *path, const pzs_real *du)
{
    pzs_circuit *c = circuit_of(option);
    (void)du;
    for (uint32_t a = 0; a < c->state.open.n; a++)
        c->state.voltage[a] += c->state.voltage_change[a];
    apply(c, path);
}

static int settled(pzs_solver_option *option, pzs_solver *path)
{
    const pzs_circuit *c = circuit_of(option);
    const pzs_real volt2 = pzs_linalg_inner(c->state.voltage, c->state.voltage, c->state.open.n);
    const pzs_real change2 =
        pzs_linalg_inner(c->state.voltage_change, c->state.voltage_change, c->state.open.n);
    return change2 <= path->settings.tolerance * path->settings.tolerance * volt2;
}

static void keep(pzs_solver_option *option, pzs_solver *path)
{
    const pzs_circuit *c = circuit_of(option);
    (void)path;
    memcpy(c->state.kept_voltage, c->state.voltage, c->state.open.n * sizeof *c->state.voltage);
}

static void restore(pzs_solver_option *option, pzs_solver *path)
{
    const pzs_circuit *c = circuit_of(option);
    memcpy(c->state.voltage, c->state.kept_voltage, c->state.open.n * sizeof *c->state.voltage);
    apply(c, path);
}

static void rest(pzs_solver_option *option, pzs_solver *path)
{
    const pzs_circuit *c = circuit_of(option);
    memset(c->state.kept_voltage, 0, c->state.open.n * sizeof *c->state.voltage);
    restore(option, path);
}

static const struct pzs_solver_option_calls calls = {
    .prepare = prepare,
    .solved = solved,
    .settled = settled,
    .unsettled = PZS_E_DIVERGED,
    .keep = keep,
    .restore = restore,
    .rest = rest,
    .condense = condense,
};

pzs_status pzs_attach_circuit(pzs_solver *path, pzs_circuit *c, const pzs_electrodes *tables,
                              void *work, size_t bytes)
{
    if (!path || !path->state.model || !c || !work || !path->state.tables->given.start)
        return PZS_E_ARGUMENT;
    const pzs_status status = pzs_electrode_check(tables, path->state.model->state.structure);
    if (status != PZS_OK)
        return status;
    const uint32_t open = pzs_electrode_open_count(tables);
    const int32_t lacking =
        guard_missing_bytes(work, bytes, PZS_CIRCUIT_BYTES(tables->count, open));
    if (lacking >= 0) {
        path->info.where = lacking;
        return PZS_E_WORKSPACE;
    }
    if (pzs_nonlinear_is_attached(path, &c->option))
        return PZS_E_ARGUMENT;
    memset(c, 0, sizeof *c);
    c->state.tables = tables;
    c->settings.charge = work;
    c->state.voltage = c->settings.charge + tables->count;
    c->state.kept_voltage = c->state.voltage + open;
    c->state.voltage_change = c->state.kept_voltage + open;
    memset(work, 0, sizeof *c->settings.charge * ((size_t)tables->count + 3 * (size_t)open));
    pzs_linalg_dense_layout(&c->state.open, open, c->state.voltage_change + open,
                            c->state.voltage_change + open + PZS_DENSE(open));
    pzs_nonlinear_attach(path, &c->option, &calls);
    return PZS_OK;
}

#endif
