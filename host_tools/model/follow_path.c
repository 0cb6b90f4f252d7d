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
#include "../../lib/model/model.h"
#include "../../lib/nonlinear/nonlinear.h"

/* ---- state ------------------------------------------------------------ */

/*
 * State of the arc-length method. All vectors have free_dof entries. A point of the load path
 * consists of a displacement and a load factor; `direction` is the increment of the last step,
 * which distinguishes forwards from backwards.
 */
typedef struct walk {
    pzs_solver *solver;
    const double *full; /* [inputs] input values of the scene at full load */
    size_t n;
    double *memory;
    double *metric; /* [free_dof] weight of each dof in the norm of a displacement: 1 for the means
                       of both faces' displacements, thickness^2 for the other dof */
    double *start;  /* [free_dof] displacement at the last converged point of the load path */
    double *direction;   /* [free_dof] increment of the displacement in the last converged step */
    double *increment;   /* [free_dof] displacement since the last converged point */
    double *by_residual; /* [free_dof] inverse tangent stiffness times (load minus internal force)
                          */
    double *by_load;    /* [free_dof] inverse tangent stiffness times the force per unit of the load
                           factor */
    double *unit;       /* [free_dof] nodal forces per unit of one input */
    double load_factor; /* load factor at the present point of the load path */
    double start_factor; /* load factor at the last converged point of the load path */
    int iterations;
} walk;

static double inner(const walk *walk, const double *first, const double *second)
{
    double sum = 0;
    for (size_t i = 0; i < walk->n; i++)
        sum += walk->metric[i] * first[i] * second[i];
    return sum;
}

static void fill_metric(walk *walk)
{
    const pzs_structure *structure = walk->solver->state.model->state.structure;
    const double thickness = structure->type[0].thickness;
    for (uint32_t i = 0; i < (uint32_t)structure->nodes * structure->dof_per_node; i++)
        if (structure->node_dof[i] != PZS_CONSTRAINED)
            walk->metric[structure->node_dof[i]] =
                i % structure->dof_per_node < 3 ? 1 : thickness * thickness;
}

/* Allocate the vectors of the arc-length method. Returns 0, or -1 where memory runs out. */
static int walk_open(walk *walk, analysis *analysis)
{
    memset(walk, 0, sizeof *walk);
    walk->solver = &analysis->equilibrium.solver;
    walk->full = analysis->equilibrium.full_input;
    walk->n = (size_t)analysis->design.mesh.free_dof;
    double **const vector[] = {&walk->metric,    &walk->start,       &walk->direction,
                               &walk->increment, &walk->by_residual, &walk->by_load,
                               &walk->unit};
    const size_t vectors = sizeof vector / sizeof *vector;
    walk->memory = calloc(vectors * walk->n, sizeof *walk->memory);
    if (!walk->memory)
        return -1;
    for (size_t i = 0; i < vectors; i++)
        *vector[i] = walk->memory + i * walk->n;
    fill_metric(walk);
    return 0;
}

/* ---- one linear solve ------------------------------------------------- */

/*
 * Set the solver to the displacement of the last converged point plus the present increment, at the
 * present load factor.
 */
static void set_point(walk *walk)
{
    pzs_solver *solver = walk->solver;
    const uint32_t inputs = solver->state.model->state.structure->input.count;
    for (size_t i = 0; i < walk->n; i++)
        solver->state.displacement[i] = walk->start[i] + walk->increment[i];
    for (uint32_t j = 0; j < inputs; j++)
        solver->state.input_value[j] = walk->load_factor * walk->full[j];
    pzs_nonlinear_set_prescribed(solver);
}

/* Compute the force per unit of the load factor at the present point and store it in by_load. */
static void full_force(walk *walk)
{
    const uint32_t inputs = walk->solver->state.model->state.structure->input.count;
    memset(walk->by_load, 0, walk->n * sizeof *walk->by_load);
    for (uint32_t j = 0; j < inputs; j++) {
        if (walk->full[j] == 0)
            continue;
        memset(walk->unit, 0, walk->n * sizeof *walk->unit);
        pzs_nonlinear_unit_force(walk->solver, j, walk->unit);
        for (size_t i = 0; i < walk->n; i++)
            walk->by_load[i] += walk->full[j] * walk->unit[i];
    }
}

