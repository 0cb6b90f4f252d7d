/* SPDX-License-Identifier: BSD-2-Clause */
/* Recording of the points of a load path (path_points.h). */
#include "path_points.h"
#include "largest_turn.h"
#include "output_calls.h"
#include <stdlib.h>
#include <string.h>

int path_points_open(load_path *path, const analysis *analysis, char *error)
{
    const design *design = &analysis->design;
    memset(path, 0, sizeof *path);
    path->outputs = design->outputs;
    path->value = calloc(LOAD_PATH_POINTS * ((size_t)path->outputs + 1), sizeof *path->value);
    path->event_value =
        calloc(LOAD_PATH_EVENTS * ((size_t)path->outputs + 1), sizeof *path->event_value);
    path->row = calloc((size_t)design->structure.output.count + 1, sizeof *path->row);
    return path->value && path->event_value && path->row
               ? 0
               : scene_fault(design->at, error, "out of memory");
}

/* Return whether one of the scene's outputs is a reaction of supports. */
static bool wants_reactions(const design *design)
{
    bool found = false;
    for (int k = 0; k < design->outputs; k++)
        found |= output_calls_of(&design->output[k])->needs_reactions;
    return found;
}

/*
 * Store three numbers in a point of the load path: the largest angle by which the shell has bent
 * within an element, the largest angle by which it has turned from its undeformed normal (degrees),
 * and the lowest principal strain of its faces, which stays 0 where memory runs out.
 */
static void measure_shape(const mesh *mesh, const double *displacement, load_path_point *point)
{
    face_strains strains = {.lowest = {0, 0, 0}};
    (void)face_strains_find(mesh, displacement, false, &strains);
    point->turn = largest_turn(mesh, displacement, &point->turn_element);
    point->tilt = largest_tilt(mesh, displacement, &point->tilt_node);
    point->compression = strains.lowest;
    point->thickness_strain = face_strain_of_thickness(mesh, displacement, strains.lowest.element);
}

/*
 * Compute the first value of each output of the scene at the present equilibrium of the solver
 * (value [outputs] out).
 */
static void observe(load_path *path, analysis *analysis, double *value)
{
    const pzs_solver *solver = &analysis->equilibrium.solver;
    pzs_observe(&analysis->design.structure, solver->info.displacement, path->row);
    (void)analysis_electrodes(analysis, NULL);
    if (wants_reactions(&analysis->design)) {
        char error[SCENE_ERROR];
        (void)analysis_find_reactions(analysis, solver->info.displacement, error);
    }
    for (int k = 0; k < path->outputs; k++)
        value[k] = analysis_output(analysis, k, 0, path->row);
}

void path_points_add(load_path *path, analysis *analysis, double load_factor, int iterations)
{
    const pzs_solver *solver = &analysis->equilibrium.solver;
    observe(path, analysis, path->value + (size_t)path->points * (size_t)path->outputs);
    load_path_point *point = &path->point[path->points++];
    point->load_factor = load_factor;
    point->negative_pivots = (int)solver->info.negative_pivots;
    point->iterations = iterations;
    measure_shape(&analysis->design.mesh, solver->info.displacement, point);
}

void path_points_event(load_path *path, analysis *analysis, load_path_event_type type, int point,
                       double load_factor)
{
    if (path->events == LOAD_PATH_EVENTS)
        return;
    observe(path, analysis, path->event_value + (size_t)path->events * (size_t)path->outputs);
    path->event[path->events++] = (load_path_event){type, point, load_factor};
}
