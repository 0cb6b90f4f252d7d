/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Computation of the load path by the arc-length method, with its limit points and bifurcations
 * (follow_path.h).
 */
#include "follow_path.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/core/guard.h"
#include "../../lib/model/electrode.h"
#include "../../lib/model/model.h"
#include "../../lib/nonlinear/nonlinear.h"
#include "arc_contact.h"
#include "path_cause.h"
#include "path_points.h"
#include "stepped_path.h"

/* ---- state ------------------------------------------------------------ */

/*
 * State of the arc-length method, which follows the load path (curve of equilibria) step by step.
 * Its vectors have `entries` entries: the free dof of the displacement, then the voltages of the
 * open electrodes. A point of the path is such a vector and a load factor.
 */
typedef struct arc_search {
    pzs_solver *solver;
    pzs_circuit *circuit; /* open electrodes, whose voltages are unknown; NULL: none */
    const double *full;   /* [inputs] input values of the scene at full load */
    size_t free_dof, entries;
    double *memory;
    double *metric;    /* [free dof, then open electrodes] weight of each entry in the norm of a
                          vector: 1 for the means of both faces' displacements, thickness^2 for the
                          other dof, 0 for voltages */
    double *start;     /* [free dof, then open electrodes] displacement, and voltages of the open
                          electrodes, at the last converged point of the load path */
    double *direction; /* [free dof, then open electrodes] increment of displacement and voltages in
                          the last converged step on the load path */
    double *increment; /* [free dof, then open electrodes] increment of displacement and voltages
                          since the last converged point of the load path */
    double *by_residual; /* [free dof, then open electrodes] change of displacement and voltages by
                            the residual forces and charges: inverse tangent matrix times (load
                            minus internal force) */
    double *by_load;     /* [free dof, then open electrodes] change of displacement and voltages per
                            unit of the load factor: inverse tangent matrix times force and charge
                            per unit of the load factor */
    double *unit;       /* [free dof, then open electrodes] work vector: nodal forces, or changes of
                           displacement and voltages, per unit of one input of the structure */
    double load_factor; /* load factor at the present point of the load path */
    double start_factor; /* load factor at the last converged point of the load path */
    int iterations;
    arc_contact contact; /* contact with a fixed rigid body; empty where the scene has none */
} arc_search;

static double scalar_product(const arc_search *arc_search, const double *first,
                             const double *second)
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

static size_t open_electrodes(const arc_search *arc_search)
{
    return arc_search->circuit ? arc_search->circuit->state.open.n : 0;
}

/* Allocate the vectors of the arc-length method. Returns 0, or -1 where memory runs out. */
static int arc_open(arc_search *arc_search, analysis *analysis)
{
    memset(arc_search, 0, sizeof *arc_search);
    arc_search->solver = &analysis->equilibrium.solver;
    arc_search->full = analysis->equilibrium.full_input;
    arc_search->circuit =
        analysis->equilibrium.circuit_work ? &analysis->equilibrium.circuit : NULL;
    arc_search->free_dof = (size_t)analysis->design.mesh.free_dof;
    arc_search->entries = arc_search->free_dof + open_electrodes(arc_search);
    double **const vector[] = {&arc_search->metric,      &arc_search->start,
                               &arc_search->direction,   &arc_search->increment,
                               &arc_search->by_residual, &arc_search->by_load,
                               &arc_search->unit};
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

static void arc_close(arc_search *arc_search)
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
    for (uint32_t k = 0; k < open_electrodes(arc_search); k++) {
        const size_t entry = arc_search->free_dof + k;
        const uint16_t input = pzs_electrode_open_input(arc_search->circuit->state.tables, k);
        solver->state.input_value[input] = arc_search->start[entry] + arc_search->increment[entry];
    }
    pzs_nonlinear_set_prescribed(solver);
}

/*
 * Set the equilibrium solver to the displacement at the last converged point of the load path plus
 * the present increment, at the present load factor and voltages.
 */
static void set_point(arc_search *arc_search)
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
           open_electrodes(arc_search) * sizeof *change);
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

/*
 * Factor the tangent stiffness matrix at the present point of an arc-length step, and solve for the
 * changes of displacement and voltages under the residual forces and per unit of the load factor.
 *   uses_true_resultants in  true: geometric stiffness from the stress resultants of the
 *       displacement; false: from resultants extrapolated from the previous iteration
 * Returns false if the tangent stiffness matrix is singular.
 */