/*
 * Assemble and factor the tangent stiffness at the present point, and solve for by_residual and
 * by_load. Returns false if the tangent stiffness is singular.
 */
static bool solve_both(walk *walk)
{
    pzs_solver *solver = walk->solver;
    set_point(walk);
    pzs_nonlinear_build(solver, true, walk->by_residual);
    full_force(walk);
    walk->iterations++;
    if (!pzs_nonlinear_factor(solver))
        return false;
    pzs_model_backsolve(solver->state.model, walk->by_residual, walk->by_residual);
    pzs_model_backsolve(solver->state.model, walk->by_load, walk->by_load);
    return pzs_guard_nonfinite(walk->by_load, (uint32_t)walk->n) < 0;
}

/* ---- one step --------------------------------------------------------- */

/*
 * Change of the load factor that keeps the length of the increment of the displacement at `arc`.
 * The vectors by_residual and by_load are the changes of displacement by the residual forces and
 * per unit of the load factor; of the two solutions of |increment + by_residual + change by_load|^2
 * = arc^2, the one that turns the increment less is returned, or NAN where there is none.
 */
static double constrained_change(const walk *walk, double arc)
{
    const double *load = walk->by_load, *residual = walk->by_residual, *increment = walk->increment;
    const double load2 = inner(walk, load, load);
    const double half = inner(walk, increment, load) + inner(walk, residual, load);
    const double rest = inner(walk, increment, increment) + 2 * inner(walk, increment, residual) +
                        inner(walk, residual, residual) - arc * arc;
    const double root = sqrt(half * half - load2 * rest);
    const double along = inner(walk, increment, load); /* scalar product of the increment and the
                                                          change of displacement per unit of the
                                                          load factor; its sign decides which of the
                                                          two solutions turns the increment less */
    return (-half + (along < 0 ? -root : root)) / load2;
}

/*
 * Correct the increment until it leads to an equilibrium at the distance `arc` from the last
 * converged point. Returns whether the iteration has converged.
 */
static bool correct(walk *walk, double arc)
{
    enum { CORRECTIONS = 12 };
    const double tolerance = 1e-8;
    for (int i = 0; i < CORRECTIONS; i++) {
        if (!solve_both(walk))
            return false;
        const double change = constrained_change(walk, arc);
        if (!isfinite(change))
            return false;
        double moved2 = 0;
        for (size_t k = 0; k < walk->n; k++) {
            const double by = walk->by_residual[k] + change * walk->by_load[k];
            walk->increment[k] += by;
            moved2 += walk->metric[k] * by * by;
        }
        walk->load_factor += change;
        if (moved2 <= tolerance * tolerance * arc * arc)
            return true;
    }
    return false;
}

/* Sign of the change of the load factor that continues in the direction of the last step. */
static double forwards(const walk *walk)
{
    return inner(walk, walk->direction, walk->by_load) < 0 ? -1 : 1;
}

/*
 * Return to the last converged point and compute its tangent stiffness. Returns whether this has
 * succeeded.
 */
static bool go_back(walk *walk)
{
    memset(walk->increment, 0, walk->n * sizeof *walk->increment);
    walk->load_factor = walk->start_factor;
    return solve_both(walk);
}

/*
 * Make one step of length `arc` from the last converged point, whose tangent stiffness has been
 * factored. Returns whether the step has converged; then by_load and the pivots belong to the new
 * point, and `start` is still the old point.
 */
static bool try_step(walk *walk, double arc)
{
    const double change = forwards(walk) * arc / sqrt(inner(walk, walk->by_load, walk->by_load));
    for (size_t i = 0; i < walk->n; i++)
        walk->increment[i] = change * walk->by_load[i];
    walk->load_factor = walk->start_factor + change;
    return correct(walk, arc) && solve_both(walk);
}

