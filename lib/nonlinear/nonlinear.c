/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Equilibrium of the shell at large rotation, by Newton's method with independent stress resultants
 * and load steps (pzs_nonlinear.h).
 */
#include "nonlinear.h"
#include "../core/guard.h"
#include "../core/linalg.h"
#include "../model/compact.h"
#include "../model/model.h"
#include "../model/shell.h"
#include "../model/spring.h"
#include <string.h>

#if PZS_NONLINEAR

enum {
    STEP_SOLVES = 40,
    STEP_HALVINGS = 6
}; /* STEP_SOLVES: largest number of linear solves of Newton's method in a load step. STEP_HALVINGS:
      largest number of times that the first load step is halved. */

static pzs_status fail(pzs_solver *solver, pzs_status status, int32_t where)
{
    solver->info.where = where;
    return status;
}

/* ---- init ------------------------------------------------------------- */

/*
 * Whether the numbers of entries in the tables of the equilibrium solver are possible for this
 * structure. Otherwise a damaged number could lead the checksum or the check of indices beyond the
 * tables.
 */
static bool counts_fit(const pzs_nonlinear *tables, const pzs_structure *structure)
{
    const uint32_t inputs = structure->input.count,
                   entries = tables->resultants.start ? tables->resultants.start[inputs] : 0;
    return entries <= inputs * structure->elements && tables->resultants.values <= entries &&
           tables->prescribed.count <= structure->free_dof;
}

uint32_t pzs_nonlinear_crc(const pzs_nonlinear *tables, const pzs_structure *structure)
{
    const uint32_t inputs = structure->input.count,
                   entries = tables->resultants.start ? tables->resultants.start[inputs] : 0;
    uint32_t crc = GUARD_CRC_START;
    if (!counts_fit(tables, structure))
        return crc;
    if (entries > 0) {
        crc = pzs_guard_crc(crc, tables->resultants.start,
                            (inputs + 1) * sizeof *tables->resultants.start);
        crc = pzs_guard_crc(crc, tables->resultants.element,
                            entries * sizeof *tables->resultants.element);
        crc = pzs_guard_crc(crc, tables->resultants.which,
                            entries * sizeof *tables->resultants.which);
        crc = pzs_guard_crc(crc, tables->resultants.value,
                            tables->resultants.values * sizeof *tables->resultants.value);
    }
    if (tables->prescribed.count > 0) {
        crc = pzs_guard_crc(crc, &tables->prescribed.input, sizeof tables->prescribed.input);
        crc = pzs_guard_crc(crc, tables->prescribed.dof,
                            tables->prescribed.count * sizeof *tables->prescribed.dof);
        crc = pzs_guard_crc(crc, tables->prescribed.value,
                            tables->prescribed.count * sizeof *tables->prescribed.value);
    }
    return ~crc;
}

pzs_status pzs_nonlinear_seal(pzs_nonlinear *tables, const pzs_structure *structure)
{
    if (!tables || !structure || !counts_fit(tables, structure))
        return PZS_E_ARGUMENT;
    tables->format = PZS_TABLE_FORMAT;
    tables->scene = structure->scene;
    tables->crc = pzs_nonlinear_crc(tables, structure);
    return PZS_OK;
}

static bool tables_in_range(const pzs_nonlinear *tables, const pzs_structure *structure)
{
    const uint32_t inputs = structure->input.count,
                   entries = tables->resultants.start ? tables->resultants.start[inputs] : 0;
    for (uint32_t j = 0; entries > 0 && j < inputs; j++)
        if (tables->resultants.start[j] > tables->resultants.start[j + 1])
            return false;
    for (uint32_t i = 0; i < entries; i++)
        if (tables->resultants.element[i] >= structure->elements ||
            tables->resultants.which[i] >= tables->resultants.values)
            return false;
    for (uint32_t i = 0; i < tables->prescribed.count; i++)
        if (tables->prescribed.dof[i] >= structure->free_dof)
            return false;
    return tables->prescribed.count == 0 || tables->prescribed.input < inputs;
}

/*
 * Find the powers of two that scale the undeformed stiffness matrix to unit diagonal. The solver
 * scales all tangent matrices by them. Returns the first free degree of freedom without stiffness,
 * or -1.
 */
static int32_t find_undeformed_scale(pzs_model *model)
{
    if (pzs_assemble(model, model->state.stiffness_factor, model->state.constrained) != PZS_OK)
        return 0;
    model->state.stage = STAGE_READY;
    return pzs_linalg_scale(&model->state.stiffness, model->state.scale);
}

