/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Open electrodes at a deformed shape (pzs_nonlinear.h). Their voltages are additional unknowns of
 * Newton's method, which a Schur complement on the factors of K eliminates:
 *   K du - f dV = force imbalance,  f' du + C dV = prescribed charge - present charge
 *   du, dV  increments of displacement and voltages
 *   K       tangent matrix
 *   C       capacitance while the shell cannot deform
 *   f       force per volt, which turns with the shell; f' is its transpose
 */
#include "../model/electrode.h"
#include "../core/guard.h"
#include "../core/linalg.h"
#include "../model/compact.h"
#include "../model/model.h"
#include "nonlinear.h"
#include "../model/shell.h"
#include <string.h>

#if PZS_NONLINEAR

static pzs_circuit *circuit_of(pzs_solver_option *option)
{
    return (pzs_circuit *)option;
}

/*
 * Return the charge of an electrode at the present displacement: minus the product of the
 * prescribed stress resultants per volt and the strains, summed over the elements, plus the charge
 * that would flow if the shell could not deform.
 */
static pzs_real charge_at(const pzs_solver *solver, const pzs_electrodes *tables,
                          uint32_t electrode)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    const pzs_prescribed_resultants *given = &solver->state.tables->resultants;
    const uint16_t input = tables->input[electrode];
    pzs_real charge = 0;
    for (uint32_t i = given->start[input]; i < given->start[input + 1]; i++) {
        pzs_real displacement[SHELL_MAX], strain[SHELL_MODES][SHELL_STRAINS];
        pzs_model_gather(solver->state.model, structure->element[given->element[i]], SHELL_NODES,
                         solver->state.displacement, displacement);
        pzs_shell_strains_at(pzs_model_element_type(solver->state.model, given->element[i]),
                             structure->dof_per_node, displacement, strain);
        charge -= pzs_linalg_inner(given->value[given->which[i]], strain[0], SHELL_STRAINS);
    }
    for (uint32_t i = tables->direct.start[electrode]; i < tables->direct.start[electrode + 1]; i++)
        charge += tables->direct.value[i] * solver->state.input_value[tables->direct.dof[i]];
    return charge;
}

pzs_status pzs_charges_at(const pzs_solver *solver, const pzs_electrodes *tables, pzs_real *charge)
{
    if (!solver || !solver->state.model || !tables || !charge ||
        !solver->state.tables->resultants.start)
        return PZS_E_ARGUMENT;
    for (uint32_t k = 0; k < tables->count; k++)
        charge[k] = charge_at(solver, tables, k);
    return PZS_OK;
}

/*
 * Compute the force [free_dof] per volt on an open electrode, given its number among the open
 * electrodes.
 */
static void unit_voltage_force(const pzs_circuit *circuit, pzs_solver *solver, uint32_t open,
                               pzs_real *force)
{
    memset(force, 0, solver->state.model->state.structure->free_dof * sizeof *force);
    pzs_nonlinear_unit_force(solver, pzs_electrode_open_input(circuit->state.tables, open), force);
}

/*
 * Solve in place for the displacement under a force with the factors of the tangent matrix, while
 * the degrees of freedom whose motion is prescribed stay at zero.
 */
static void solve_free(pzs_solver *solver, pzs_real *vector)
{
    pzs_nonlinear_clear_prescribed(solver, vector);
    pzs_model_backsolve(solver->state.model, vector, vector);
}

/*
 * Compute and factor a matrix with a row and a column for each open electrode, at the present
 * displacement: the charge of the electrode in the row per volt on the electrode in the column.
 * Returns false if the matrix is singular.
 *   force, response [free_dof] out  work arrays
 */
