/*
 * Functions that the nonlinear demonstrations share: initialisation of an equilibrium solver, and
 * two lines about each equilibrium, one about the result and one about the work.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "demo.h"
#include "../boards/board.h"
#include "print.h"

pzs_status demo_open_path(pzs_model *model, pzs_solver *solver, const demo_nonlinear_image *image)
{
    pzs_status status =
        pzs_model_init(model, image->structure, image->model_work, image->model_bytes);
    if (PZS_IS_ERROR(status))
        return status;
    status = pzs_solver_init(solver, model, image->nonlinear, image->path_work, image->path_bytes);
    if (PZS_IS_ERROR(status))
        return status;
    solver->settings.tolerance = image->tolerance;
    solver->settings.load_steps = image->load_steps;
    solver->settings.extrapolated_iterations = image->extrapolated_iterations;
    solver->settings.ramp_solves = image->ramp_solves;
    solver->settings.solve_limit = image->solve_limit;
    return status;
}

pzs_status demo_equilibrium(const char *name, pzs_solver *solver, const pzs_real *amount)
{
    const uint32_t start = board_count();
    const pzs_status status = pzs_equilibrium(solver, amount);
    const uint32_t spent = board_instructions(start, board_count());

    print_text("equilibrium ");
    print_text(name);
    print_count("status", status);
    print_count("steps", solver->info.load_steps);
    print_count("systems", solver->info.linear_solves);
    print_count("negative", solver->info.negative_pivots);
    print_real("residual", solver->info.residual);
    print_text("\ncost equilibrium ");
    print_text(name);
    print_count("all", spent);
    print_count("system", solver->info.linear_solves ? spent / solver->info.linear_solves : 0);
    print_text(" instructions\n");
    return status;
}