pzs_status pzs_solver_init(pzs_solver *solver, pzs_model *model, const pzs_nonlinear *tables,
                           void *work, size_t bytes)
{
    if (!solver || !model || !tables || !work || model->state.stage < STAGE_READY ||
        !pzs_structure_has_types(model->state.structure))
        return PZS_E_ARGUMENT;
    const pzs_structure *structure = model->state.structure;
    memset(solver, 0, sizeof *solver);
    solver->info.where = -1;
    if (tables->format != PZS_TABLE_FORMAT || tables->scene != structure->scene)
        return PZS_E_FORMAT;
    if (!counts_fit(tables, structure) || pzs_nonlinear_crc(tables, structure) != tables->crc)
        return PZS_E_CRC;
    if (!tables_in_range(tables, structure))
        return PZS_E_ARGUMENT;
    const int32_t missing = guard_missing_bytes(
        work, bytes,
        PZS_SOLVER_BYTES(structure->free_dof, structure->elements, structure->input.count));
    if (missing >= 0)
        return fail(solver, PZS_E_WORKSPACE, missing);
    const int32_t unsupported = find_undeformed_scale(model);
    if (unsupported >= 0)
        return fail(solver, PZS_E_LOOSE, unsupported);

    pzs_real *real = work;
    solver->state.model = model;
    solver->state.tables = tables;
    solver->state.displacement = real;
    solver->state.converged_displacement = solver->state.displacement + structure->free_dof;
    solver->state.load = solver->state.converged_displacement + structure->free_dof;
    solver->state.input_value = solver->state.load + structure->free_dof;
    solver->state.converged_input_value = solver->state.input_value + structure->input.count;
    solver->state.resultant = (pzs_real(*)[SHELL_RESULTANTS])(solver->state.converged_input_value +
                                                              structure->input.count);
    solver->state.converged_resultant = solver->state.resultant + structure->elements;
    solver->state.prescribed =
        (pzs_real(*)[SHELL_STRAINS])(solver->state.converged_resultant + structure->elements);
    solver->info.displacement = solver->state.displacement;
    solver->info.input_value = solver->state.input_value;
    solver->settings.tolerance = (pzs_real)1e-4;
    solver->settings.load_steps = 1;
    solver->settings.extrapolated_iterations = 12;
    solver->settings.ramp_solves = 1;
    solver->settings.solve_limit = 400;
    pzs_solver_reset(solver);
    return PZS_OK;
}

void pzs_solver_reset(pzs_solver *solver)
{
    if (!solver || !solver->state.model)
        return;
    const pzs_structure *structure = solver->state.model->state.structure;
    memset(solver->state.converged_displacement, 0,
           structure->free_dof * sizeof *solver->state.displacement);
    memset(solver->state.converged_input_value, 0,
           structure->input.count * sizeof *solver->state.input_value);
    memset(solver->state.converged_resultant, 0,
           structure->elements * sizeof *solver->state.resultant);
    memcpy(solver->state.displacement, solver->state.converged_displacement,
           structure->free_dof * sizeof *solver->state.displacement);
    memcpy(solver->state.input_value, solver->state.converged_input_value,
           structure->input.count * sizeof *solver->state.input_value);
    memcpy(solver->state.resultant, solver->state.converged_resultant,
           structure->elements * sizeof *solver->state.resultant);
    memset(solver->state.prescribed, 0, structure->elements * sizeof *solver->state.prescribed);
    solver->info.negative_pivots = 0;
    solver->info.load_factor = 0;
    solver->info.residual = 0;
    solver->state.stage = SOLVER_READY;
    for (pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->reset)
            option->call->reset(option, solver);
}

bool pzs_nonlinear_is_attached(const pzs_solver *solver, const pzs_solver_option *option)
{
    const pzs_solver_option *attached = solver->state.option;
    while (attached && attached != option)
        attached = attached->next;
    return attached != NULL;
}

void pzs_nonlinear_attach(pzs_solver *solver, pzs_solver_option *option,
                          const struct pzs_solver_option_calls *call)
{
    option->call = call;
    option->next = solver->state.option;
    solver->state.option = option;
    solver->state.stage = SOLVER_READY;
}

/* ---- forces of the inputs --------------------------------------------- */

