/*
 * Influence at a shape (pzs.h): by the factored tangent there, and where follower loads leave it
 * unsymmetric, by generalised conjugate gradients on it.
 */
#include "nonlinear.h"
#include "../core/guard.h"
#include "../core/linalg.h"
#include "../model/model.h"
#include <string.h>

#if PZS_NONLINEAR

enum { TURN_PASSES = 60 }; /* of the skew part of a tangent, a column of influence */

static pzs_status fail(pzs_solver *solver, pzs_status status, int32_t where)
{
    solver->info.where = where;
    return status;
}

/* Force per unit of the input that moves the prescribed unknowns, onto force [dof], 0 before: the
 * tangent is built anew for it. */
static void unit_move(pzs_solver *solver, pzs_real *force)
{
    const pzs_prescribed_motion *p = &solver->state.tables->prescribed;
    pzs_nonlinear_build(solver, 1,
                        solver->state.model->state.work +
                            solver->state.model->state.structure->free_dof);
    for (uint32_t i = 0; i < p->count; i++)
        pzs_nonlinear_prescribe(&solver->state.model->state.stiffness, p->dof[i], p->value[i],
                                force);
    pzs_nonlinear_factor(solver);
    solver->state.model->state.stage = STAGE_AT_SHAPE;
}

/* Add the outputs of u [dof] to an input's column of an influence. */
static void add_outputs(const pzs_structure *structure, const pzs_real *u, uint32_t input,
                        pzs_real *influence)
{
    for (uint32_t i = 0; i < structure->output.count; i++)
        influence[(size_t)i * structure->input.count + input] +=
            pzs_model_observe_row(structure, u, i);
}

/* Does an option leave a skew part out of the tangent? */
static int is_skew(const pzs_solver *solver)
{
    int found = 0;
    for (const pzs_solver_option *option = solver->state.option; option && !found;
         option = option->next)
        found = option->call->skew != NULL;
    return found;
}

/* y [dof] += factor W x, where K - W is the true tangent, W skew; nothing on prescribed unknowns.
 */
static void add_skew(pzs_solver *solver, const pzs_real *x, pzs_real factor, pzs_real *y)
{
    for (pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->skew)
            option->call->skew(option, solver, x, factor, y);
    pzs_nonlinear_clear_prescribed(solver, y);
}

/*
 * What W adds to an input's column of influence. d [dof] in: K's own answer; lost. Generalised
 * conjugate gradients of Concus, Golub and Widlund from there: with r the force left, z = K^-1 r
 * and d the change of the answer, omega = 1 / (1 + z'r / (z'r omega) of the pass before),  d =
 * omega z + (omega - 1) d, r of the next pass = (1 - omega) r of the pass before + omega W z. Where
 * K has no negative pivot they converge whatever the size of W.
 */
static pzs_status turn_column(pzs_solver *solver, uint32_t input, pzs_real *d, pzs_real *influence)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    const uint32_t n = structure->free_dof;
    const pzs_real whole2 = pzs_nonlinear_norm2(solver, d, NULL), rounding = 16 * PZS_EPSILON;
    pzs_real *r = solver->state.model->state.work + n,
             *before = solver->state.model->state.work + 4 * (size_t)n, *z = before + n;
    pzs_real omega = 1, last = 0, change2 = whole2;
    memset(r, 0, n * sizeof *r);
    memset(before, 0, n * sizeof *before);
    add_skew(solver, d, 1, r);
    for (uint32_t pass = 0; pass < TURN_PASSES && change2 > rounding * rounding * whole2; pass++) {
        pzs_real *const next = before;
        pzs_model_backsolve(solver->state.model, r, z);
        if (!pzs_nonlinear_condense(solver, NO_INPUT, z))
            return PZS_E_NONFINITE;
        const pzs_real energy = pzs_linalg_inner(z, r, n);
        omega = pass == 0 ? 1 : 1 / (1 + energy / (last * omega));
        for (uint32_t i = 0; i < n; i++) {
            d[i] = omega * z[i] + (omega - 1) * d[i];
            next[i] *= 1 - omega;
        }
        add_skew(solver, z, omega, next);
        add_outputs(structure, d, input, influence);
        change2 = pzs_nonlinear_norm2(solver, d, NULL);
        before = r;
        r = next;
        last = energy;
    }
    return change2 <= PZS_EPSILON * whole2 ? PZS_OK : PZS_E_RESIDUAL;
}

pzs_status pzs_influence_at(pzs_solver *solver, pzs_real *influence)
{
    if (!solver || !influence)
        return PZS_E_ARGUMENT;
    if (solver->state.stage != PATH_SETTLED || solver->state.model->state.stage != STAGE_AT_SHAPE)
        return fail(solver, PZS_E_STAGE, -1);
    const pzs_structure *structure = solver->state.model->state.structure;
    const pzs_prescribed_motion *p = &solver->state.tables->prescribed;
    pzs_real *u = solver->state.model->state.work;
    for (uint32_t j = 0; j < structure->input.count; j++) {
        memset(u, 0, structure->free_dof * sizeof *u);
        pzs_nonlinear_unit_force(solver, j, u);
        pzs_nonlinear_clear_prescribed(solver, u);
        if (p->count > 0 && j == p->input)
            unit_move(solver, u);
        pzs_model_backsolve(solver->state.model, u, u);
        if (!pzs_nonlinear_condense(solver, j, u) ||
            pzs_guard_nonfinite(u, structure->free_dof) >= 0)
            return fail(solver, PZS_E_NONFINITE, (int32_t)j);
        for (uint32_t i = 0; i < structure->output.count; i++)
            influence[(size_t)i * structure->input.count + j] = 0;
        add_outputs(structure, u, j, influence);
        const pzs_status status = is_skew(solver) ? turn_column(solver, j, u, influence) : PZS_OK;
        if (status != PZS_OK)
            return fail(solver, status, (int32_t)j);
    }
    return fail(solver, PZS_OK, -1);
}

#endif
