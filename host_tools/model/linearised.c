/* SPDX-License-Identifier: BSD-2-Clause */
/* Tangent stiffness matrix and forces of the inputs at a nonlinear equilibrium (linearised.h). */
#include "linearised.h"
#include <stdlib.h>
#include <string.h>
#include "../../lib/core/linalg.h"
#include "../../lib/nonlinear/nonlinear.h"

/*
 * Compute the tangent stiffness matrix at the equilibrium that the solver has reached, and copy it.
 * The matrix overwrites the stiffness matrix in the solver's memory.
 *   imbalance [free_dof] out  work array
 */
static void copy_tangent(linearised *linearised, pzs_solver *solver, double *imbalance)
{
    pzs_envelope *stiffness = &solver->state.model->state.stiffness;
    const pzs_prescribed_motion *held = &solver->state.tables->prescribed;
    pzs_nonlinear_build(solver, true, imbalance);
    for (uint32_t i = 0; i < held->count; i++)
        pzs_nonlinear_prescribe(stiffness, held->dof[i], 0, imbalance);
    memcpy(linearised->tangent, stiffness->value, linearised->entries * sizeof(double));
}

bool linearised_take(linearised *linearised, const design *design, pzs_solver *solver)
{
    const pzs_envelope *stiffness = &solver->state.model->state.stiffness;
    const size_t dof = (size_t)design->mesh.free_dof, inputs = design->structure.input.count;
    double *imbalance = calloc(dof + 1, sizeof *imbalance);
    linearised->entries = stiffness->start[PZS_CEIL(stiffness->n) / PZS_TILE];
    linearised->tangent = malloc(linearised->entries * sizeof *linearised->tangent);
    linearised->force = calloc(inputs * dof + 1, sizeof *linearised->force);
    const bool is_taken = imbalance && linearised->tangent && linearised->force;
    if (is_taken)
        copy_tangent(linearised, solver, imbalance);
    for (size_t k = 0; is_taken && k < inputs; k++) {
        pzs_nonlinear_unit_force(solver, (uint32_t)k, linearised->force + k * dof);
        pzs_nonlinear_clear_prescribed(solver, linearised->force + k * dof);
    }
    free(imbalance);
    return is_taken;
}

void linearised_free(linearised *linearised)
{
    free(linearised->tangent);
    free(linearised->force);
    memset(linearised, 0, sizeof *linearised);
}

void linearised_force(const linearised *about, const design *design, uint32_t input, double *force)
{
    const size_t free_dof = design->structure.free_dof;
    const pzs_rows *in = &design->structure.input;
    const mesh *mesh = &design->mesh;
    if (about) {
        memcpy(force, about->force + input * free_dof, free_dof * sizeof *force);
        return;
    }
    memset(force, 0, free_dof * sizeof *force);
    for (uint32_t entry = in->start[input]; entry < in->start[input + 1]; entry++)
        force[in->dof[entry]] += in->value[entry];
    for (int i = 0; i < mesh->prescribed_count; i++)
        force[mesh->prescribed_dof[i]] = 0;
}

double linearised_work(const linearised *about, const design *design, uint32_t input,
                       const double *displacement)
{
    const size_t free_dof = design->structure.free_dof;
    const pzs_rows *in = &design->structure.input;
    double sum = 0;
    if (about)
        return pzs_linalg_inner(about->force + input * free_dof, displacement, (uint32_t)free_dof);
    for (uint32_t entry = in->start[input]; entry < in->start[input + 1]; entry++)
        sum += in->value[entry] * displacement[in->dof[entry]];
    return sum;
}
