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
#include "arc_search.h"
#include "path_branch.h"
#include "path_cause.h"
#include "path_points.h"
#include "stepped_path.h"

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
    return (signature){arc_product(arc_search, along, arc_search->by_load) < 0 ? -1.0 : 1.0,
                       (int)arc_search->solver->info.negative_pivots};
}

static bool differs(signature first, signature second, load_path_event_type type)
{
    return type == LOAD_PATH_LIMIT ? first.course != second.course
                                   : first.negative_pivots != second.negative_pivots;
}

/*
 * Locate the critical point between the last converged point and a point at the distance *arc, by
 * bisection of the distance. At the critical point the signature changes: the sign of the change of
 * the load factor and the number of negative pivots. The present point is overwritten.
 *   arc in   a distance that lies beyond the critical point
 *       out  distance of the critical point, rounded up to the last interval of the bisection
 * Returns the load factor of the critical point.
 */
static double locate_critical_point(arc_search *arc_search, double *arc, signature before,
                                    load_path_event_type type)
{
    enum { BISECTIONS = 14 };
    double low = 0, load_factor = arc_search->load_factor;
    for (int i = 0; i < BISECTIONS; i++) {
        const double middle = (low + *arc) / 2;
        if (!arc_restore(arc_search) || !arc_try_step(arc_search, middle))
            return load_factor;
        load_factor = arc_search->load_factor;
        if (differs(before, signature_at(arc_search, arc_search->increment), type))
            *arc = middle;
        else
            low = middle;
    }
    return load_factor;
}

/*
 * Locate the critical point of a given type (limit point or bifurcation) within the last step of
 * length `arc`, and append it to the list of critical points of the load path. `before` is the
 * signature at the start of the step.
 */
static void add_event(arc_search *arc_search, analysis *analysis, load_path *path, double arc,
                      signature before, load_path_event_type type)
{
    const double load_factor = locate_critical_point(arc_search, &arc, before, type);
    path_points_event(path, analysis, type, path->points - 1, load_factor);
}

/*
 * Find the critical points within a step of length `arc` that has just converged, and append them
 * to the path: one pivot of the tangent stiffness changes its sign at a limit point, others at
 * bifurcations. Returns whether the solver could return to the end of the step.
 */
static bool find_events(arc_search *arc_search, analysis *analysis, load_path *path, double arc,
                        signature before)
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
        add_event(arc_search, analysis, path, arc, before, LOAD_PATH_LIMIT);
    if (changes > is_limit)
        add_event(arc_search, analysis, path, arc, before, LOAD_PATH_BIFURCATION);
    memcpy(arc_search->increment, kept, arc_search->entries * sizeof *kept);
    free(kept);
    arc_contact_take_back(&arc_search->contact);
    arc_search->load_factor = load_factor;
    return arc_solve(arc_search, true);
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
     * If a shorter step has not needed fewer iterations than the one before, raise `usual`, the
     * number of iterations at which the length of the steps stays the same. Steps would otherwise
     * become shorter and shorter in vain: with follower loads the tangent is approximate.
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
static bool find_point(arc_search *arc_search, analysis *analysis, load_path *path, double *arc,
                       int *iterations)
{
    const signature before = signature_at(arc_search, arc_search->direction);
    double length = *arc;
    if (!arc_try_step(arc_search, length))
        return false;
    if (arc_search->load_factor >= 1 && !arc_land_at_full_load(arc_search, &length))
        return false;
    *iterations = arc_search->iterations;
    *arc = length;
    return find_events(arc_search, analysis, path, length, before);
}

/* Return the number of bifurcations that have been found on a load path. */
static int bifurcations(const load_path *path)
{
    int count = 0;
    for (int i = 0; i < path->events; i++)
        count += path->event[i].type == LOAD_PATH_BIFURCATION;
    return count;
}