static bool factor_open(pzs_circuit *circuit, pzs_solver *solver, pzs_real *force,
                        pzs_real *response)
{
    const uint32_t dof = solver->state.model->state.structure->free_dof;
    pzs_linalg_clear(&circuit->state.open);
    for (uint32_t open = 0; open < circuit->state.open.n; open++) {
        const uint32_t k = pzs_electrode_open(circuit->state.tables, open);
        unit_voltage_force(circuit, solver, open, response);
        solve_free(solver, response);
        for (uint32_t other = 0; other <= open; other++) {
            unit_voltage_force(circuit, solver, other, force);
            *pzs_linalg_entry(&circuit->state.open, open, other) =
                pzs_linalg_inner(force, response, dof) +
                pzs_electrode_direct(circuit->state.tables, k,
                                     pzs_electrode_open_input(circuit->state.tables, other));
        }
    }
    const linalg_inertia inertia = pzs_linalg_factor(&circuit->state.open);
    /*
     * The negative eigenvalues of the tangent matrix were counted at fixed voltages. Where the
     * electrodes keep their charges instead, the number is smaller by that of the negative
     * eigenvalues of the matrix of charges per volt. This is exact: the inertia of a block matrix
     * is the sum of the inertias of a block and of its Schur complement.
     */
    solver->info.negative_pivots -= inertia.negative < solver->info.negative_pivots
                                        ? inertia.negative
                                        : solver->info.negative_pivots;
    return inertia.zero < 0;
}

/*
 * Return the charge that electrode k must gain in a linear solve (C, or C per unit of an input):
 *   input NEWTON  step of Newton's method: prescribed minus present charge
 *   input index   response to one unit of this input: minus the charge that it causes directly at
 *                 fixed displacement, plus 1 if the input is the prescribed charge of electrode k
 */
static pzs_real charge_to_add(const pzs_circuit *circuit, const pzs_solver *solver, uint32_t k,
                              uint32_t input)
{
    const pzs_electrodes *tables = circuit->state.tables;
    if (input == NEWTON)
        return circuit->settings.charge[k] - charge_at(solver, tables, k);
    const pzs_real unit = tables->input[k] == input ? 1 : 0;
    return unit - pzs_electrode_direct(tables, k, input);
}

static bool condense(pzs_solver_option *option, pzs_solver *solver, uint32_t input, pzs_real *du)
{
    pzs_circuit *circuit = circuit_of(option);
    const uint32_t dof = solver->state.model->state.structure->free_dof;
    pzs_real *response = solver->state.model->state.work + 2 * (size_t)dof, *force = response + dof;
    if (input == NEWTON && !factor_open(circuit, solver, force, response))
        return false;
    for (uint32_t open = 0; open < circuit->state.open.n; open++) {
        const uint32_t k = pzs_electrode_open(circuit->state.tables, open);
        unit_voltage_force(circuit, solver, open, force);
        const pzs_real charge = charge_to_add(circuit, solver, k, input);
        circuit->state.voltage_change[open] = charge - pzs_linalg_inner(force, du, dof);
    }
    pzs_linalg_solve(&circuit->state.open, circuit->state.voltage_change);
    memset(response, 0, dof * sizeof *response);
    for (uint32_t open = 0; open < circuit->state.open.n; open++) {
        unit_voltage_force(circuit, solver, open, force);
        for (uint32_t i = 0; i < dof; i++)
            response[i] += circuit->state.voltage_change[open] * force[i];
    }
    solve_free(solver, response);
    for (uint32_t i = 0; i < dof; i++)
        du[i] += response[i];
    return true;
}

/*
 * Write the voltages of the open electrodes, which are unknowns of the equilibrium, into the input
 * values of the solver, and update the prescribed stress resultants that they cause.
 */
static void set_voltages(const pzs_circuit *circuit, pzs_solver *solver)
{
    for (uint32_t open = 0; open < circuit->state.open.n; open++)
        solver->state.input_value[pzs_electrode_open_input(circuit->state.tables, open)] =
            circuit->state.voltage[open];
    pzs_nonlinear_set_prescribed(solver);
}