void pzs_nonlinear_set_prescribed(pzs_solver *solver)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    const pzs_prescribed_resultants *given = &solver->state.tables->resultants;
    memset(solver->state.prescribed, 0, structure->elements * sizeof *solver->state.prescribed);
    for (uint32_t j = 0; given->start && j < structure->input.count; j++)
        for (uint32_t entry = given->start[j];
             solver->state.input_value[j] != 0 && entry < given->start[j + 1]; entry++) {
            const pzs_real factor =
                pzs_model_type_factor(solver->state.model, given->element[entry]);
            for (int i = 0; factor > 0 && i < SHELL_STRAINS; i++)
                solver->state.prescribed[given->element[entry]][i] +=
                    solver->state.input_value[j] / factor * given->value[given->which[entry]][i];
        }
}

static bool has_prescribed_resultants(const pzs_solver *solver, uint32_t input)
{
    const uint32_t *start = solver->state.tables->resultants.start;
    return start && start[input + 1] > start[input];
}

void pzs_nonlinear_unit_force(pzs_solver *solver, uint32_t input, pzs_real *force)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    const pzs_prescribed_resultants *given = &solver->state.tables->resultants;
    const bool is_actuation = has_prescribed_resultants(solver, input);
    if (!is_actuation)
        pzs_model_add_input(solver->state.model, input, 1, force);
    for (uint32_t entry = is_actuation ? given->start[input] : 0;
         is_actuation && entry < given->start[input + 1]; entry++) {
        const uint16_t *node = structure->element[given->element[entry]];
        pzs_real displacement[SHELL_MAX], internal_force[SHELL_MAX],
            resultant[SHELL_RESULTANTS] = {0};
        memcpy(resultant, given->value[given->which[entry]], SHELL_STRAINS * sizeof *resultant);
        pzs_model_gather(solver->state.model, node, SHELL_NODES, solver->state.displacement,
                         displacement);
        pzs_shell_force_at(pzs_model_element_type(solver->state.model, given->element[entry]),
                           structure->dof_per_node, displacement, resultant, internal_force);
        pzs_model_scatter(solver->state.model, node, SHELL_NODES, -1, internal_force, force);
    }
    for (pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->add_unit_force)
            option->call->add_unit_force(option, solver, input, force);
}

/* ---- one linear solve ------------------------------------------------- */

void pzs_nonlinear_build(pzs_solver *solver, bool uses_true_resultants, pzs_real *imbalance)
{
    pzs_model *model = solver->state.model;
    const pzs_structure *structure = model->state.structure;
    pzs_linalg_clear(&model->state.stiffness);
    model->state.stage = STAGE_READY;
    memset(solver->state.load, 0, structure->free_dof * sizeof *solver->state.load);
    memset(imbalance, 0, structure->free_dof * sizeof *imbalance);
    for (uint32_t element = 0; element < structure->elements; element++) {
        const pzs_real factor = pzs_model_type_factor(model, element);
        pzs_real displacement[SHELL_MAX], internal_force[SHELL_MAX],
            tangent[SHELL_PACKED(SHELL_MAX)];
        pzs_model_gather(model, structure->element[element], SHELL_NODES,
                         solver->state.displacement, displacement);
        pzs_shell_system(pzs_model_element_type(solver->state.model, element),
                         structure->dof_per_node, displacement, solver->state.prescribed[element],
                         uses_true_resultants ? NULL : solver->state.resultant[element],
                         internal_force, tangent);
        pzs_model_add_matrix(model, structure->element[element], SHELL_NODES, factor, tangent);
        pzs_model_scatter(model, structure->element[element], SHELL_NODES, -factor, internal_force,
                          imbalance);
    }
    pzs_model_add_springs(model);
    pzs_model_add_spring_force(model, -1, solver->state.displacement, imbalance);
    for (uint32_t i = 0; model->state.constrained && i < structure->free_dof; i++)
        if (model->state.constrained[i])
            *pzs_linalg_entry(&model->state.stiffness, i, i) = 1;
    for (uint32_t j = 0; j < structure->input.count; j++)
        if (solver->state.input_value[j] != 0 && !has_prescribed_resultants(solver, j))
            pzs_model_add_input(model, j, solver->state.input_value[j], solver->state.load);
    for (pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->add_forces)
            option->call->add_forces(option, solver, solver->state.load);
    for (uint32_t i = 0; i < structure->free_dof; i++)
        imbalance[i] += solver->state.load[i];
}