/* Make the present equilibrium a point of the load path, from which the next step starts. */
static void add_point(arc_search *arc_search, analysis *analysis, load_path *path)
{
    arc_accept(arc_search);
    path_points_add(path, analysis, arc_search->start_factor, arc_search->iterations);
}

/*
 * Leave the load path at the bifurcation within the step that was made last, and append the
 * bifurcation and the first point of the branch to the path.
 *   branch  in   number of the bifurcation. Positive: leave along its mode; negative: opposite to
 *       it
 *   control in   length of the step that passed the bifurcation
 *           out  length of the next step
 * Returns whether a point of the branch was found.
 */
static bool enter_branch(arc_search *arc_search, analysis *analysis, load_path *path, int branch,
                         step_control *control)
{
    double arc = control->arc, longest;
    arc_search->iterations = 0;
    if (!arc_restore(arc_search))
        return false;
    const signature before = signature_at(arc_search, arc_search->direction);
    (void)locate_critical_point(arc_search, &arc, before, LOAD_PATH_BIFURCATION);
    if (!arc_restore(arc_search) || !arc_try_step(arc_search, arc))
        return false;
    add_point(arc_search, analysis, path);
    path->branch_point = path->points - 1;
    memcpy(arc_search->origin, arc_search->start, arc_search->entries * sizeof *arc_search->origin);
    path->linear_solves += arc_search->iterations;
    arc_search->iterations = 0;
    if (!arc_solve(arc_search, true) ||
        !path_branch_enter(arc_search, &analysis->design.mesh, branch < 0, &arc, &longest))
        return false;
    path->linear_solves += arc_search->iterations;
    add_point(arc_search, analysis, path);
    *control = (step_control){arc, longest, control->usual, arc_search->iterations, false};
    return true;
}

/*
 * Return whether a branch has come back to the bifurcation at which it began, so that it would
 * repeat itself: the last step, of length `arc`, has both ends nearer than `arc` to this
 * bifurcation.
 */
static bool has_returned(const arc_search *arc_search, const load_path *path, double arc)
{
    double square[2] = {0, 0};
    for (size_t i = 0; i < arc_search->entries; i++) {
        const double end = arc_search->start[i] - arc_search->origin[i];
        const double begin = end - arc_search->direction[i];
        square[0] += arc_search->metric[i] * begin * begin;
        square[1] += arc_search->metric[i] * end * end;
    }
    return path->branch_point > 0 && path->points - path->branch_point > 3 &&
           fmax(square[0], square[1]) < arc * arc;
}

/*
 * Make all steps of the load path. The first step is as long as the linear displacement under a
 * twentieth of the load. No step on the path is longer than four times the first one; a branch has
 * a limit of its own. A step that fails is halved. The path ends at the full load, where a branch
 * returns to its bifurcation, or where the load factor falls below LOWEST.
 *   branch in  number of the bifurcation at which to leave the path; 0: none
 */