static bool solve_both(arc_search *arc_search, bool uses_true_resultants)
{
    pzs_solver *solver = arc_search->solver;
    set_point(arc_search);
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
    const double load2 = scalar_product(arc_search, load, load);
    const double half =
        scalar_product(arc_search, increment, load) + scalar_product(arc_search, residual, load);
    const double rest = scalar_product(arc_search, increment, increment) +
                        2 * scalar_product(arc_search, increment, residual) +
                        scalar_product(arc_search, residual, residual) - arc * arc;
    const double root = sqrt(half * half - load2 * rest);
    /*
     * The quadratic equation for the change of the load factor has two solutions. The sign of this
     * product of the increment and its change per unit of the load factor selects the one that
     * turns the increment less.
     */
    const double along = scalar_product(arc_search, increment, load);
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
    return scalar_product(arc_search, arc_search->by_residual, arc_search->by_residual);
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
        set_point(arc_search);
        arc_contact_prepare(&arc_search->contact, i, relative);
        if (!solve_both(arc_search, false))
            return false;
        const double change = arc > 0 ? constrained_change(arc_search, arc) : 0;
        if (!isfinite(change))
            return false;
        const double moved2 = add_changes(arc_search, change);
        const double size2 =
            scalar_product(arc_search, arc_search->increment, arc_search->increment);
        relative = size2 > 0 ? sqrt(moved2 / size2) : 0;
        if (relative > tolerance)
            continue;
        set_point(arc_search);
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
    return scalar_product(arc_search, arc_search->direction, arc_search->by_load) < 0 ? -1 : 1;
}

/*
 * Return to the last converged point of the load path and compute its tangent stiffness. Returns
 * whether this has succeeded.
 */
static bool restore_start(arc_search *arc_search)
{
    memset(arc_search->increment, 0, arc_search->entries * sizeof *arc_search->increment);
    arc_search->load_factor = arc_search->start_factor;
    arc_contact_restore(&arc_search->contact);
    return solve_both(arc_search, true);
}

/*
 * Make a step along the tangent of the load path from the last converged point, whose tangent
 * stiffness is factored; then correct it.
 *   change in  first change of the load factor
 *   arc    in  length of the step; 0: the load factor stays at its first change
 * Returns whether the step has converged without reversing the path. The tangent stiffness is then
 * that of the new point; `start` is the old point.
 */
static bool make_step(arc_search *arc_search, double change, double arc)
{
    for (size_t i = 0; i < arc_search->entries; i++)
        arc_search->increment[i] = change * arc_search->by_load[i];
    arc_search->load_factor = arc_search->start_factor + change;
    set_inputs(arc_search);
    arc_contact_predict(&arc_search->contact, arc_search->increment);
    pzs_nonlinear_extrapolate(arc_search->solver, arc_search->increment);
    return correct_increment(arc_search, arc) && arc_contact_accepts(&arc_search->contact) &&
           solve_both(arc_search, true) &&
           scalar_product(arc_search, arc_search->direction, arc_search->increment) > 0;
}

/*
 * Make a step of the given length on the load path, from its last converged point, whose tangent
 * stiffness has been factored. Returns whether the step has converged. A step that reverses the
 * direction of the path (by more than a right angle) counts as not converged.
 */
static bool try_step(arc_search *arc_search, double arc)
{
    const double length =
        sqrt(scalar_product(arc_search, arc_search->by_load, arc_search->by_load));
    return make_step(arc_search, forward_sign(arc_search) * arc / length, arc);
}

/*
 * Repeat a step of the load path that has passed the full load, so that it ends at the full load.
 *   arc out  length of the repeated step
 * Returns whether the step has converged. A step that reverses the direction of the path (by more
 * than a right angle) counts as not converged.
 */
static bool land_at_full_load(arc_search *arc_search, double *arc)
{
    if (!restore_start(arc_search) || !make_step(arc_search, 1 - arc_search->start_factor, 0))
        return false;
    arc_search->load_factor = 1;
    *arc = sqrt(scalar_product(arc_search, arc_search->increment, arc_search->increment));
    return true;
}

/*
 * Make the present point of the load path the last converged point, from which the next step
 * starts.
 */
static void accept_point(arc_search *arc_search)
{
    for (size_t i = 0; i < arc_search->entries; i++) {
        arc_search->direction[i] = arc_search->increment[i];
        arc_search->start[i] += arc_search->increment[i];
        arc_search->increment[i] = 0;
    }
    arc_search->start_factor = arc_search->load_factor;
    arc_contact_save(&arc_search->contact);
}

/* ---- critical points -------------------------------------------------- */

/*
 * Two quantities whose change between two points of the load path reveals a critical point: the
 * sign of the load factor's change along the path, and the number of negative pivots of the tangent
 * stiffness.
 */
typedef struct signature {
    double course; /* sign of the change of the load factor along the load path */
    int negative_pivots;
} signature;

/*
 * Signature of the present point of the load path, by which critical points are recognised: sign of
 * the change of the load factor and number of negative pivots.
 *   along [free_dof] in  an increment of the displacement in the direction of the path
 */