void pzs_nonlinear_prescribe(pzs_envelope *matrix, uint32_t dof, pzs_real value,
                             pzs_real *right_side)
{
    for (uint32_t i = 0; i < matrix->n; i++) {
        const uint32_t row = i > dof ? i : dof;
        const uint32_t column = i > dof ? dof : i;
        if (i == dof || matrix->first[row] > column)
            continue;
        pzs_real *entry = pzs_linalg_entry(matrix, row, column);
        right_side[i] -= *entry * value;
        *entry = 0;
    }
    pzs_real *diagonal = pzs_linalg_entry(matrix, dof, dof);
    *diagonal = *diagonal > 0 ? *diagonal : 1;
    right_side[dof] = *diagonal * value;
}

void pzs_nonlinear_clear_prescribed(const pzs_solver *solver, pzs_real *internal_force)
{
    const pzs_prescribed_motion *motion = &solver->state.tables->prescribed;
    for (uint32_t i = 0; i < motion->count; i++)
        internal_force[motion->dof[i]] = 0;
}

/*
 * Prescribe the increment of those degrees of freedom whose motion is given, in the right-hand side
 * [free_dof] and in the tangent matrix. Returns the squared norm of the reaction forces there, each
 * multiplied by the scale factor of its matrix row.
 */
static pzs_real prescribe_all(pzs_solver *solver, pzs_real *right_side)
{
    const pzs_prescribed_motion *motion = &solver->state.tables->prescribed;
    pzs_real reaction = 0;
    for (uint32_t i = 0; i < motion->count; i++) {
        const pzs_real scaled =
            solver->state.model->state.scale[motion->dof[i]] * right_side[motion->dof[i]];
        reaction += scaled * scaled;
    }
    for (uint32_t i = 0; i < motion->count; i++)
        pzs_nonlinear_prescribe(&solver->state.model->state.stiffness, motion->dof[i],
                                solver->state.input_value[motion->input] * motion->value[i] -
                                    solver->state.displacement[motion->dof[i]],
                                right_side);
    return reaction;
}

bool pzs_nonlinear_factor(pzs_solver *solver)
{
    pzs_linalg_apply_scale(&solver->state.model->state.stiffness, solver->state.model->state.scale);
    const linalg_inertia inertia = pzs_linalg_factor(&solver->state.model->state.stiffness);
    solver->info.negative_pivots = inertia.negative;
    solver->info.where = inertia.zero;
    return inertia.zero < 0;
}

pzs_real pzs_nonlinear_norm2(const pzs_solver *solver, const pzs_real *vector,
                             const pzs_real *other)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    const pzs_real thickness = pzs_structure_thickness(structure);
    pzs_real sum = 0;
    for (uint32_t i = 0; i < (uint32_t)structure->nodes * structure->dof_per_node; i++) {
        const uint16_t dof = structure->node_dof[i];
        if (dof == PZS_CONSTRAINED)
            continue;
        const pzs_real difference = vector[dof] - (other ? other[dof] : 0);
        const pzs_real size = difference * (i % structure->dof_per_node < 3 ? 1 : thickness);
        sum += size * size;
    }
    return sum;
}

void pzs_nonlinear_extrapolate(pzs_solver *solver, const pzs_real *du)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    for (uint32_t element = 0; element < structure->elements; element++) {
        pzs_real displacement[SHELL_MAX], increment[SHELL_MAX];
        pzs_model_gather(solver->state.model, structure->element[element], SHELL_NODES,
                         solver->state.displacement, displacement);
        if (du)
            pzs_model_gather(solver->state.model, structure->element[element], SHELL_NODES, du,
                             increment);
        pzs_shell_resultants(pzs_model_element_type(solver->state.model, element),
                             structure->dof_per_node, displacement, du ? increment : NULL,
                             solver->state.prescribed[element], solver->state.resultant[element]);
    }
}

bool pzs_nonlinear_condense(pzs_solver *solver, uint32_t input, pzs_real *du)
{
    for (pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->condense && !option->call->condense(option, solver, input, du))
            return false;
    return true;
}

/*
 * Make one linear solve of Newton's method and update displacement and stress resultants.
 *   du [free_dof] out  increment of the displacement (m, or 1 for differences over the thickness)
 * Returns false if the tangent matrix is singular, or the additional unknowns of an option
 * (voltages of open electrodes) cannot be solved for.
 */