static void take_steps(arc_search *arc_search, analysis *analysis, load_path *path, int branch)
{
    enum { LOWEST = -10 };
    const double first =
        sqrt(arc_product(arc_search, arc_search->by_load, arc_search->by_load)) / 20;
    step_control control = {first, 4 * first, 5, 0, false};
    memcpy(arc_search->direction, arc_search->by_load,
           arc_search->entries * sizeof *arc_search->direction);
    while (path->points < LOAD_PATH_POINTS && arc_search->start_factor < 1 &&
           arc_search->start_factor > LOWEST && control.arc > first / 1024 && !path->is_closed) {
        int iterations;
        const int events = path->events;
        double arc = control.arc;
        arc_search->iterations = 0;
        const bool is_found = find_point(arc_search, analysis, path, &arc, &iterations);
        path->linear_solves += arc_search->iterations;
        if (!is_found) {
            path->events = events;
            control.arc /= 2;
            control.is_shorter = false;
            if (!arc_restore(arc_search))
                return;
            continue;
        }
        if (branch != 0 && path->branch_point == 0 && bifurcations(path) >= abs(branch)) {
            control.arc = arc;
            if (!enter_branch(arc_search, analysis, path, branch, &control))
                return;
            continue;
        }
        add_point(arc_search, analysis, path);
        path->is_closed = has_returned(arc_search, path, arc);
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
    arc_set_point(arc_search);
    memcpy(solver->state.converged_displacement, solver->state.displacement,
           arc_search->free_dof * sizeof *solver->state.displacement);
    memcpy(solver->state.converged_input_value, solver->state.input_value,
           solver->state.model->state.structure->input.count * sizeof *solver->state.input_value);
    for (size_t k = 0; k < arc_open_electrodes(arc_search); k++) {
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
 * is the load factor of the last point, `branch` the number of the bifurcation at which to leave
 * the path, 0 for none. Returns 0, or -1 with error filled.
 */
static int follow_arcs(load_path *path, analysis *analysis, int branch, double *reached,
                       char *error)
{
    arc_search arc_search;
    if (arc_open(&arc_search, analysis) < 0)
        return refuse(analysis, ": out of memory", error);
    if (!arc_solve(&arc_search, true) ||
        !(arc_product(&arc_search, arc_search.by_load, arc_search.by_load) > 0)) {
        arc_close(&arc_search);
        return refuse(analysis, ": the scene has no load, or its reference state is not stiff",
                      error);
    }
    path_points_add(path, analysis, 0, arc_search.iterations);
    take_steps(&arc_search, analysis, path, branch);
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
    char cause[PATH_CAUSE_BYTES] = "the branch returns to its bifurcation";
    if (!path->is_closed)
        path_cause(path, analysis, cause);
    scene_fault(analysis->design.at, error,
                "the load path ends at %.4g of the load after %d points; %s", reached, path->points,
                cause);
}

/*
 * Check that a load path has taken the branch that was asked for. Returns 0, or -1 with error
 * filled.
 */
static int check_branch(const load_path *path, const analysis *analysis, int branch, char *error)
{
    const int found = bifurcations(path);
    if (branch == 0 || (path->branch_point > 0 && path->branch_point < path->points - 1))
        return 0;
    if (path->branch_point > 0)
        return scene_fault(analysis->design.at, error,
                           "--branch: no equilibrium near the mode of bifurcation %d", abs(branch));
    return scene_fault(analysis->design.at, error,
                       "--branch %d: the load path has %d bifurcation%s", branch, found,
                       found == 1 ? "" : "s");
}

int load_path_follow_branch(load_path *path, analysis *analysis, int branch, char *error)
{
    const design *design = &analysis->design;
    const bool is_stepped = design->equilibrium.path_in_steps ||
                            design->mesh.prescribed_count > 0 || !arc_contact_fits(analysis);
    double reached = 0;
    memset(path, 0, sizeof *path);
    if (!analysis->equilibrium.full_input)
        return refuse(analysis, " needs kinematics: nonlinear (or auto)", error);
    if (is_stepped && branch != 0)
        return refuse(analysis,
                      " with --branch needs the arc-length method, which takes no prescribed "
                      "displacement, no moved body, no shell held by contact alone, and no "
                      "equilibrium.path: load_steps",
                      error);
    if (path_points_open(path, analysis, error) < 0)
        return -1;
    analysis->is_nonlinear = true;
    pzs_solver_reset(&analysis->equilibrium.solver);
    const int failed = is_stepped ? stepped_path_follow(path, analysis, &reached, error)
                                  : follow_arcs(path, analysis, branch, &reached, error);
    if (failed)
        return -1;
    const bool has_branch = check_branch(path, analysis, branch, error) == 0;
    path->is_complete = reached >= 1 && has_branch;
    if (!path->is_complete && has_branch)
        explain_end(path, analysis, reached, error);
    return 0;
}

int load_path_follow(load_path *path, analysis *analysis, char *error)
{
    return load_path_follow_branch(path, analysis, 0, error);
}