static bool prepare_solve(pzs_solver_option *option, pzs_solver *solver)
{
    if (solver->state.iteration == 0)
        set_voltages(circuit_of(option), solver);
    return true;
}

static void after_solve(pzs_solver_option *option, pzs_solver *solver, const pzs_real *du)
{
    pzs_circuit *circuit = circuit_of(option);
    (void)du;
    for (uint32_t open = 0; open < circuit->state.open.n; open++)
        circuit->state.voltage[open] += circuit->state.voltage_change[open];
    set_voltages(circuit, solver);
}

static bool has_converged(pzs_solver_option *option, pzs_solver *solver)
{
    const pzs_circuit *circuit = circuit_of(option);
    const pzs_real voltage2 =
        pzs_linalg_inner(circuit->state.voltage, circuit->state.voltage, circuit->state.open.n);
    const pzs_real change2 = pzs_linalg_inner(circuit->state.voltage_change,
                                              circuit->state.voltage_change, circuit->state.open.n);
    return change2 <= solver->settings.tolerance * solver->settings.tolerance * voltage2;
}

static void save(pzs_solver_option *option, pzs_solver *solver)
{
    const pzs_circuit *circuit = circuit_of(option);
    (void)solver;
    memcpy(circuit->state.converged_voltage, circuit->state.voltage,
           circuit->state.open.n * sizeof *circuit->state.voltage);
}

static void restore(pzs_solver_option *option, pzs_solver *solver)
{
    const pzs_circuit *circuit = circuit_of(option);
    memcpy(circuit->state.voltage, circuit->state.converged_voltage,
           circuit->state.open.n * sizeof *circuit->state.voltage);
    set_voltages(circuit, solver);
}

static void reset(pzs_solver_option *option, pzs_solver *solver)
{
    const pzs_circuit *circuit = circuit_of(option);
    memset(circuit->state.converged_voltage, 0,
           circuit->state.open.n * sizeof *circuit->state.voltage);
    restore(option, solver);
}

static const struct pzs_solver_option_calls calls = {
    .prepare_solve = prepare_solve,
    .after_solve = after_solve,
    .has_converged = has_converged,
    .not_converged = PZS_E_DIVERGED,
    .save = save,
    .restore = restore,
    .reset = reset,
    .condense = condense,
};

pzs_status pzs_attach_circuit(pzs_solver *solver, pzs_circuit *circuit,
                              const pzs_electrodes *tables, void *work, size_t bytes)
{
    if (!solver || !solver->state.model || !circuit || !work ||
        !solver->state.tables->resultants.start)
        return PZS_E_ARGUMENT;
    const pzs_status status = pzs_electrode_check(tables, solver->state.model->state.structure);
    if (status != PZS_OK)
        return status;
    const uint32_t open = pzs_electrode_open_count(tables);
    const int32_t missing =
        guard_missing_bytes(work, bytes, PZS_CIRCUIT_BYTES(tables->count, open));
    if (missing >= 0) {
        solver->info.where = missing;
        return PZS_E_WORKSPACE;
    }
    if (pzs_nonlinear_is_attached(solver, &circuit->option))
        return PZS_E_ARGUMENT;
    memset(circuit, 0, sizeof *circuit);
    circuit->state.tables = tables;
    circuit->settings.charge = work;
    circuit->state.voltage = circuit->settings.charge + tables->count;
    circuit->state.converged_voltage = circuit->state.voltage + open;
    circuit->state.voltage_change = circuit->state.converged_voltage + open;
    memset(work, 0, sizeof *circuit->settings.charge * ((size_t)tables->count + 3 * (size_t)open));
    pzs_linalg_dense_layout(&circuit->state.open, open, circuit->state.voltage_change + open,
                            circuit->state.voltage_change + open + PZS_DENSE(open));
    pzs_nonlinear_attach(solver, &circuit->option, &calls);
    return PZS_OK;
}

#endif
