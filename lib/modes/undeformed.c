/* SPDX-License-Identifier: BSD-2-Clause */
/* Modes of the undeformed structure (pzs_modes_find in pzs_modes.h). */
#include <string.h>
#include "../core/linalg.h"
#include "../model/compact.h"
#include "../model/model.h"
#include "../model/shell.h"
#include "element_mass.h"
#include "modes.h"

#if PZS_MODES

static pzs_status assemble_stiffness(pzs_modes *modes)
{
    pzs_model *model = modes->state.model;
    const pzs_status status =
        pzs_assemble(model, model->state.stiffness_factor, model->state.constrained);
    model->state.stage = STAGE_READY;
    return status;
}

/* ---- linear solves ------------------------------------------------------ */

/*
 * A multiple of the mass matrix as part of the matrix of a linear solve.
 *   term  first member, so that a pointer to it is one to the whole
 */
typedef struct mass_term {
    pzs_model_term term;
    const pzs_modes *modes;
} mass_term;

/* Add shift M times a vector to a force, both [free_dof]. */
static void add_term_product(const pzs_model_term *term, const pzs_real *vector, pzs_real *force)
{
    const pzs_modes *modes = ((const mass_term *)(const void *)term)->modes;
    pzs_mass_add_product(modes->state.mass, modes->state.model, modes->settings.shift, vector,
                         force);
}

/*
 * Whether linear solves are refined: where an unrefined one is less accurate than the modes are to
 * be, and the tables hold the element types.
 */
static bool is_refined(const pzs_modes *modes)
{
    return PZS_EPSILON * modes->info.condition > modes->settings.tolerance &&
           pzs_structure_has_types(modes->state.model->state.structure);
}

static pzs_status solve_force(pzs_modes *modes)
{
    pzs_model *model = modes->state.model;
    pzs_real *displacement = model->state.work + 5 * (size_t)model->state.stiffness.n;
    const mass_term shifted = {{add_term_product}, modes};
    if (!is_refined(modes)) {
        pzs_model_backsolve(model, model->state.work, displacement);
        return PZS_OK;
    }
    model->state.term = modes->settings.shift > 0 ? &shifted.term : NULL;
    const pzs_status status = pzs_model_solve_force(model, displacement);
    model->state.term = NULL;
    return status;
}

/* ---- results ------------------------------------------------------------ */

/* Twice the strain energy of the springs at a displacement [free_dof]. */
static pzs_real spring_energy(const pzs_structure *structure, const pzs_real *displacement)
{
    const pzs_rows *rows = &structure->spring;
    pzs_real sum = 0;
    for (uint32_t spring = 0; spring < rows->count; spring++) {
        pzs_real elongation = 0;
        for (uint32_t i = rows->start[spring]; i < rows->start[spring + 1]; i++)
            elongation += rows->value[i] * displacement[rows->dof[i]];
        sum += structure->spring_stiffness[spring] * elongation * elongation;
    }
    return sum;
}

/*
 * Squared angular frequency of a mode shape by its strain and electric energy, where the tables
 * hold the element types. Unlike x'K x, this sum of squares has almost no rounding errors for a
 * rigid motion.
 */
static pzs_real squared_frequency(const pzs_modes *modes, const pzs_real *shape, pzs_real ritz)
{
    const pzs_model *model = modes->state.model;
    const pzs_structure *structure = model->state.structure;
    if (!pzs_structure_has_types(structure))
        return ritz;
    pzs_real sum = spring_energy(structure, shape);
    if (modes->state.open_call)
        sum += modes->state.open_call->energy_open(modes, shape);
    for (uint32_t element = 0; element < structure->elements; element++) {
        pzs_real local[SHELL_MAX];
        pzs_model_gather(model, structure->element[element], SHELL_NODES, shape, local);
        sum += pzs_model_type_factor(model, element) *
               pzs_shell_energy(pzs_model_element_type(model, element), structure->dof_per_node,
                                local);
    }
    return sum;
}

static void add_input_force(const pzs_modes *modes, uint32_t input, pzs_real *force)
{
    pzs_model_add_input(modes->state.model, input, 1, force);
}

pzs_status pzs_modes_find(pzs_modes *modes)
{
    static const struct pzs_modes_calls calls = {
        assemble_stiffness, solve_force, squared_frequency, add_input_force, false, NULL, NULL};
    if (!modes)
        return PZS_E_ARGUMENT;
    if (modes->state.stage < MODES_READY)
        return PZS_E_STAGE;
    return pzs_modes_run(modes, &calls, STAGE_FACTORED);
}

#endif
