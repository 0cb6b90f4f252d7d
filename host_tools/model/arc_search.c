/* SPDX-License-Identifier: BSD-2-Clause */
/* One step of the arc-length method (arc_search.h). */
#include "arc_search.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/core/guard.h"
#include "../../lib/model/electrode.h"
#include "../../lib/model/model.h"
#include "../../lib/nonlinear/nonlinear.h"

/* ---- memory ----------------------------------------------------------- */

double arc_product(const arc_search *arc_search, const double *first, const double *second)
{
    double sum = 0;
    for (size_t i = 0; i < arc_search->entries; i++)
        sum += arc_search->metric[i] * first[i] * second[i];
    return sum;
}

static void fill_metric(arc_search *arc_search)
{
    const pzs_structure *structure = arc_search->solver->state.model->state.structure;
    const double thickness = structure->type[0].thickness;
    for (uint32_t i = 0; i < (uint32_t)structure->nodes * structure->dof_per_node; i++)
        if (structure->node_dof[i] != PZS_CONSTRAINED)
            arc_search->metric[structure->node_dof[i]] =
                i % structure->dof_per_node < 3 ? 1 : thickness * thickness;
}

size_t arc_open_electrodes(const arc_search *arc_search)
{
    return arc_search->circuit ? arc_search->circuit->state.open.n : 0;
}

int arc_open(arc_search *arc_search, analysis *analysis)
{
    memset(arc_search, 0, sizeof *arc_search);
    arc_search->solver = &analysis->equilibrium.solver;
    arc_search->full = analysis->equilibrium.full_input;
    arc_search->circuit =
        analysis->equilibrium.circuit_work ? &analysis->equilibrium.circuit : NULL;
    arc_search->free_dof = (size_t)analysis->design.mesh.free_dof;
    arc_search->entries = arc_search->free_dof + arc_open_electrodes(arc_search);
    double **const vector[] = {&arc_search->metric,      &arc_search->start,
                               &arc_search->direction,   &arc_search->increment,
                               &arc_search->by_residual, &arc_search->by_load,
                               &arc_search->origin,      &arc_search->unit};
    const size_t vectors = sizeof vector / sizeof *vector;
    arc_search->memory = calloc(vectors * arc_search->entries, sizeof *arc_search->memory);
    if (!arc_search->memory)
        return -1;
    if (arc_contact_open(&arc_search->contact, analysis) < 0) {
        free(arc_search->memory);
        return -1;
    }
    for (size_t i = 0; i < vectors; i++)
        *vector[i] = arc_search->memory + i * arc_search->entries;
    fill_metric(arc_search);
    return 0;
}

void arc_close(arc_search *arc_search)
{
    arc_contact_close(&arc_search->contact);
    free(arc_search->memory);
}

/* ---- one linear solve ------------------------------------------------- */

/*
 * Set the input values of the equilibrium solver to those at the present load factor, with the
 * present voltages of the open electrodes.
 */
static void set_inputs(arc_search *arc_search)
{
    pzs_solver *solver = arc_search->solver;
    const uint32_t inputs = solver->state.model->state.structure->input.count;
    for (uint32_t j = 0; j < inputs; j++)
        solver->state.input_value[j] = arc_search->load_factor * arc_search->full[j];
    for (uint32_t k = 0; k < arc_open_electrodes(arc_search); k++) {
        const size_t entry = arc_search->free_dof + k;
        const uint16_t input = pzs_electrode_open_input(arc_search->circuit->state.tables, k);
        solver->state.input_value[input] = arc_search->start[entry] + arc_search->increment[entry];
    }
    pzs_nonlinear_set_prescribed(solver);
}

void arc_set_point(arc_search *arc_search)
{
    for (size_t i = 0; i < arc_search->free_dof; i++)
        arc_search->solver->state.displacement[i] = arc_search->start[i] + arc_search->increment[i];
    set_inputs(arc_search);
}

/*
 * Compute the nodal forces per unit of the load factor at the present point of the load path, and
 * store them in the vector by_load.
 */
static void full_force(arc_search *arc_search)
{
    const uint32_t inputs = arc_search->solver->state.model->state.structure->input.count;
    memset(arc_search->by_load, 0, arc_search->entries * sizeof *arc_search->by_load);
    for (uint32_t j = 0; j < inputs; j++) {
        if (arc_search->full[j] == 0)
            continue;
        memset(arc_search->unit, 0, arc_search->entries * sizeof *arc_search->unit);
        pzs_nonlinear_unit_force(arc_search->solver, j, arc_search->unit);
        for (size_t i = 0; i < arc_search->free_dof; i++)
            arc_search->by_load[i] += arc_search->full[j] * arc_search->unit[i];
    }
}

