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
        if (!arc_restore(arc_search) || !arc_try_step(arc_search, middle))
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
    if (!arc_try_step(arc_search, length))
        return false;
    if (arc_search->load_factor >= 1 && !arc_land_at_full_load(arc_search, &length))
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
        sqrt(arc_product(arc_search, arc_search->by_load, arc_search->by_load)) / 20;
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
            if (!arc_restore(arc_search))
                return;
            continue;
        }
        arc_accept(arc_search);
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
 * is the load factor of the last point. Returns 0, or -1 with error filled.
 */
static int follow_arcs(load_path *path, analysis *analysis, double *reached, char *error)
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