static bool solve_and_update(pzs_solver *solver, bool uses_true_resultants, pzs_real *du)
{
    const uint32_t free_dof = solver->state.model->state.structure->free_dof;
    for (pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->prepare_solve && !option->call->prepare_solve(option, solver))
            return false;
    pzs_nonlinear_build(solver, uses_true_resultants, du);
    prescribe_all(solver, du);
    if (!pzs_nonlinear_factor(solver))
        return false;
    pzs_model_backsolve(solver->state.model, du, du);
    solver->info.linear_solves++;
    if (!pzs_nonlinear_condense(solver, NEWTON, du) || pzs_guard_nonfinite(du, free_dof) >= 0)
        return false;
    for (pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->after_solve)
            option->call->after_solve(option, solver, du);
    pzs_nonlinear_extrapolate(solver, du);
    for (uint32_t i = 0; i < free_dof; i++)
        solver->state.displacement[i] += du[i];
    return true;
}

/* ---- one load step ---------------------------------------------------- */

/*
 * Return the status of an option of the solver (follower loads, contact, open electrodes) that has
 * not converged at the present displacement, or PZS_OK.
 */
static pzs_status unconverged_option(pzs_solver *solver)
{
    pzs_status open = PZS_OK;
    for (pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->has_converged && !option->call->has_converged(option, solver))
            open = option->call->not_converged;
    return open;
}

/*
 * Add the force of the actuators at the present displacement to the vector of forces `vector`
 * [free_dof].
 */
static void add_actuation(const pzs_solver *solver, pzs_real *vector)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    for (uint32_t element = 0; element < structure->elements; element++) {
        pzs_real displacement[SHELL_MAX], force[SHELL_MAX], resultant[SHELL_RESULTANTS] = {0};
        memcpy(resultant, solver->state.prescribed[element],
               sizeof solver->state.prescribed[element]);
        pzs_model_gather(solver->state.model, structure->element[element], SHELL_NODES,
                         solver->state.displacement, displacement);
        pzs_shell_force_at(pzs_model_element_type(solver->state.model, element),
                           structure->dof_per_node, displacement, resultant, force);
        pzs_model_scatter(solver->state.model, structure->element[element], SHELL_NODES,
                          -pzs_model_type_factor(solver->state.model, element), force, vector);
    }
}

/*
 * Relative size up to which a force imbalance r counts as a rounding error of the internal forces
 * at an equilibrium: sum of r_i^2 / K_ii <= IMBALANCE_ROUNDING^2 * sum of K_ii u_i^2 K_ii  diagonal
 * entries of the stiffness matrix u     displacement Both sums are energies, so that the check
 * holds in any system of units.
 */
#define IMBALANCE_ROUNDING (256 * PZS_EPSILON)

/*
 * Return the sum over the free degrees of freedom of the diagonal entry of the stiffness matrix
 * times the squared displacement (N m): the size of the energies that cancel in a motion without
 * strain.
 */
static pzs_real diagonal_energy(const pzs_model *model, const pzs_real *displacement)
{
    pzs_real sum = 0;
    for (uint32_t i = 0; i < model->state.stiffness.n; i++) {
        const pzs_real scaled = displacement[i] / model->state.scale[i];
        sum += scaled * scaled;
    }
    return sum;
}

/*
 * Assess whether the present displacement is an equilibrium: compute its stress resultants, its
 * force imbalance and the factors of its tangent matrix.
 *   next [free_dof] out  increment that Newton's method would make next
 *                        (m, or 1 for differences over the thickness)
 * Returns false if the tangent matrix is singular or a result is not finite.
 */
static bool assess_equilibrium(pzs_solver *solver, pzs_real *next)
{
    pzs_model *model = solver->state.model;
    const uint32_t free_dof = model->state.structure->free_dof;
    pzs_real *applied = model->state.work + free_dof;
    pzs_nonlinear_build(solver, true, next);
    memcpy(applied, solver->state.load, free_dof * sizeof *applied);
    add_actuation(solver, applied);
    const pzs_real load2 = pzs_model_scaled_norm2(model, applied),
                   reaction2 = prescribe_all(solver, next);
    const pzs_real left2 = pzs_model_scaled_norm2(model, next);
    solver->info.residual =
        load2 + reaction2 > 0 ? PZS_SQRT(left2 / (load2 + reaction2)) : PZS_SQRT(left2);
    solver->state.is_balanced = solver->info.residual <= 1 ||
                                left2 <= IMBALANCE_ROUNDING * IMBALANCE_ROUNDING *
                                             diagonal_energy(model, solver->state.displacement);
    pzs_nonlinear_extrapolate(solver, NULL);
    if (!pzs_nonlinear_factor(solver))
        return false;
    pzs_model_backsolve(model, next, next);
    return pzs_nonlinear_condense(solver, NEWTON, next) &&
           pzs_guard_nonfinite(next, free_dof) < 0 &&
           pzs_guard_nonfinite(&solver->info.residual, 1) < 0;
}

