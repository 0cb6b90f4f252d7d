/* SPDX-License-Identifier: BSD-2-Clause */
/* Springs of a structure: checks, stiffness and forces (spring.h). */
#include "spring.h"
#include "../core/guard.h"
#include "../core/linalg.h"

/*
 * Whether the product of the entries `own` and `other` of a spring lies inside the envelope (stored
 * entries) of the stiffness matrix, in the row of entry `own` and the column of entry `other`. The
 * caller also asks for exchanged row and column, because the lower triangle stores only one of both
 * places.
 */
static bool in_envelope(const pzs_structure *structure, uint32_t own, uint32_t other)
{
    const uint16_t row = structure->spring.dof[own];
    return structure->spring.dof[other] >= structure->first_column[row];
}

bool pzs_springs_in_range(const pzs_structure *structure)
{
    const pzs_rows *rows = &structure->spring;
    if (rows->count > 0 && pzs_guard_nonfinite(structure->spring_stiffness, rows->count) >= 0)
        return false;
    for (uint32_t spring = 0; spring < rows->count; spring++) {
        if (structure->spring_stiffness[spring] < 0)
            return false;
        for (uint32_t i = rows->start[spring]; i < rows->start[spring + 1]; i++)
            for (uint32_t j = rows->start[spring]; j < rows->start[spring + 1]; j++)
                if (!in_envelope(structure, i, j))
                    return false;
    }
    return true;
}

/*
 * Return the factor of one degree of freedom in the elongation of a spring, or 0 at a constrained
 * degree of freedom.
 *   entry  in  index of the factor among the entries of the sparse rows of the springs
 */
static pzs_real weight(const pzs_model *model, uint32_t entry)
{
    const pzs_rows *rows = &model->state.structure->spring;
    const uint8_t *constrained = model->state.constrained;
    return constrained && constrained[rows->dof[entry]] ? 0 : rows->value[entry];
}

static void add_spring(pzs_model *model, uint32_t spring)
{
    const pzs_rows *rows = &model->state.structure->spring;
    const pzs_real stiffness = model->state.structure->spring_stiffness[spring];
    for (uint32_t i = rows->start[spring]; i < rows->start[spring + 1]; i++)
        for (uint32_t j = rows->start[spring]; j < rows->start[spring + 1]; j++)
            if (rows->dof[j] <= rows->dof[i])
                *pzs_linalg_entry(&model->state.stiffness, rows->dof[i], rows->dof[j]) +=
                    stiffness * weight(model, i) * weight(model, j);
}

void pzs_model_add_springs(pzs_model *model)
{
    for (uint32_t spring = 0; spring < model->state.structure->spring.count; spring++)
        add_spring(model, spring);
}

void pzs_model_add_spring_force(const pzs_model *model, pzs_real factor,
                                const pzs_real *displacement, pzs_real *sum)
{
    const pzs_rows *rows = &model->state.structure->spring;
    for (uint32_t spring = 0; spring < rows->count; spring++) {
        pzs_real elongation = 0;
        for (uint32_t i = rows->start[spring]; i < rows->start[spring + 1]; i++)
            elongation += weight(model, i) * displacement[rows->dof[i]];
        const pzs_real force =
            factor * model->state.structure->spring_stiffness[spring] * elongation;
        for (uint32_t i = rows->start[spring]; i < rows->start[spring + 1]; i++)
            sum[rows->dof[i]] += weight(model, i) * force;
    }
}
