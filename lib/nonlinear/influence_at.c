/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Influence matrix at a deformed shape (pzs_nonlinear.h), from the factors of the tangent matrix.
 * Where follower loads make the exact tangent unsymmetric, each column is corrected by generalised
 * conjugate gradients that are preconditioned by the factors of the symmetric part.
 */
#include "nonlinear.h"
#include "../core/guard.h"
#include "../core/linalg.h"
#include "../model/model.h"
#include <string.h>

#if PZS_NONLINEAR

enum {
    SKEW_ITERATIONS = 60
}; /* Largest number of iterations that correct one column of the influence matrix for the
      skew-symmetric part of the tangent matrix. */

static pzs_status fail(pzs_solver *solver, pzs_status status, int32_t where)
{
    solver->info.where = where;
    return status;
}

/*
 * Compute the force that has the same effect as the prescribed motion of some degrees of freedom,
 * per unit of the input that prescribes the motion.
 *   force [free_dof] in/out  in: zero; out: force (N and N m)
 */
static void prescribed_motion_force(pzs_solver *solver, pzs_real *force)
{
    const pzs_prescribed_motion *motion = &solver->state.tables->prescribed;
    // The tangent matrix is assembled anew, because the rows and columns of degrees of freedom with
    // a prescribed motion become zero apart from the diagonal. Its new factors stay in the model.
    pzs_nonlinear_build(solver, true,
                        solver->state.model->state.work +
                            solver->state.model->state.structure->free_dof);
    for (uint32_t i = 0; i < motion->count; i++)
        pzs_nonlinear_prescribe(&solver->state.model->state.stiffness, motion->dof[i],
                                motion->value[i], force);
    pzs_nonlinear_factor(solver);
    solver->state.model->state.stage = STAGE_AT_SHAPE;
}

/*
 * Add the outputs that a displacement [free_dof] causes to the column of one input in the influence
 * matrix.
 */
static void add_outputs(const pzs_structure *structure, const pzs_real *displacement,
                        uint32_t input, pzs_real *influence)
{
    for (uint32_t i = 0; i < structure->output.count; i++)
        influence[(size_t)i * structure->input.count + input] +=
            pzs_model_observe_row(structure, displacement, i);
}

/*
 * Whether an option of the equilibrium solver, such as a follower load, has forces with a
 * skew-symmetric derivative, which the tangent matrix omits.
 */
static bool has_skew_part(const pzs_solver *solver)
{
    bool found = false;
    for (const pzs_solver_option *option = solver->state.option; option && !found;
         option = option->next)
        found = option->call->add_skew != NULL;
    return found;
}

/*
 * Add the product W x, times a factor, to y, both [free_dof]. W is the skew-symmetric part of the
 * derivative of all forces, which the factored tangent K leaves out: K - W is the exact tangent.
 * The product is zero at the degrees of freedom whose motion is prescribed.
 */
static void add_skew(pzs_solver *solver, const pzs_real *x, pzs_real factor, pzs_real *y)
{
    for (pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->add_skew)
            option->call->add_skew(option, solver, x, factor, y);
    pzs_nonlinear_clear_prescribed(solver, y);
}

/*
 * Correct the column of one input in the influence matrix for the skew-symmetric part W of the
 * tangent, by the generalised conjugate gradients of Concus, Golub and Widlund. They converge for
 * every W if the symmetric tangent K has no negative pivot. An iteration is
 *   z = K^-1 r,  e = z'r
 *   omega = 1 / (1 + e / (e_before omega_before)), 1 in the first iteration
 *   d = omega z + (omega - 1) d_before
 *   r_next = (1 - omega) r_before + omega W z
 *   r, d    residual force, step of the displacement
 *   before  suffix: of the iteration before
 *   d         [free_dof]        in/out  in: displacement per unit of the input, from K alone; out:
 *                                       overwritten
 *   influence [outputs][inputs] in/out  influence matrix; the outputs under each d are added
 */
static pzs_status correct_column(pzs_solver *solver, uint32_t input, pzs_real *d,
                                 pzs_real *influence)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    const uint32_t n = structure->free_dof;
    const pzs_real size2 = pzs_nonlinear_norm2(solver, d, NULL), rounding = 16 * PZS_EPSILON;
    pzs_real *r = solver->state.model->state.work + n,
             *residual_before = solver->state.model->state.work + 4 * (size_t)n,
             *z = residual_before + n;
    pzs_real omega = 1, energy_before = 0, correction2 = size2;
    memset(r, 0, n * sizeof *r);
    memset(residual_before, 0, n * sizeof *residual_before);
    add_skew(solver, d, 1, r);
    for (uint32_t iteration = 0;
         iteration < SKEW_ITERATIONS && correction2 > rounding * rounding * size2; iteration++) {
        pzs_real *const next = residual_before;
        pzs_model_backsolve(solver->state.model, r, z);
        if (!pzs_nonlinear_condense(solver, NO_INPUT, z))
            return PZS_E_NONFINITE;
        const pzs_real energy = pzs_linalg_inner(z, r, n);
        omega = iteration == 0 ? 1 : 1 / (1 + energy / (energy_before * omega));
        for (uint32_t i = 0; i < n; i++) {
            d[i] = omega * z[i] + (omega - 1) * d[i];
            next[i] *= 1 - omega;
        }
        add_skew(solver, z, omega, next);
        add_outputs(structure, d, input, influence);
        correction2 = pzs_nonlinear_norm2(solver, d, NULL);
        residual_before = r;
        r = next;
        energy_before = energy;
    }
    return correction2 <= PZS_EPSILON * size2 ? PZS_OK : PZS_E_RESIDUAL;
}

pzs_status pzs_influence_at(pzs_solver *solver, pzs_real *influence)
{
    if (!solver || !influence)
        return PZS_E_ARGUMENT;
    if (solver->state.stage != SOLVER_CONVERGED ||
        solver->state.model->state.stage != STAGE_AT_SHAPE)
        return fail(solver, PZS_E_STAGE, -1);
    const pzs_structure *structure = solver->state.model->state.structure;
    const pzs_prescribed_motion *motion = &solver->state.tables->prescribed;
    pzs_real *displacement = solver->state.model->state.work;
    for (uint32_t j = 0; j < structure->input.count; j++) {
        memset(displacement, 0, structure->free_dof * sizeof *displacement);
        pzs_nonlinear_unit_force(solver, j, displacement);
        pzs_nonlinear_clear_prescribed(solver, displacement);
        if (motion->count > 0 && j == motion->input)
            prescribed_motion_force(solver, displacement);
        pzs_model_backsolve(solver->state.model, displacement, displacement);
        if (!pzs_nonlinear_condense(solver, j, displacement) ||
            pzs_guard_nonfinite(displacement, structure->free_dof) >= 0)
            return fail(solver, PZS_E_NONFINITE, (int32_t)j);
        for (uint32_t i = 0; i < structure->output.count; i++)
            influence[(size_t)i * structure->input.count + j] = 0;
        add_outputs(structure, displacement, j, influence);
        const pzs_status status =
            has_skew_part(solver) ? correct_column(solver, j, displacement, influence) : PZS_OK;
        if (status != PZS_OK)
            return fail(solver, status, (int32_t)j);
    }
    return fail(solver, PZS_OK, -1);
}

#endif