/*
 * Whether Newton's method may continue in this load step: it makes at most STEP_SOLVES linear
 * solves, or twice as many while the last increment is below 1/100 of the load step's displacement.
 * Four successive increments of about the size of that displacement count as divergence.
 */
static bool may_continue(const pzs_solver *solver, uint32_t divergence_count)
{
    const bool is_near = solver->info.relative_increment < (pzs_real)0.01;
    const uint32_t most = is_near ? 2 * STEP_SOLVES : STEP_SOLVES;
    return divergence_count < 4 && solver->state.iteration < most;
}

/*
 * Set the input values to those at the last equilibrium plus `part` (above 0, at most 1) of the
 * remaining way to the wanted values.
 */
static void set_input_values(pzs_solver *solver, const pzs_real *value, pzs_real part)
{
    const uint32_t inputs = solver->state.model->state.structure->input.count;
    for (uint32_t j = 0; j < inputs; j++)
        solver->state.input_value[j] =
            part < 1 ? solver->state.converged_input_value[j] +
                           part * (value[j] - solver->state.converged_input_value[j])
                     : value[j];
    pzs_nonlinear_set_prescribed(solver);
}

/*
 * Iterate by Newton's method towards the equilibrium at `part` (above 0, at most 1) of the
 * remaining way to the wanted input values. Returns whether the iteration has converged;
 * state.pending_error is the status of an option of the solver (such as a contact) that has not.
 */
static bool iterate(pzs_solver *solver, const pzs_real *value, pzs_real part)
{
    const pzs_real least = PZS_BY_BITS((pzs_real)1e-2, (pzs_real)1e-6),
                   limit2 = solver->settings.tolerance * solver->settings.tolerance;
    // The first linear solves raise the input values in equal parts. Applied at once, a load whose
    // displacement is far beyond linear kinematics would cost more solves.
    const uint32_t ramp = solver->settings.ramp_solves;
    pzs_real *du = solver->state.model->state.work;
    uint32_t divergence_count = 0;
    solver->info.relative_increment = 1;
    solver->state.pending_error = PZS_OK;
    solver->info.where = -1;
    for (solver->state.iteration = 0; may_continue(solver, divergence_count);
         solver->state.iteration++) {
        const uint32_t rising = solver->state.iteration + 1;
        if (rising <= ramp)
            set_input_values(solver, value,
                             rising < ramp ? part * (pzs_real)rising / (pzs_real)ramp : part);
        if (solver->info.linear_solves >= solver->settings.solve_limit ||
            !solve_and_update(
                solver, solver->state.iteration >= solver->settings.extrapolated_iterations, du))
            return false;
        /*
         * The tolerance refers to the size of the load step's displacement. A small part of the
         * whole displacement is added to it, because in a very short load step rounding errors
         * could otherwise exceed the tolerance.
         */
        const pzs_real moved2 =
            pzs_nonlinear_norm2(solver, solver->state.displacement,
                                solver->state.converged_displacement) +
            least * pzs_nonlinear_norm2(solver, solver->state.displacement, NULL);
        const pzs_real last2 = pzs_nonlinear_norm2(solver, du, NULL);
        solver->info.relative_increment = moved2 > 0 ? PZS_SQRT(last2 / moved2) : 0;
        divergence_count =
            solver->state.iteration > 2 && solver->info.relative_increment > (pzs_real)0.9
                ? divergence_count + 1
                : 0;
        if (rising < ramp || !(last2 <= limit2 * moved2))
            continue;
        solver->state.pending_error = unconverged_option(solver);
        // The iteration has converged if the forces are in balance and the predicted next increment
        // is below the tolerance, too.
        if (!solver->state.pending_error && assess_equilibrium(solver, du) &&
            solver->state.is_balanced && pzs_nonlinear_norm2(solver, du, NULL) <= limit2 * moved2)
            return true;
    }
    return false;
}