static signature signature_at(const arc_search *arc_search, const double *along)
{
    return (signature){scalar_product(arc_search, along, arc_search->by_load) < 0 ? -1.0 : 1.0,
                       (int)arc_search->solver->info.negative_pivots};
}

static bool differs(signature first, signature second, load_path_event_type type)
{
    return type == LOAD_PATH_LIMIT ? first.course != second.course
                                   : first.negative_pivots != second.negative_pivots;
}

/*
 * Return the load factor of the critical point between the last converged point and a point at the
 * distance `arc`: where the signature (sign of the load factor's change, number of negative pivots)
 * changes, by bisection. The present point is overwritten.
 */
static double locate_critical_point(arc_search *arc_search, double arc, signature before,
                                    load_path_event_type type)
{
    enum { BISECTIONS = 14 };
    double low = 0, high = arc, load_factor = arc_search->load_factor;
    for (int i = 0; i < BISECTIONS; i++) {
        const double middle = (low + high) / 2;
        if (!restore_start(arc_search) || !try_step(arc_search, middle))
            return load_factor;
        load_factor = arc_search->load_factor;
        if (differs(before, signature_at(arc_search, arc_search->increment), type))
            high = middle;
        else
            low = middle;
    }
    return load_factor;
}

/*
 * Find the critical points within a step of length `arc` that has just converged, and append them
 * to the path: one pivot of the tangent stiffness changes its sign at a limit point, others at
 * bifurcations. Returns whether the solver could return to the end of the step.
 */
static bool find_events(arc_search *arc_search, load_path *path, double arc, signature before)
{
    const signature after = signature_at(arc_search, arc_search->increment);
    const bool is_limit = before.course != after.course;
    const int changes = abs(after.negative_pivots - before.negative_pivots);
    if (!is_limit && changes == 0)
        return true;
    const double load_factor = arc_search->load_factor;
    double *kept = malloc(arc_search->entries * sizeof *kept);
    if (!kept)
        return false;
    memcpy(kept, arc_search->increment, arc_search->entries * sizeof *kept);
    arc_contact_keep(&arc_search->contact);
    if (is_limit)
        path_points_event(path, LOAD_PATH_LIMIT, path->points - 1,
                          locate_critical_point(arc_search, arc, before, LOAD_PATH_LIMIT));
    if (changes > is_limit)
        path_points_event(path, LOAD_PATH_BIFURCATION, path->points - 1,
                          locate_critical_point(arc_search, arc, before, LOAD_PATH_BIFURCATION));
    memcpy(arc_search->increment, kept, arc_search->entries * sizeof *kept);
    free(kept);
    arc_contact_take_back(&arc_search->contact);
    arc_search->load_factor = load_factor;
    return solve_both(arc_search, true);
}

/* ---- path ------------------------------------------------------------- */

/* Step length control of the load path, by the number of iterations of the last steps. */
typedef struct step_control {
    double arc;     /* length of the next step on a load path */
    double longest; /* largest length of a step on a load path: norm of the change of displacement
                       (m) */
    int usual; /* number of linear solves of a step on a load path after which the next step has the
                  same length */
    int before;      /* number of linear solves that the previous step on the load path needed */
    bool is_shorter; /* whether the last change of the length of the steps on a load path was a
                        reduction */
} step_control;

/*
 * Choose the length of the next step on the load path: longer after fewer iterations than
 * control->usual, shorter after more.
 */
static void adapt_length(step_control *control, double arc, int iterations)
{
    /*
     * A shortened step that has not reduced the iterations raises `usual`: with follower loads the
     * tangent is approximate, and shorter steps do not help.
     */
    if (control->is_shorter && iterations >= control->before)
        control->usual = iterations > control->usual ? iterations : control->usual;
    const double ratio = fmin(2, fmax(0.5, sqrt((double)control->usual / iterations)));
    control->is_shorter = ratio < 1;
    control->before = iterations;
    control->arc = fmin(control->longest, arc * ratio);
}

/*
 * Compute the next point of the load path, and the critical points before it. The step ends at the
 * full load if that comes first.
 *   arc        in/out  length of the step: wanted, then made
 *   iterations out     number of linear solves without those of the search for critical points
 * Returns false if the step fails.
 */
static bool find_point(arc_search *arc_search, load_path *path, double *arc, int *iterations)
{
    const signature before = signature_at(arc_search, arc_search->direction);
    double length = *arc;
    if (!try_step(arc_search, length))
        return false;
    if (arc_search->load_factor >= 1 && !land_at_full_load(arc_search, &length))
        return false;
    *iterations = arc_search->iterations;
    *arc = length;
    return find_events(arc_search, path, length, before);
}

