/*
 * A shell at large rotation: the device computes the equilibrium under the loads of the scene, here
 * a hemisphere pulled by four forces. The host computed the outputs dome_reached in double.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "board.h"
#include "dome.h"

static pzs_real model_work[DOME_MODEL_BYTES / sizeof(pzs_real) + 1] BOARD_LARGE;
static pzs_real solver_work[DOME_SOLVER_BYTES / sizeof(pzs_real) + 1] BOARD_LARGE;
static pzs_real output[DOME_ALL_OUTPUTS];
static pzs_model model;
static pzs_solver solver;

static pzs_status open(void)
{
    const pzs_status status =
        pzs_model_init(&model, &dome_structure, model_work, sizeof model_work);
    if (status != PZS_OK)
        return status;
    return pzs_solver_init(&solver, &model, &dome_nonlinear, solver_work, sizeof solver_work);
}

/* Return the largest difference from the outputs of the host, relative to the largest of them. */
static pzs_real difference(void)
{
    pzs_real most = 0, largest = 0;
    for (int i = 0; i < DOME_ALL_OUTPUTS; i++) {
        const pzs_real off = PZS_ABS(output[i] - dome_reached[i]);
        const pzs_real size = PZS_ABS(dome_reached[i]);
        most = off > most ? off : most;
        largest = size > largest ? size : largest;
    }
    return most / largest;
}

static void print(const char *text)
{
    while (*text)
        board_put(*text++);
}

int main(void)
{
    board_start();
    pzs_status status = open();
    if (status == PZS_OK) {
        solver.settings.load_steps = DOME_LOAD_STEPS;
        solver.settings.tolerance = DOME_TOLERANCE;
        status = pzs_equilibrium(&solver, dome_full_input);
    }
    if (!PZS_IS_ERROR(status))
        pzs_observe(&dome_structure, solver.info.displacement, output);
    print(pzs_status_text(status));
    print("\n");
    /* Rounding errors of float grow on thin shells; here L/h is 250. */
    return PZS_IS_ERROR(status) || !(difference() < 1000 * PZS_EPSILON);
}