/* ---- load steps ------------------------------------------------------- */

static void save_equilibrium(pzs_solver *solver)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    memcpy(solver->state.converged_displacement, solver->state.displacement,
           structure->free_dof * sizeof *solver->state.displacement);
    memcpy(solver->state.converged_input_value, solver->state.input_value,
           structure->input.count * sizeof *solver->state.input_value);
    memcpy(solver->state.converged_resultant, solver->state.resultant,
           structure->elements * sizeof *solver->state.resultant);
    for (pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->save)
            option->call->save(option, solver);
}

static void restore_equilibrium(pzs_solver *solver)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    memcpy(solver->state.displacement, solver->state.converged_displacement,
           structure->free_dof * sizeof *solver->state.displacement);
    memcpy(solver->state.input_value, solver->state.converged_input_value,
           structure->input.count * sizeof *solver->state.input_value);
    memcpy(solver->state.resultant, solver->state.converged_resultant,
           structure->elements * sizeof *solver->state.resultant);
    pzs_nonlinear_set_prescribed(solver);
    for (pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->restore)
            option->call->restore(option, solver);
}

/*
 * Whether all options of the solver (follower loads, contact, open electrodes) accept the converged
 * shape. Otherwise state.refused holds the error of the first option that does not.
 */
static bool options_accept(pzs_solver *solver)
{
    solver->state.warned = PZS_OK;
    for (pzs_solver_option *option = solver->state.option; option; option = option->next) {
        const pzs_status status =
            option->call->check_step ? option->call->check_step(option, solver) : PZS_OK;
        if (PZS_IS_ERROR(status)) {
            solver->state.refused = status;
            return false;
        }
        if (status != PZS_OK)
            solver->state.warned = status;
    }
    return true;
}

/*
 * Try one load step, which takes `part` of the remaining way from the last equilibrium to the
 * wanted input values. Returns whether the load step has converged and its shape is accepted; only
 * then is the shape saved as the last equilibrium.
 */
static bool try_load_step(pzs_solver *solver, const pzs_real *value, pzs_real part)
{
    solver->state.refused = PZS_OK;
    if (!iterate(solver, value, part) || !options_accept(solver))
        return false;
    save_equilibrium(solver);
    solver->info.load_steps++;
    return true;
}

/*
 * Return the error status that describes why a load step has failed, such as an instability.
 * negative_before is the number of negative pivots of the tangent matrix at the last equilibrium.
 */
static pzs_status failure_status(const pzs_solver *solver, uint32_t negative_before)
{
    if (solver->state.refused)
        return solver->state.refused;
    for (const pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->is_unsupported && option->call->is_unsupported(option, solver))
            return PZS_E_CONTACT;
    if (solver->info.linear_solves >= solver->settings.solve_limit)
        return PZS_E_SOLVES;
    if (solver->state.pending_error)
        return solver->state.pending_error;
    return solver->info.where >= 0 || solver->info.negative_pivots != negative_before
               ? PZS_E_LIMIT
               : PZS_E_DIVERGED;
}

/*
 * Return the largest part (above 0, at most 1) of the remaining way to the wanted input values that
 * all options of the solver (such as a contact) allow in one load step.
 */
static pzs_real largest_part(const pzs_solver *solver, const pzs_real *value)
{
    pzs_real part = 1;
    for (pzs_solver_option *option = solver->state.option; option; option = option->next) {
        const pzs_real most =
            option->call->largest_part ? option->call->largest_part(option, solver, value) : 1;
        part = most < part ? most : part;
    }
    return part;
}

/*
 * Progress of the load steps on the way from the last equilibrium to the wanted input values. The
 * way is divided into equal units; the members count the units in total, those done, those of the
 * next load step (stride) and those of the longest load step.
 */
typedef struct load_progress {
    uint32_t total, done, stride, longest;
} load_progress;

/*
 * Make the units in which load steps are counted finer: halve their size, and thus double all
 * counts, until a shortened load step has at least 2^STEP_HALVINGS units. It can then still be
 * halved STEP_HALVINGS times.
 *   part in  shortened load step, as a fraction (0 to 1) of the remaining way
 */
static void refine_units(load_progress *progress, pzs_real part)
{
    const pzs_real enough = (pzs_real)(1u << STEP_HALVINGS);
    while (part * (pzs_real)(progress->total - progress->done) < enough &&
           progress->total < 1u << 30) {
        progress->total *= 2;
        progress->done *= 2;
        progress->stride *= 2;
        progress->longest *= 2;
    }
}

