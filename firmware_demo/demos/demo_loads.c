/*
 * Nonlinear image of the demonstration: the loads of the scene at large rotation, in the load steps
 * of the scene. It prints one line for each output of the scene, and in the last line how far the
 * outputs are from those that the host computed in double; the difference must be explained by
 * rounding. The exit code is 0 if all results are as expected.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "demo.h"
#include "../boards/board.h"
#include "print.h"
#include DEMO_TABLES

#define REALS(bytes) (((bytes) + sizeof(pzs_real) - 1u) / sizeof(pzs_real))
#define ROUNDING                                                                                   \
    (1000 * PZS_EPSILON) /* a thin shell multiplies that of tables and sums by about L/h, here 250 \
                          */

static pzs_real model_work[REALS(DEMO_MODEL_BYTES)] BOARD_LARGE;
static pzs_real path_work[REALS(DEMO_SOLVER_BYTES)] BOARD_LARGE;
static pzs_real output[DEMO_ALL_OUTPUTS];

static pzs_real size(pzs_real number)
{
    return number < 0 ? -number : number;
}

/* Largest difference from the outputs of the host, relative to the largest of these outputs. */
static pzs_real report(void)
{
    pzs_real most = 0, difference = 0;
    for (int i = 0; i < DEMO_ALL_OUTPUTS; i++) {
        const pzs_real off = size(output[i] - demo_reached[i]);
        print_text("output");
        print_count("row", (uint32_t)i);
        print_real("value", output[i]);
        print_text("\n");
        most = size(demo_reached[i]) > most ? size(demo_reached[i]) : most;
        difference = off > difference ? off : difference;
    }
    return difference / most;
}

int main(void)
{
    static const demo_nonlinear_image image = DEMO_NONLINEAR_IMAGE;
    pzs_model model = {0};
    pzs_solver solver = {0};

    board_start();
    const int failed = drill_path(&image);
    pzs_status status = demo_open_path(&model, &solver, &image);
    if (!PZS_IS_ERROR(status))
        status = demo_equilibrium("loads", &solver, demo_full_input);
    if (PZS_IS_ERROR(status)) {
        print_text("FAILED:");
        print_count("status", status);
        print_text("\n");
        return 1;
    }
    pzs_observe(&demo_structure, solver.info.displacement, output);
    const pzs_real difference = report();
    print_text("result");
    print_hex("scene", demo_structure.scene);
    print_count("bits", PZS_REAL_BITS);
    print_count("dof", demo_structure.free_dof);
    print_real("from_host_double", difference);
    print_text("\ncost stack");
    print_count("used", board_stack_used());
    print_text(" bytes\n");
    return failed || !(difference <= ROUNDING) || status != PZS_OK;
}