/*
 * Make all steps of the load path. The first step is as long as the linear displacement under a
 * twentieth of the load, and no step is longer than four times that. A step that fails is halved.
 */
static void take_steps(arc_search *arc_search, analysis *analysis, load_path *path)
{
    const double first =
        sqrt(scalar_product(arc_search, arc_search->by_load, arc_search->by_load)) / 20;
    step_control control = {first, 4 * first, 5, 0, false};
    memcpy(arc_search->direction, arc_search->by_load,
           arc_search->entries * sizeof *arc_search->direction);
    while (path->points < LOAD_PATH_POINTS && arc_search->start_factor < 1 &&
           control.arc > first / 1024) {
        int iterations;
        const int events = path->events;
        double arc = control.arc;
        arc_search->iterations = 0;
        const bool is_found = find_point(arc_search, path, &arc, &iterations);
        path->linear_solves += arc_search->iterations;
        if (!is_found) {
            path->events = events;
            control.arc /= 2;
            control.is_shorter = false;
            if (!restore_start(arc_search))
                return;
            continue;
        }
        accept_point(arc_search);
        path_points_add(path, analysis, arc_search->start_factor, arc_search->iterations);
        adapt_length(&control, arc, iterations);
    }
}

/* Make the last point of the load path the equilibrium from which the solver continues. */
static void continue_from_end(arc_search *arc_search)
{
    pzs_solver *solver = arc_search->solver;
    const double *voltage = arc_search->start + arc_search->free_dof;
    memset(arc_search->increment, 0, arc_search->entries * sizeof *arc_search->increment);
    arc_search->load_factor = arc_search->start_factor;
    set_point(arc_search);
    memcpy(solver->state.converged_displacement, solver->state.displacement,
           arc_search->free_dof * sizeof *solver->state.displacement);
    memcpy(solver->state.converged_input_value, solver->state.input_value,
           solver->state.model->state.structure->input.count * sizeof *solver->state.input_value);
    for (size_t k = 0; k < open_electrodes(arc_search); k++) {
        arc_search->circuit->state.voltage[k] = voltage[k];
        arc_search->circuit->state.converged_voltage[k] = voltage[k];
    }
    solver->settings.extrapolated_iterations = 0;
}

static int refuse(const analysis *analysis, const char *reason, char *error)
{
    return scene_fault(analysis->design.at, error, "--path%s", reason);
}

/*
 * Compute the load path by the arc-length method and append its points to an empty path. *reached
 * is the load factor of the last point. Returns 0, or -1 with error filled.
 */
static int follow_arcs(load_path *path, analysis *analysis, double *reached, char *error)
{
    arc_search arc_search;
    if (arc_open(&arc_search, analysis) < 0)
        return refuse(analysis, ": out of memory", error);
    if (!solve_both(&arc_search, true) ||
        !(scalar_product(&arc_search, arc_search.by_load, arc_search.by_load) > 0)) {
        arc_close(&arc_search);
        return refuse(analysis, ": the scene has no load, or its reference state is not stiff",
                      error);
    }
    path_points_add(path, analysis, 0, arc_search.iterations);
    take_steps(&arc_search, analysis, path);
    continue_from_end(&arc_search);
    *reached = arc_search.start_factor;
    path->status = arc_search.contact.refused;
    arc_close(&arc_search);
    return 0;
}

/*
 * Fill `error` with the fraction of the full load at which a load path ends, and with the most
 * likely cause.
 */
static void explain_end(const load_path *path, const analysis *analysis, double reached,
                        char *error)
{
    char cause[PATH_CAUSE_BYTES];
    path_cause(path, analysis, cause);
    scene_fault(analysis->design.at, error,
                "the load path ends at %.4g of the load after %d points; %s", reached, path->points,
                cause);
}

int load_path_follow(load_path *path, analysis *analysis, char *error)
{
    const design *design = &analysis->design;
    const bool is_stepped = design->mesh.prescribed_count > 0 || !arc_contact_fits(analysis);
    double reached = 0;
    memset(path, 0, sizeof *path);
    if (!analysis->equilibrium.full_input)
        return refuse(analysis, " needs kinematics: nonlinear (or auto)", error);
    if (path_points_open(path, analysis, error) < 0)
        return -1;
    analysis->is_nonlinear = true;
    pzs_solver_reset(&analysis->equilibrium.solver);
    const int failed = is_stepped ? stepped_path_follow(path, analysis, &reached, error)
                                  : follow_arcs(path, analysis, &reached, error);
    if (failed)
        return -1;
    path->is_complete = reached >= 1;
    if (!path->is_complete)
        explain_end(path, analysis, reached, error);
    return 0;
}
