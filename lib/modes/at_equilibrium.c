/* SPDX-License-Identifier: BSD-2-Clause */
/* Modes about the equilibrium of the nonlinear solver (pzs_modes_find_at in pzs_modes.h). */
#include "modes.h"

#if PZS_MODES && PZS_NONLINEAR

#include "../model/model.h"
#include "../nonlinear/nonlinear.h"

/* Assemble the tangent stiffness at the equilibrium, whose prestress it contains. */
static pzs_status assemble_stiffness(pzs_modes *modes)
{
    pzs_nonlinear_build(modes->state.solver, true, modes->state.model->state.work);
    return PZS_OK;
}

/*
 * Set rows and columns of dof with prescribed displacements to zero, apart from positive diagonal
 * entries.
 */
static void fix_matrix(pzs_modes *modes)
{
    const pzs_prescribed_motion *motion = &modes->state.solver->state.tables->prescribed;
    pzs_model *model = modes->state.model;
    for (uint32_t i = 0; i < motion->count; i++)
        pzs_nonlinear_prescribe(&model->state.stiffness, motion->dof[i], 0, model->state.work);
}

static void fix_product(const pzs_modes *modes, pzs_real *product)
{
    pzs_nonlinear_clear_prescribed(modes->state.solver, product);
}

static pzs_status solve_force(pzs_modes *modes)
{
    pzs_model *model = modes->state.model;
    pzs_model_backsolve(model, model->state.work,
                        model->state.work + 5 * (size_t)model->state.stiffness.n);
    return PZS_OK;
}

static pzs_real squared_frequency(const pzs_modes *modes, const pzs_real *shape, pzs_real ritz)
{
    (void)modes;
    (void)shape;
    return ritz;
}

static void add_input_force(const pzs_modes *modes, uint32_t input, pzs_real *force)
{
    pzs_nonlinear_unit_force(modes->state.solver, input, force);
    pzs_nonlinear_clear_prescribed(modes->state.solver, force);
}

pzs_status pzs_modes_find_at(pzs_modes *modes, pzs_solver *solver)
{
    static const struct pzs_modes_calls calls = {assemble_stiffness, solve_force, squared_frequency,
                                                 add_input_force,    true,        fix_matrix,
                                                 fix_product};
    if (!modes || !solver)
        return PZS_E_ARGUMENT;
    if (modes->state.stage < MODES_READY || solver->state.stage != SOLVER_CONVERGED)
        return PZS_E_STAGE;
    if (solver->state.model != modes->state.model)
        return PZS_E_ARGUMENT;
    modes->state.solver = solver;
    return pzs_modes_run(modes, &calls, STAGE_AT_SHAPE);
}

#endif
