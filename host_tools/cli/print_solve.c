/* SPDX-License-Identifier: BSD-2-Clause */
/* Results of `pzs solve` (print_solve.h). */
#include "print_solve.h"
#include <math.h>
#include <stdio.h>
#include "print_head.h"
#include "print_electric.h"
#include "print_mesh_error.h"
#include "print_outputs.h"
#include "print_path.h"
#include "print_reactions.h"
#include "print_springs.h"
#include "print_stress.h"

/*
 * Print the results of the contact with a rigid body: number of load steps that were shortened
 * because of the body, depth of the body between the nodes of an element, and a warning about the
 * last load step.
 */
static void print_contact(const analysis *analysis)
{
    const pzs_solver *run = &analysis->equilibrium.solver;
    const char *unit = analysis->design.units.length;
    const char *space = *unit ? " " : "";
    char where[SCENE_ERROR];
    if (!analysis->design.contact.given)
        return;
    if (run->info.shortened_steps > 0)
        printf("  contact: the body moves far for its size; %u load step%s shortened for it\n",
               run->info.shortened_steps, run->info.shortened_steps == 1 ? "" : "s");
    printf("  contact: the body is at most %.3g%s%s deep between nodes (the sag of elements)\n",
           analysis->equilibrium.contact.info.sag, space, unit);
    if (analysis->status != PZS_W_BEHIND)
        return;
    equilibrium_penetration_text(&analysis->equilibrium, analysis->status, where);
    printf("  WARNING: %s: %s\n", pzs_status_text(analysis->status), where);
}

static void print_path(const analysis *analysis)
{
    const pzs_solver *run = &analysis->equilibrium.solver;
    const char *state = run->info.negative_pivots ? "UNSTABLE" : "stable";
    printf("  %u load step%s, %u linear solves, %s (%u negative pivots)\n", run->info.load_steps,
           run->info.load_steps == 1 ? "" : "s", run->info.linear_solves, state,
           run->info.negative_pivots);
    printf("  settled to %.0e of the displacement (equilibrium.tolerance), solver residual %.1e of "
           "the load\n",
           run->settings.tolerance, run->info.residual);
    print_contact(analysis);
}

/*
 * Print a note on the discretisation error, which the error measures of the solver do not include.
 */
static void print_discretisation(void)
{
    puts("  discretisation error: not part of these figures; --error estimates it\n");
}

void print_solve(analysis *analysis, const double *displacement, const double *value,
                 const stress_field *stress)
{
    print_head(analysis, "at rest");
    if (analysis->design.kinematics == KINEMATICS_AUTO && isfinite(analysis->linear_error))
        printf("  kinematics auto: linear differs by %.3g of the displacement, tolerance %g: %s\n",
               analysis->linear_error, analysis->design.tolerance,
               analysis->is_nonlinear ? "nonlinear is needed" : "linear is enough");
    if (analysis->load_path.points > 0)
        print_load_path(analysis, &analysis->load_path);
    if (analysis->is_nonlinear)
        print_path(analysis);
    else
        printf("  linear solve: solver residual %.1e, solver error estimate %.1e in the energy "
               "norm, %d refinements\n",
               analysis->model.info.residual, analysis->model.info.error_estimate,
               analysis->model.info.refinements);
    print_discretisation();
    for (int k = 0; k < analysis->design.outputs; k++)
        print_output(analysis, k, value);
    print_reactions(analysis);
    print_springs(analysis, displacement);
    print_electrodes(analysis);
    print_bare_faces(analysis);
    print_stress(stress);
    print_mesh_error(&analysis->mesh_error);
}

static void json_path(json *json, const analysis *analysis)
{
    const pzs_solver *run = &analysis->equilibrium.solver;
    json_string(json, "status", pzs_status_text(analysis->status));
    json_number(json, "load_factor", run->info.load_factor);
    json_number(json, "load_steps", run->info.load_steps);
    json_number(json, "steps_shortened", run->info.shortened_steps);
    json_number(json, "linear_solves", run->info.linear_solves);
    json_number(json, "iterations", (double)run->info.linear_solves - run->info.load_steps);
    json_number(json, "residual", run->info.residual);
    json_number(json, "solver_residual", run->info.residual);
    json_number(json, "negative_pivots", run->info.negative_pivots);
}

/*
 * Write status, residual and number of refinement iterations of the linear solve of a structure
 * with linear kinematics as JSON.
 */
static void json_linear(json *json, const analysis *analysis)
{
    json_string(json, "status", pzs_status_text(analysis->status));
    json_number(json, "load_steps", 1);
    json_number(json, "linear_solves", 1);
    json_number(json, "iterations", analysis->model.info.refinements);
    json_number(json, "residual", analysis->model.info.residual);
    json_number(json, "solver_residual", analysis->model.info.residual);
    json_number(json, "negative_pivots", analysis->model.info.negative_pivots);
    json_number(json, "solver_error_estimate", analysis->model.info.error_estimate);
}

/*
 * Write the computation times (s) as JSON. On a nonlinear structure `solve` is the time of all load
 * steps; the stiffness matrix of the reference state is assembled and factored before these load
 * steps.
 */
static void json_seconds(json *json, const analysis *analysis)
{
    json_open(json, "seconds", '{');
    json_number(json, "assemble", analysis->seconds.assemble);
    json_number(json, "factor", analysis->seconds.factor);
    json_number(json, "solve", analysis->seconds.solve);
    json_number(json, "total",
                analysis->seconds.assemble + analysis->seconds.factor + analysis->seconds.solve);
    json_close(json, '}');
}

void print_solve_json(analysis *analysis, const double *displacement, const double *value,
                      const stress_field *stress)
{
    const design *design = &analysis->design;
    json json = {.file = stdout};
    json_open(&json, NULL, '{');
    print_head_json(&json, analysis);
    json_string(&json, "kinematics", analysis->is_nonlinear ? "nonlinear" : "linear");
    if (design->kinematics == KINEMATICS_AUTO)
        json_number(&json, "cost_of_linear", analysis->linear_error);
    (analysis->is_nonlinear ? json_path : json_linear)(&json, analysis);
    json_seconds(&json, analysis);
    print_outputs_json(&json, analysis, value, 0);
    print_output_places_json(&json, analysis, value, 0);
    json_open(&json, "ratios", '{');
    for (int k = 0; k < design->outputs; k++)
        if (isfinite(design->output[k].reference))
            json_number(&json, design->output[k].name,
                        analysis_output(analysis, k, 0, value) / design->output[k].reference);
    json_close(&json, '}');
    print_reactions_json(&json, analysis);
    print_springs_json(&json, analysis, displacement);
    if (design->electrodes.count > 0)
        print_electrodes_json(&json, analysis);
    print_bare_faces_json(&json, analysis);
    if (analysis->load_path.points > 0)
        print_load_path_json(&json, analysis, &analysis->load_path);
    print_stress_json(&json, stress);
    print_mesh_error_json(&json, &analysis->mesh_error);
    json_close(&json, '}');
}