/*
 * Make the present point of the load path the last converged point, from which the next step
 * starts.
 */
static void accept(walk *walk)
{
    for (size_t i = 0; i < walk->n; i++) {
        walk->direction[i] = walk->increment[i];
        walk->start[i] += walk->increment[i];
        walk->increment[i] = 0;
    }
    walk->start_factor = walk->load_factor;
}

/* ---- critical points -------------------------------------------------- */

/*
 * Quantities whose change between two points shows a critical point between them: the sign of the
 * change of the load factor and the number of negative pivots.
 */
typedef struct signature {
    double course; /* sign of the change of the load factor along the path */
    int negative_pivots;
} signature;

/*
 * Signature of the present point of the load path, by which critical points are recognised: sign of
 * the change of the load factor and number of negative pivots.
 *   along [free_dof] in  an increment of the displacement in the direction of the path
 */
static signature signature_at(const walk *walk, const double *along)
{
    return (signature){inner(walk, along, walk->by_load) < 0 ? -1.0 : 1.0,
                       (int)walk->solver->info.negative_pivots};
}

static bool differs(signature first, signature second, load_path_event_type type)
{
    return type == LOAD_PATH_LIMIT ? first.course != second.course
                                   : first.negative_pivots != second.negative_pivots;
}

/*
 * Load factor of the critical point between the last converged point and a point at the distance
 * `arc`, by bisection of the distance. The critical point is where the signature changes: the sign
 * of the change of the load factor and the number of negative pivots. The present point is
 * overwritten.
 */
static double locate(walk *walk, double arc, signature before, load_path_event_type type)
{
    enum { BISECTIONS = 14 };
    double low = 0, high = arc, load_factor = walk->load_factor;
    for (int i = 0; i < BISECTIONS; i++) {
        const double middle = (low + high) / 2;
        if (!go_back(walk) || !try_step(walk, middle))
            return load_factor;
        load_factor = walk->load_factor;
        if (differs(before, signature_at(walk, walk->increment), type))
            high = middle;
        else
            low = middle;
    }
    return load_factor;
}

static void add_event(load_path *path, load_path_event_type type, double load_factor)
{
    if (path->events < LOAD_PATH_EVENTS)
        path->event[path->events++] = (load_path_event){type, path->points - 1, load_factor};
}

/*
 * Add the critical points within a step of length `arc` that has just converged to the path. A
 * limit point changes the sign of one pivot; further sign changes are bifurcations. Returns whether
 * the end of the step could be restored.
 */
static bool find_events(walk *walk, load_path *path, double arc, signature before)
{
    const signature after = signature_at(walk, walk->increment);
    const bool is_limit = before.course != after.course;
    const int changes = abs(after.negative_pivots - before.negative_pivots);
    if (!is_limit && changes == 0)
        return true;
    const double load_factor = walk->load_factor;
    double *kept = malloc(walk->n * sizeof *kept);
    if (!kept)
        return false;
    memcpy(kept, walk->increment, walk->n * sizeof *kept);
    if (is_limit)
        add_event(path, LOAD_PATH_LIMIT, locate(walk, arc, before, LOAD_PATH_LIMIT));
    if (changes > is_limit)
        add_event(path, LOAD_PATH_BIFURCATION, locate(walk, arc, before, LOAD_PATH_BIFURCATION));
    memcpy(walk->increment, kept, walk->n * sizeof *kept);
    free(kept);
    walk->load_factor = load_factor;
    return solve_both(walk);
}

/* ---- path ------------------------------------------------------------- */

static void add_point(load_path *path, const walk *walk)
{
    const pzs_solver *solver = walk->solver;
    path->point[path->points] =
        (load_path_point){walk->start_factor, (int)solver->info.negative_pivots, walk->iterations};
    pzs_observe(solver->state.model->state.structure, walk->start,
                path->value + (size_t)path->points * (size_t)path->rows);
    path->points++;
}

