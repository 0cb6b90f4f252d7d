/*
 * Natural frequencies and mode shapes on the device about an equilibrium at large rotation, whose
 * prestress changes them: without loads first, then under the loads of the scene. Both must be the
 * frequencies that the host has written into the tables; the exit code is then 0.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "demo.h"
#include "../boards/board.h"
#include "print.h"
#include DEMO_TABLES

#define REALS(bytes) (((bytes) + sizeof(pzs_real) - 1u) / sizeof(pzs_real))

static pzs_real model_work[REALS(DEMO_MODEL_BYTES)] BOARD_LARGE;
static pzs_real path_work[REALS(DEMO_SOLVER_BYTES)] BOARD_LARGE;
static pzs_real modes_work[REALS(DEMO_MODES_BYTES)] BOARD_LARGE;
static pzs_real response[DEMO_MODES * DEMO_ALL_INPUTS];

/*
 * Whether the squared frequencies are those of the host but for the rounding errors of linear
 * solves, which are not refined at an equilibrium.
 */
static int are_expected(const pzs_modes *modes, const pzs_real *frequency)
{
    return demo_modes_are(modes, frequency, 1, PZS_EPSILON * modes->info.condition);
}

/* The equilibrium at a part of the input values of the scene, and the modes about it. */
static pzs_status find_at(const char *name, pzs_modes *modes, pzs_solver *solver, pzs_real part)
{
    pzs_real amount[DEMO_ALL_INPUTS];
    for (int i = 0; i < DEMO_ALL_INPUTS; i++)
        amount[i] = part * demo_full_input[i];
    pzs_status status = demo_equilibrium(name, solver, amount);
    if (PZS_IS_ERROR(status))
        return status;
    const uint32_t start = board_count();
    status = pzs_modes_find_at(modes, solver);
    const uint32_t spent = board_instructions(start, board_count());
    if (!PZS_IS_ERROR(status))
        status = pzs_modes_response(modes, response);
    demo_modes_lines(name, modes, status, spent, response, sizeof response / sizeof *response);
    return status;
}

int main(void)
{
    static const demo_nonlinear_image image = DEMO_NONLINEAR_IMAGE;
    pzs_model model = {0};
    pzs_solver solver = {0};
    pzs_modes modes = {0};

    board_start();
    pzs_status status = demo_open_path(&model, &solver, &image);
    if (status == PZS_OK)
        status = pzs_modes_init(&modes, &model, &demo_mass, DEMO_MODES, DEMO_MODES_VECTORS,
                                modes_work, sizeof modes_work);
    int failed =
        drill_line("modes-before-an-equilibrium",
                   status == PZS_OK && pzs_modes_find_at(&modes, &solver) == PZS_E_STAGE, status);
    if (status == PZS_OK)
        status = find_at("undeformed", &modes, &solver, 0);
    failed += drill_line("frequencies-without-loads",
                         status == PZS_OK && are_expected(&modes, demo_frequency), status);
    if (status == PZS_OK)
        status = find_at("loaded", &modes, &solver, 1);
    failed += drill_line("frequencies-under-loads",
                         status == PZS_OK && are_expected(&modes, demo_reached_frequency), status);
    print_text("cost stack");
    print_count("used", board_stack_used());
    print_text(" bytes\n");
    return failed > 0;
}
