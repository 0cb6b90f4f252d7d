/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Computation of results whose discretisation error is estimated: outputs, shape errors, natural
 * frequencies (mesh_measure.h).
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "follow_path.h"
#include "loaded.h"
#include "mesh_measure.h"
#include "voltages.h"

const char *const mesh_shape_name = "shape error";

void mesh_values_add(mesh_values *values, const char *name, double value)
{
    if (values->count == MESH_VALUES)
        return;
    snprintf(values->item[values->count].name, SCENE_LABEL, "%s", name);
    values->item[values->count++].value = value;
}

void mesh_values_add_outputs(mesh_values *values, const analysis *analysis, const double *value)
{
    const scene *scene = analysis->design.scene;
    for (int k = 0; k < scene->outputs; k++)
        if (analysis_outputs(analysis, k) == 1)
            mesh_values_add(values, scene->output[k].name, analysis_output(analysis, k, 0, value));
}

int mesh_values_add_influence(mesh_values *values, const analysis *analysis, char *error)
{
    const design *design = &analysis->design;
    const int amplifiers = design->amplifiers;
    double *area = calloc((size_t)design->mesh.nodes, sizeof *area);
    double *square = calloc((size_t)amplifiers + 1, sizeof *square), whole = 0, sum = 0;
    if (!area || !square) {
        free(area);
        free(square);
        return scene_fault(design->at, error, "out of memory");
    }
    mesh_node_areas(&design->mesh, area);
    for (int i = 0; i < design->targets; i++) {
        const double *row = analysis->influence + (size_t)i * design->structure.input.count;
        const double part = area[design->target_node[i]];
        whole += part;
        for (int k = 0; k < amplifiers; k++)
            square[k] += part * row[k] * row[k];
    }
    for (int k = 0; k < amplifiers; k++)
        sum += square[k] / amplifiers;
    mesh_values_add(values, "influence matrix", sqrt(sum / whole));
    for (int k = 0; k < amplifiers && amplifiers <= MESH_COLUMNS; k++)
        mesh_values_add(values, design->amplifier_name[k], sqrt(square[k] / whole));
    free(area);
    free(square);
    return 0;
}

void mesh_mode_name(int mode, char name[SCENE_LABEL])
{
    snprintf(name, SCENE_LABEL, "mode %d", mode + 1);
}

/*
 * Compute the displacement of the structure on one mesh at the end of its load path, or of the
 * branch of its bifurcation `branch`. Returns 0, or -1 with error filled.
 */
static int solve_path(analysis *analysis, int branch, double *displacement, char *error)
{
    if (load_path_follow_branch(&analysis->load_path, analysis, branch, error) < 0 ||
        !analysis->load_path.is_complete)
        return -1;
    return analysis_continue(analysis, displacement, error);
}

/*
 * Compute the displacement of the structure on one mesh, and append the values of the scene's
 * outputs to `values`. Returns 0, or -1 with error filled.
 *   branch in  NULL: the displacement is the result of the scene's load steps. Otherwise it is the
 *       end of the load path, which is left at the bifurcation with this number (0: at none)
 */
static int solve_prepared(analysis *analysis, const int *branch, mesh_values *values, char *error)
{
    const pzs_structure *structure = &analysis->design.structure;
    double *displacement = calloc((size_t)analysis->design.mesh.free_dof, sizeof *displacement);
    double *value = calloc((size_t)structure->output.count + 1, sizeof *value);
    int failed = -1;
    snprintf(error, SCENE_ERROR, "out of memory");
    if (displacement && value)
        failed = branch ? solve_path(analysis, *branch, displacement, error)
                        : analysis_solve(analysis, displacement, error);
    if (!failed) {
        pzs_observe(structure, displacement, value);
        mesh_values_add_outputs(values, analysis, value);
    }
    free(displacement);
    free(value);
    return failed;
}

/*
 * Analyse a scene, and append the values of its outputs to `values`. Returns 0, or -1 with error
 * filled.
 *   branch in  NULL: the displacement is the result of the scene's load steps. Otherwise it is the
 *       end of the load path, which is left at the bifurcation with this number (0: at none)
 */
static int measure_outputs(const scene *scene, const int *branch, mesh_values *values, char *error)
{
    analysis analysis;
    int failed = analysis_prepare(&analysis, scene, error);
    if (!failed)
        failed = solve_prepared(&analysis, branch, values, error);
    analysis_free(&analysis);
    return failed;
}

int mesh_measure_solve(const scene *scene, const void *context, mesh_values *values, char *error)
{
    (void)context;
    return measure_outputs(scene, NULL, values, error);
}

int mesh_measure_path(const scene *scene, const void *context, mesh_values *values, char *error)
{
    return measure_outputs(scene, context, values, error);
}

int mesh_measure_shape(const scene *scene, const void *context, mesh_values *values, char *error)
{
    const common_limits *limits = context;
    analysis analysis;
    voltages result = {.amplifiers = 0};
    int failed = analysis_prepare(&analysis, scene, error);
    analysis.is_nonlinear = scene->kinematics != KINEMATICS_LINEAR;
    if (!failed)
        failed = analysis_influence(&analysis, error);
    if (!failed) {
        failed = voltages_optimum(&analysis, *limits, &result, error);
        if (!failed)
            mesh_values_add(values, mesh_shape_name, result.error);
        if (!failed)
            failed = mesh_values_add_influence(values, &analysis, error);
        voltages_free(&result);
    }
    analysis_free(&analysis);
    return failed;
}

int mesh_measure_modes(const scene *scene, const void *context, mesh_values *values, char *error)
{
    loaded_modes modes;
    const int failed = loaded_modes_open(&modes, scene, context, error);
    for (int i = 0; !failed && i < modes.vibration.count; i++) {
        char name[SCENE_LABEL];
        mesh_mode_name(i, name);
        mesh_values_add(values, name, modes.vibration.frequency[i]);
    }
    loaded_modes_close(&modes);
    return failed;
}