/*
 * Length of the next step: longer after few iterations, shorter after many, and never above
 * `longest`.
 */
static double next_arc(double arc, int iterations, double longest)
{
    const double usual = 5;
    return fmin(longest, arc * fmin(2, fmax(0.5, sqrt(usual / iterations))));
}

/*
 * Make all steps of the load path. The first step is as long as the linear displacement under a
 * twentieth of the load, and no step is longer than four times that.
 */
static void take_steps(walk *walk, load_path *path)
{
    const double first = sqrt(inner(walk, walk->by_load, walk->by_load)) / 20;
    double arc = first;
    memcpy(walk->direction, walk->by_load, walk->n * sizeof *walk->direction);
    while (path->points < LOAD_PATH_POINTS && walk->start_factor < 1 && arc > first / 1024) {
        const signature before = signature_at(walk, walk->direction);
        walk->iterations = 0;
        if (!try_step(walk, arc) || !find_events(walk, path, arc, before)) {
            path->linear_solves += walk->iterations;
            arc /= 2;
            if (!go_back(walk))
                return;
            continue;
        }
        path->linear_solves += walk->iterations;
        accept(walk);
        add_point(path, walk);
        arc = next_arc(arc, walk->iterations, 4 * first);
    }
}

/* Make the last point of the path the equilibrium from which the solver continues. */
static void hand_over(walk *walk)
{
    pzs_solver *solver = walk->solver;
    memset(walk->increment, 0, walk->n * sizeof *walk->increment);
    walk->load_factor = walk->start_factor;
    set_point(walk);
    memcpy(solver->state.converged_displacement, solver->state.displacement,
           walk->n * sizeof *solver->state.displacement);
    memcpy(solver->state.converged_input_value, solver->state.input_value,
           solver->state.model->state.structure->input.count * sizeof *solver->state.input_value);
    solver->settings.extrapolated_iterations = 0;
}

/*
 * Refuse scenes for which the arc-length method is not implemented: contact, prescribed
 * displacements, open electrodes. Returns 0, or -1 with error filled.
 */
static int check_scene(const analysis *analysis, char *error)
{
    const scene *scene = analysis->design.scene;
    const char *reason = NULL;
    if (!analysis->equilibrium.full_input)
        reason = "needs kinematics: nonlinear (or auto)";
    else if (scene->contact.given)
        reason = "does not follow contact; use equilibrium.load_steps";
    else if (analysis->design.mesh.prescribed_count > 0)
        reason = "does not follow prescribed displacements, which pass limit points by themselves; "
                 "use equilibrium.load_steps";
    else if (analysis->equilibrium.circuit_work)
        reason = "does not follow open electrodes";
    return reason ? scene_fault(scene, scene->at_surface, error, "--path %s", reason) : 0;
}

int load_path_follow(load_path *path, analysis *analysis, char *error)
{
    walk walk;
    memset(path, 0, sizeof *path);
    if (check_scene(analysis, error) < 0)
        return -1;
    const scene *scene = analysis->design.scene;
    path->rows = (int)analysis->design.structure.output.count;
    path->value = calloc((size_t)LOAD_PATH_POINTS * ((size_t)path->rows + 1), sizeof *path->value);
    pzs_solver_reset(&analysis->equilibrium.solver);
    if (!path->value || walk_open(&walk, analysis) < 0)
        return scene_fault(scene, scene->at_surface, error, "out of memory");
    if (!solve_both(&walk) || !(inner(&walk, walk.by_load, walk.by_load) > 0)) {
        free(walk.memory);
        return scene_fault(scene, scene->at_surface, error,
                           "--path: the scene has no load, or its reference state is not stiff");
    }
    add_point(path, &walk);
    take_steps(&walk, path);
    hand_over(&walk);
    path->is_complete = walk.start_factor >= 1;
    if (!path->is_complete)
        scene_fault(scene, scene->at_surface, error,
                    "the load path ends at %.4g of the load after %d points", walk.start_factor,
                    path->points);
    free(walk.memory);
    return 0;
}