/*
 * Complete a change of the displacement where open electrodes keep their charge: compute the
 * changes of their voltages, and add the displacement that these cause.
 *   input  in  cause of the change: index of an input of one unit; NEWTON: residual forces and
 *       charges; NO_INPUT: nodal forces without charges
 *   change [free dof, then open electrodes] in/out  changes of displacement and voltages
 * Returns false if the voltages cannot be solved for.
 */
static bool condense_voltages(arc_search *arc_search, uint32_t input, double *change)
{
    if (!arc_search->circuit)
        return true;
    if (!pzs_nonlinear_condense(arc_search->solver, input, change))
        return false;
    memcpy(change + arc_search->free_dof, arc_search->circuit->state.voltage_change,
           arc_open_electrodes(arc_search) * sizeof *change);
    return true;
}

/*
 * Add to by_load, the change per unit of the load factor, the effect of the charges that the inputs
 * at full load cause on the open electrodes at zero strain. Returns false if the voltages of the
 * open electrodes cannot be solved for.
 */
static bool add_charges_of_load(arc_search *arc_search)
{
    const uint32_t inputs = arc_search->solver->state.model->state.structure->input.count;
    for (uint32_t j = 0; arc_search->circuit && j < inputs; j++) {
        if (arc_search->full[j] == 0)
            continue;
        memset(arc_search->unit, 0, arc_search->entries * sizeof *arc_search->unit);
        if (!condense_voltages(arc_search, j, arc_search->unit))
            return false;
        for (size_t i = 0; i < arc_search->entries; i++)
            arc_search->by_load[i] += arc_search->full[j] * arc_search->unit[i];
    }
    return true;
}

bool arc_respond(arc_search *arc_search, double *vector)
{
    pzs_model_backsolve(arc_search->solver->state.model, vector, vector);
    return condense_voltages(arc_search, NO_INPUT, vector);
}

bool arc_solve(arc_search *arc_search, bool uses_true_resultants)
{
    pzs_solver *solver = arc_search->solver;
    arc_set_point(arc_search);
    pzs_nonlinear_build(solver, uses_true_resultants, arc_search->by_residual);
    full_force(arc_search);
    arc_search->iterations++;
    if (!pzs_nonlinear_factor(solver))
        return false;
    pzs_model_backsolve(solver->state.model, arc_search->by_residual, arc_search->by_residual);
    pzs_model_backsolve(solver->state.model, arc_search->by_load, arc_search->by_load);
    return condense_voltages(arc_search, NEWTON, arc_search->by_residual) &&
           condense_voltages(arc_search, NO_INPUT, arc_search->by_load) &&
           add_charges_of_load(arc_search) &&
           pzs_guard_nonfinite(arc_search->by_load, (uint32_t)arc_search->entries) < 0;
}

/* ---- one step --------------------------------------------------------- */

/*
 * Return the change c of the load factor with which increment + by_residual + c by_load has the
 * length `arc` (by_residual, by_load: changes of the displacement by the residual forces, and per
 * unit of the load factor). Of two solutions it is the one that turns the increment less; NAN if
 * there is none.
 */
static double constrained_change(const arc_search *arc_search, double arc)
{
    const double *load = arc_search->by_load, *residual = arc_search->by_residual,
                 *increment = arc_search->increment;
    const double load2 = arc_product(arc_search, load, load);
    const double half =
        arc_product(arc_search, increment, load) + arc_product(arc_search, residual, load);
    const double rest = arc_product(arc_search, increment, increment) +
                        2 * arc_product(arc_search, increment, residual) +
                        arc_product(arc_search, residual, residual) - arc * arc;
    const double root = sqrt(half * half - load2 * rest);
    /*
     * The quadratic equation for the change of the load factor has two solutions. The one that
     * turns the increment of displacement and voltages less is taken. Which one this is follows
     * from the sign of `along`: the product of this increment with its change per unit of the load
     * factor.
     */
    const double along = arc_product(arc_search, increment, load);
    return (-half + (along < 0 ? -root : root)) / load2;
}

/*
 * Complete one iteration of an arc-length step: change the load factor by `change`, and add
 * by_residual + change by_load (effects of the residual forces and of the load factor) to the
 * increment of displacement and voltages. Returns the squared norm of what was added.
 */
