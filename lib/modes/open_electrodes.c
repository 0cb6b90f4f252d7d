/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Open electrodes in the search for modes (pzs_modes_open_electrodes in pzs_modes.h). In the
 * comments A is the matrix K + shift M at prescribed voltages; S and the other letters are those of
 * open_matrix.h.
 */
#include <string.h>
#include "../core/guard.h"
#include "../model/electrode.h"
#include "../model/model.h"
#include "modes.h"
#include "open_matrix.h"

#if PZS_MODES

static uint32_t free_dof(const pzs_modes *modes)
{
    return modes->state.model->state.structure->free_dof;
}

/* Compute the force [free_dof] per volt on open electrode number i. */
static void unit_force(const pzs_modes *modes, uint32_t i, pzs_real *force)
{
    memset(force, 0, free_dof(modes) * sizeof *force);
    modes->state.call->add_input_force(modes, pzs_open_matrix_input(&modes->state.open, i), force);
}

/*
 * Work of the force per volt on open electrode number i on a displacement [free_dof].
 *   force [free_dof] out  work array
 */
static pzs_real unit_work(const pzs_modes *modes, uint32_t i, const pzs_real *displacement,
                          pzs_real *force)
{
    unit_force(modes, i, force);
    return pzs_linalg_inner(force, displacement, free_dof(modes));
}

/* Compute the works of the forces per volt on all open electrodes on a displacement [free_dof]. */
static void take_works(const pzs_modes *modes, const pzs_real *displacement)
{
    for (uint32_t i = 0; i < modes->state.open.count; i++)
        modes->state.open.work[i] =
            unit_work(modes, i, displacement, modes->state.model->state.work);
}

/* ---- linear solves ------------------------------------------------------ */

/*
 * Solve A u = f as pzs_modes_calls.solve_force.
 *   is_refined in  false: A may be indefinite, as in a count of the modes, which forbids refinement
 */
static pzs_status solve_short(pzs_modes *modes, bool is_refined)
{
    pzs_model *model = modes->state.model;
    if (is_refined)
        return modes->state.call->solve_force(modes);
    pzs_model_backsolve(model, model->state.work, model->state.work + 5 * (size_t)free_dof(modes));
    return PZS_OK;
}

/*
 * Compute and factor S by the factors of A in the model.
 *   is_refined in      as in solve_short
 *   inertia    in/out  as in pzs_open_matrix_factor
 */
static pzs_status factor(pzs_modes *modes, pzs_envelope *matrix, bool is_refined,
                         linalg_inertia *inertia)
{
    const pzs_modes_electrodes *open = &modes->state.open;
    pzs_real *force = modes->state.model->state.work,
             *response = force + 5 * (size_t)free_dof(modes);
    pzs_linalg_clear(matrix);
    for (uint32_t i = 0; i < open->count; i++) {
        unit_force(modes, i, force);
        const pzs_status status = solve_short(modes, is_refined);
        if (status != PZS_OK)
            return status;
        for (uint32_t j = 0; j <= i; j++)
            pzs_open_matrix_set(open, matrix, i, j, unit_work(modes, j, response, force));
    }
    pzs_open_matrix_factor(matrix, inertia);
    return PZS_OK;
}

static pzs_status prepare_open(pzs_modes *modes, linalg_inertia *inertia)
{
    modes->info.linear_solves += modes->state.open.count;
    return factor(modes, &modes->state.open.moving, true, inertia);
}

static void count_open(pzs_modes *modes, linalg_inertia *inertia)
{
    (void)factor(modes, &modes->state.open.held, false, inertia);
}

/* Subtract the forces of the voltages of the open electrodes from a force [free_dof]. */
static void subtract_forces(const pzs_modes *modes, pzs_real *force)
{
    const pzs_modes_electrodes *open = &modes->state.open;
    const uint32_t n = free_dof(modes);
    pzs_real *unit = modes->state.model->state.work + n;
    for (uint32_t i = 0; i < open->count; i++) {
        unit_force(modes, i, unit);
        for (uint32_t k = 0; k < n; k++)
            force[k] -= open->voltage[i] * unit[k];
    }
}

static pzs_status solve_open(pzs_modes *modes)
{
    const pzs_modes_electrodes *open = &modes->state.open;
    const size_t n = free_dof(modes);
    pzs_real *force = modes->state.model->state.work;
    memcpy(modes->state.force, force, n * sizeof *force);
    pzs_status status = modes->state.call->solve_force(modes);
    if (status != PZS_OK)
        return status;
    take_works(modes, force + 5 * n);
    memcpy(open->voltage, open->work, open->count * sizeof *open->voltage);
    pzs_linalg_solve(&open->moving, open->voltage);
    memcpy(force, modes->state.force, n * sizeof *force);
    subtract_forces(modes, force);
    modes->info.linear_solves++;
    return modes->state.call->solve_force(modes);
}

/* ---- results ------------------------------------------------------------ */

static pzs_status hold_open(pzs_modes *modes)
{
    return pzs_open_matrix_hold(&modes->state.open, &modes->info.where);
}

static pzs_real energy_open(const pzs_modes *modes, const pzs_real *displacement)
{
    take_works(modes, displacement);
    return pzs_open_matrix_follow(&modes->state.open);
}

static void respond_open(const pzs_modes *modes, pzs_real *response)
{
    pzs_open_matrix_respond(&modes->state.open, response);
}

/* ---- preparation -------------------------------------------------------- */

static const struct pzs_modes_open_calls calls = {prepare_open, count_open,  solve_open,
                                                  hold_open,    energy_open, respond_open};

/*
 * Open electrodes in memory that suffices, and check their capacitances.
 *   reals [free_dof]  in  memory of state.force, followed by that of the matrices
 */
static pzs_status open_in(pzs_modes *modes, const pzs_electrodes *tables, const uint8_t *is_open,
                          pzs_real *reals)
{
    modes->state.open_call = NULL;
    modes->state.force = reals;
    pzs_open_matrix_begin(&modes->state.open, tables, is_open, reals + free_dof(modes));
    const pzs_status status = hold_open(modes);
    if (status == PZS_OK)
        modes->state.open_call = &calls;
    return status;
}

pzs_status pzs_modes_open_electrodes(pzs_modes *modes, const pzs_electrodes *tables,
                                     const uint8_t *is_open, void *work, size_t bytes)
{
    if (!modes || !tables)
        return PZS_E_ARGUMENT;
    if (modes->state.stage < MODES_READY)
        return PZS_E_STAGE;
    modes->info.where = -1;
    pzs_status status = pzs_electrode_check(tables, modes->state.model->state.structure);
    if (status != PZS_OK)
        return status;
    const uint16_t open = pzs_open_matrix_count(tables, is_open);
    if (open > 0 && !work)
        return PZS_E_ARGUMENT;
    modes->info.where =
        open > 0 ? guard_missing_bytes(work, bytes, PZS_MODES_OPEN_BYTES(free_dof(modes), open))
                 : -1;
    if (modes->info.where >= 0)
        return PZS_E_WORKSPACE;
    modes->state.stage = MODES_READY;
    modes->state.open_call = NULL;
    modes->settings.solve_limit = pzs_modes_solve_limit(modes->info.number);
    if (open == 0)
        return PZS_OK;
    modes->settings.solve_limit = 2u * modes->settings.solve_limit + open;
    return open_in(modes, tables, is_open, work);
}

#endif