/*
 * Return the length of the next load step in units (load_progress), or 0 if an option of the
 * solver, such as a contact, allows not even one unit. *is_short tells whether an option has
 * shortened the load step.
 */
static uint32_t next_step_units(const pzs_solver *solver, load_progress *progress,
                                const pzs_real *value, bool *is_short)
{
    const pzs_real part = largest_part(solver, value);
    if (part < 1)
        refine_units(progress, part);
    const uint32_t left = progress->total - progress->done,
                   take = progress->stride < left ? progress->stride : left;
    const pzs_real most = part * (pzs_real)left;
    *is_short = part < 1 && (pzs_real)take > most;
    if (*is_short)
        progress->stride = (uint32_t)most;
    return *is_short ? progress->stride : take;
}

/*
 * Run all load steps. A load step that does not converge is halved. After a load step that
 * converges, the length of the next one is doubled, up to that of the first. Lengths are counted in
 * equal units, so that the last load step ends exactly at the input values. The first load step has
 * 2^STEP_HALVINGS units.
 */
static pzs_status run_load_steps(pzs_solver *solver, const pzs_real *value)
{
    const uint32_t first = 1u << STEP_HALVINGS;
    load_progress progress = {(uint32_t)solver->settings.load_steps << STEP_HALVINGS, 0, first,
                              first};
    uint32_t negative_before = solver->info.negative_pivots;
    while (progress.done < progress.total) {
        bool is_short;
        const uint32_t take = next_step_units(solver, &progress, value, &is_short);
        if (take == 0)
            return PZS_E_SOLVES;
        if (try_load_step(solver, value,
                          (pzs_real)take / (pzs_real)(progress.total - progress.done))) {
            progress.done += take;
            progress.stride =
                progress.stride < progress.longest ? 2 * progress.stride : progress.stride;
            negative_before = solver->info.negative_pivots;
            solver->info.load_factor = (pzs_real)progress.done / (pzs_real)progress.total;
            solver->info.shortened_steps += (uint32_t)is_short;
            continue;
        }
        const pzs_status why = failure_status(solver, negative_before);
        restore_equilibrium(solver);
        if (progress.stride == 1 || solver->info.linear_solves >= solver->settings.solve_limit)
            return why;
        progress.stride /= 2;
    }
    if (solver->state.warned)
        return solver->state.warned;
    return solver->info.negative_pivots > 0 ? PZS_W_UNSTABLE : PZS_OK;
}

/*
 * Whether the settings of the equilibrium solver and of its options (follower loads, contact, open
 * electrodes) are in range.
 */
static bool settings_in_range(const pzs_solver *solver)
{
    for (const pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->settings_in_range && !option->call->settings_in_range(option))
            return false;
    return solver->settings.load_steps > 0 && solver->settings.ramp_solves > 0 &&
           solver->settings.tolerance > 0 && solver->settings.tolerance < 1;
}

pzs_status pzs_equilibrium(pzs_solver *solver, const pzs_real *value)
{
    if (!solver || !value)
        return PZS_E_ARGUMENT;
    if (solver->state.stage < SOLVER_READY)
        return fail(solver, PZS_E_STAGE, -1);
    if (!settings_in_range(solver))
        return fail(solver, PZS_E_ARGUMENT, -1);
    const int32_t bad =
        pzs_guard_nonfinite(value, solver->state.model->state.structure->input.count);
    if (bad >= 0)
        return fail(solver, PZS_E_NONFINITE, bad);
    solver->info.linear_solves = 0;
    solver->info.load_steps = 0;
    solver->info.shortened_steps = 0;
    solver->state.refused = PZS_OK;
    solver->state.warned = PZS_OK;
    solver->state.refused_at = -1;
    solver->info.load_factor = 0;
    solver->state.stage = SOLVER_READY;
    const pzs_status status = run_load_steps(solver, value);
    if (!PZS_IS_ERROR(status) || assess_equilibrium(solver, solver->state.model->state.work)) {
        solver->state.stage = SOLVER_CONVERGED;
        solver->state.model->state.stage = STAGE_AT_SHAPE;
    }
    const bool is_refused = PZS_IS_ERROR(status) && status == solver->state.refused;
    return fail(solver, status, is_refused ? solver->state.refused_at : -1);
}

#endif