static double add_changes(arc_search *arc_search, double change)
{
    for (size_t i = 0; i < arc_search->entries; i++) {
        arc_search->by_residual[i] += change * arc_search->by_load[i];
        arc_search->increment[i] += arc_search->by_residual[i];
    }
    arc_search->load_factor += change;
    set_inputs(arc_search);
    arc_contact_predict(&arc_search->contact, arc_search->by_residual);
    pzs_nonlinear_extrapolate(arc_search->solver, arc_search->by_residual);
    return arc_product(arc_search, arc_search->by_residual, arc_search->by_residual);
}

/*
 * Correct the increment until it leads to an equilibrium at the distance `arc` from the last
 * converged point of the load path; with arc = 0, to an equilibrium at the present load factor.
 * Returns whether the iteration has converged.
 */
static bool correct_increment(arc_search *arc_search, double arc)
{
    enum { CORRECTIONS = 12, CORRECTIONS_IN_CONTACT = 40 };
    const int most = arc_search->contact.contact ? CORRECTIONS_IN_CONTACT : CORRECTIONS;
    const double tolerance = 1e-8;
    double relative = 1;
    for (int i = 0; i < most; i++) {
        arc_set_point(arc_search);
        arc_contact_prepare(&arc_search->contact, i, relative);
        if (!arc_solve(arc_search, false))
            return false;
        const double change = arc > 0 ? constrained_change(arc_search, arc) : 0;
        if (!isfinite(change))
            return false;
        const double moved2 = add_changes(arc_search, change);
        const double size2 = arc_product(arc_search, arc_search->increment, arc_search->increment);
        relative = size2 > 0 ? sqrt(moved2 / size2) : 0;
        if (relative > tolerance)
            continue;
        arc_set_point(arc_search);
        if (arc_contact_has_converged(&arc_search->contact))
            return true;
    }
    return false;
}

/*
 * Return the sign (1 or -1) of the change of the load factor that continues in the direction of the
 * last step on the load path.
 */
static double forward_sign(const arc_search *arc_search)
{
    return arc_product(arc_search, arc_search->direction, arc_search->by_load) < 0 ? -1 : 1;
}

bool arc_restore(arc_search *arc_search)
{
    memset(arc_search->increment, 0, arc_search->entries * sizeof *arc_search->increment);
    arc_search->load_factor = arc_search->start_factor;
    arc_contact_restore(&arc_search->contact);
    return arc_solve(arc_search, true);
}

bool arc_step(arc_search *arc_search, const double *predictor, double scale, double change,
              double arc)
{
    for (size_t i = 0; i < arc_search->entries; i++)
        arc_search->increment[i] = scale * predictor[i];
    arc_search->load_factor = arc_search->start_factor + change;
    set_inputs(arc_search);
    arc_contact_predict(&arc_search->contact, arc_search->increment);
    pzs_nonlinear_extrapolate(arc_search->solver, arc_search->increment);
    return correct_increment(arc_search, arc) && arc_contact_accepts(&arc_search->contact) &&
           arc_solve(arc_search, true) &&
           arc_product(arc_search, arc_search->direction, arc_search->increment) > 0;
}

/*
 * Make a step of the length `arc` that starts along the tangent of the load path; `change` is the
 * change of the load factor in the first iteration (arc_step).
 */
static bool make_step(arc_search *arc_search, double change, double arc)
{
    return arc_step(arc_search, arc_search->by_load, change, change, arc);
}

bool arc_try_step(arc_search *arc_search, double arc)
{
    const double length = sqrt(arc_product(arc_search, arc_search->by_load, arc_search->by_load));
    return make_step(arc_search, forward_sign(arc_search) * arc / length, arc);
}

bool arc_land_at_full_load(arc_search *arc_search, double *arc)
{
    if (!arc_restore(arc_search) || !make_step(arc_search, 1 - arc_search->start_factor, 0))
        return false;
    arc_search->load_factor = 1;
    *arc = sqrt(arc_product(arc_search, arc_search->increment, arc_search->increment));
    return true;
}

void arc_accept(arc_search *arc_search)
{
    for (size_t i = 0; i < arc_search->entries; i++) {
        arc_search->direction[i] = arc_search->increment[i];
        arc_search->start[i] += arc_search->increment[i];
        arc_search->increment[i] = 0;
    }
    arc_search->start_factor = arc_search->load_factor;
    arc_contact_save(&arc_search->contact);
}
