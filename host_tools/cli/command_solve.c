/* SPDX-License-Identifier: BSD-2-Clause */
/* The command `pzs solve`: displacements, forces and voltages of a structure under its loads
 * (command_solve.h). */
#include "command_solve.h"
#include <math.h>
#include <stdlib.h>
#include "../model/follow_path.h"
#include "../system/progress.h"
#include "command_parts.h"
#include "export.h"
#include "print_solve.h"
#include "print_path.h"

/*
 * Solution of a scene under its loads: displacement vector [free_dof], the values of all outputs of
 * the scene computed from it, and the stresses recovered from it, or NULL where the user has not
 * asked for them.
 */
typedef struct solution {
    const analysis *analysis;
    const double *displacement, *value;
    const stress_field *stress;
} solution;

static int write_solve(const report_job *job, const void *result)
{
    const solution *solution = result;
    return report_solve(job, solution->analysis, solution->displacement, solution->value,
                        solution->stress);
}

/* Estimate the discretisation error of the outputs. Returns an exit code. */
static int solve_error(const options *options, analysis *analysis, const double *value)
{
    mesh_values values = {.count = 0};
    mesh_values_add_outputs(&values, analysis, value);
    return estimate_error(options, analysis->design.scene, &values,
                          options->follows_path ? mesh_measure_path : mesh_measure_solve,
                          &options->branch, &analysis->mesh_error);
}

/*
 * Add plausibility warnings where the equilibrium is unstable or depends on the number of load
 * steps.
 */
static void check_path(analysis *analysis, const double *displacement)
{
    const int is_followed = analysis->load_path.points > 0;
    const int is_reached = !PZS_IS_ERROR(analysis->status);
    progress_stage("load path");
    double difference = (double)NAN, load_factor = 1;
    if (is_reached && !is_followed)
        difference = analysis_path_difference(analysis, displacement, &load_factor);
    plausible_path(&analysis->warnings, analysis->design.scene, difference, load_factor,
                   analysis->equilibrium.solver.info.negative_pivots);
}

/*
 * Print the displacements, forces and voltages of a structure under its loads (command solve) and
 * write them to the files that the options name. Returns an exit code.
 */
static int write_solution(const options *options, analysis *analysis, solution *result)
{
    int status = 0;
    (options->as_json ? print_solve_json : print_solve)(analysis, result->displacement,
                                                        result->value, result->stress);
    if (options->vtu)
        status = write_vtu(&(vtk_solution){.analysis = result->analysis,
                                           .displacement = result->displacement,
                                           .voltage = result->analysis->input_value,
                                           .stress = result->stress},
                           options->vtu);
    if (status == 0)
        status = write_reports(options, write_solve, result);
    return status == 0 ? export_solve(options, analysis, result->displacement, result->value,
                                      result->stress)
                       : status;
}

/*
 * Compute the stresses that belong to a displacement of the structure, and write the result of `pzs
 * solve` with both, the displacement and the stresses.
 */
static int write_stressed(const options *options, analysis *analysis, solution *result)
{
    stress_field field;
    int status = analysis_stresses(analysis, result->displacement, &field) < 0
                     ? complain("out of memory", 1)
                     : 0;
    result->stress = &field;
    if (status == 0)
        plausible_stress(&analysis->warnings, &field);
    if (status == 0)
        status = write_solution(options, analysis, result);
    stress_free(&field);
    return status;
}

static int solved(const options *options, analysis *analysis, const double *displacement)
{
    const pzs_structure *structure = &analysis->design.structure;
    double *value = calloc((size_t)structure->output.count + 1, sizeof *value);
    solution result = {analysis, displacement, value, NULL};
    if (!value)
        return complain("out of memory", 1);
    pzs_observe(structure, displacement, value);
    plausible_result(&analysis->warnings, &analysis->design.mesh, displacement,
                     !analysis->is_nonlinear, "the solution");
    if (analysis->is_nonlinear)
        check_path(analysis, displacement);
    int status = solve_error(options, analysis, value);
    progress_stop();
    if (status == 0)
        status = (options->recovers_stress ? write_stressed : write_solution)(options, analysis,
                                                                              &result);
    free(value);
    return status;
}

/*
 * Compute the displacement of the scene, along the load path where the options ask for it. Returns
 * 0, or an exit code after printing an error message.
 */
static int solve_scene(const options *options, analysis *analysis, double *displacement)
{
    char error[SCENE_ERROR];
    if (!options->follows_path)
        return analysis_solve(analysis, displacement, error) == 0 ? 0 : complain(error, 1);
    if (load_path_follow_branch(&analysis->load_path, analysis, options->branch, error) < 0)
        return complain(error, OPTIONS_WRONG);
    if (!analysis->load_path.is_complete) {
        progress_stop();
        (options->as_json ? print_ended_path_json : print_load_path)(analysis,
                                                                     &analysis->load_path);
        return complain(error, 1);
    }
    return analysis_continue(analysis, displacement, error) == 0 ? 0 : complain(error, 1);
}

int command_solve(const options *options, analysis *analysis)
{
    char error[SCENE_ERROR];
    if (analysis_needs_structure(analysis, "pzs solve", error) < 0)
        return complain(error, OPTIONS_WRONG);
    double *displacement = calloc((size_t)analysis->design.mesh.free_dof, sizeof *displacement);
    progress_stage(analysis->is_nonlinear ? "equilibrium" : "solving");
    progress_solves(analysis->is_nonlinear ? &analysis->equilibrium.solver.info.linear_solves
                                           : NULL);
    const int failed =
        displacement ? solve_scene(options, analysis, displacement) : complain("out of memory", 1);
    /* Nonlinear load steps that end early still provide an equilibrium, which is printed. */
    const int has_shape = !failed || (analysis->is_nonlinear && !options->follows_path);
    const int status = displacement && has_shape ? solved(options, analysis, displacement) : 0;
    free(displacement);
    return failed ? failed : status;
}
