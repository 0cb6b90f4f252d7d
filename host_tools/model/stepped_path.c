/* SPDX-License-Identifier: BSD-2-Clause */
/* Computation of a load path in equal steps of the load factor (stepped_path.h). */
#include "stepped_path.h"
#include <stdlib.h>
#include <string.h>
#include "path_points.h"

/*
 * Computation of a load path in equal steps of the load factor: buffers for input values and for
 * states of the equilibrium solver.
 */
typedef struct step_search {
    analysis *analysis;
    double *value; /* [inputs] input values of the scene at the present load factor */
    void *before;  /* state of the equilibrium solver at a point of the load path before the present
                      one, of the size that equilibrium_state_bytes returns */
    void *after;   /* state of the equilibrium solver at the last computed point of the load path */
} step_search;

/*
 * Compute the equilibrium at a load factor, from the last equilibrium of the solver. Returns the
 * status of the solver.
 */
static pzs_status reach_factor(const step_search *search, double load_factor)
{
    equilibrium *equilibrium = &search->analysis->equilibrium;
    const uint32_t inputs = search->analysis->design.structure.input.count;
    for (uint32_t j = 0; j < inputs; j++)
        search->value[j] = load_factor * equilibrium->full_input[j];
    return pzs_equilibrium(&equilibrium->solver, search->value);
}

/*
 * Load factor at which the number of negative pivots changes between two load factors, by bisection
 * from the saved state at the lower one. The state of the equilibrium solver is overwritten.
 *   negative_pivots in  number of negative pivots at the lower load factor
 */
static double locate_change(const step_search *search, double low, double high,
                            uint32_t negative_pivots)
{
    enum { BISECTIONS = 10 };
    equilibrium *equilibrium = &search->analysis->equilibrium;
    for (int i = 0; i < BISECTIONS; i++) {
        const double middle = (low + high) / 2;
        equilibrium_restore(equilibrium, search->before);
        if (PZS_IS_ERROR(reach_factor(search, middle)))
            return high;
        if (equilibrium->solver.info.negative_pivots == negative_pivots) {
            equilibrium_save(equilibrium, search->before);
            low = middle;
        } else
            high = middle;
    }
    return high;
}

/*
 * Append a change of stability to the load path if the last step from `low` to `high` has changed
 * the number of negative pivots.
 */
static void find_change(const step_search *search, load_path *path, double low, double high,
                        uint32_t negative_pivots)
{
    equilibrium *equilibrium = &search->analysis->equilibrium;
    if (equilibrium->solver.info.negative_pivots == negative_pivots)
        return;
    equilibrium_save(equilibrium, search->after);
    const double load_factor = locate_change(search, low, high, negative_pivots);
    path_points_event(path, search->analysis, LOAD_PATH_STABILITY, path->points - 2, load_factor);
    equilibrium_restore(equilibrium, search->after);
}

/*
 * Make all steps of the load path, each of an equal part of the full load. Where a step fails, the
 * last equilibrium within the step is the last point of the path. Returns the load factor there.
 */
static double take_steps(const step_search *search, load_path *path, int parts)
{
    equilibrium *equilibrium = &search->analysis->equilibrium;
    const pzs_solver_info *info = &equilibrium->solver.info;
    double reached = 0;
    for (int i = 1; i <= parts; i++) {
        const double start = reached;
        const uint32_t negative_pivots = info->negative_pivots;
        equilibrium_save(equilibrium, search->before);
        path->status = reach_factor(search, (double)i / parts);
        const bool has_converged = !PZS_IS_ERROR(path->status);
        path->linear_solves += (int)info->linear_solves;
        reached = has_converged ? (double)i / parts : start + info->load_factor / parts;
        if (reached > start) {
            path_points_add(path, search->analysis, reached, (int)info->linear_solves);
            find_change(search, path, start, reached, negative_pivots);
        }
        if (!has_converged)
            break;
    }
    return reached;
}

int stepped_path_follow(load_path *path, analysis *analysis, double *reached, char *error)
{
    enum { FEWEST_PARTS = 20 };
    equilibrium *equilibrium = &analysis->equilibrium;
    pzs_solver *solver = &equilibrium->solver;
    const size_t bytes = equilibrium_state_bytes(equilibrium);
    const uint16_t load_steps = solver->settings.load_steps;
    const int wanted = load_steps > FEWEST_PARTS ? load_steps : FEWEST_PARTS;
    const int parts = wanted < LOAD_PATH_POINTS ? wanted : LOAD_PATH_POINTS - 1;
    step_search search = {analysis,
                          calloc(analysis->design.structure.input.count + 1u, sizeof(double)),
                          malloc(bytes), malloc(bytes)};
    const bool has_memory = search.value && search.before && search.after;
    path->has_equal_steps = true;
    if (has_memory) {
        path_points_add(path, analysis, 0, 0);
        solver->settings.load_steps = 1;
        *reached = take_steps(&search, path, parts);
        solver->settings.load_steps = load_steps;
    }
    free(search.value);
    free(search.before);
    free(search.after);
    return has_memory ? 0 : scene_fault(analysis->design.at, error, "out of memory");
}
