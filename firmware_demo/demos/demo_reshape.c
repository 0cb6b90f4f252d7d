/*
 * Nonlinear image of the demonstration: voltages for a target shape at large rotation. The optimum
 * of the linear model misses the target because of the rotation; one voltage step with the
 * influence matrix at the deformed shape removes most of this error. The program prints two lines
 * for each equilibrium and then the errors of the shape. The exit code is 0 if all results are as
 * expected.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "demo.h"
#include "../boards/board.h"
#include "../../lib/core/guard.h"
#include "print.h"
#include DEMO_TABLES

#define REALS(bytes) (((bytes) + sizeof(pzs_real) - 1u) / sizeof(pzs_real))

static pzs_real model_work[REALS(DEMO_MODEL_BYTES)] BOARD_LARGE;
static pzs_real path_work[REALS(DEMO_SOLVER_BYTES)] BOARD_LARGE;
static pzs_real control_work[REALS(DEMO_CONTROL_BYTES)] BOARD_LARGE;
static pzs_real influence[DEMO_ALL_OUTPUTS * DEMO_ALL_INPUTS] BOARD_LARGE;
static pzs_real amount[DEMO_ALL_INPUTS]; /* input values: voltages, then the loads of the scene */
static pzs_real output[DEMO_ALL_OUTPUTS], error[DEMO_OUTPUTS];

typedef struct reshape_log {
    pzs_real missed[2];  /* relative RMS error of the shape, with the voltages from the influence
                            matrix of the undeformed and of the deformed shape (1) */
    pzs_real optimality; /* relative KKT violation of the last voltage step (1) */
    uint32_t active, passes; /* inputs at a limit and iterations in the last voltage step */
    uint32_t outside;        /* number of voltages outside their limits */
    uint32_t at_rest, at_shape, step; /* instructions for the influence matrix of the undeformed
                                         shape, for that of the deformed shape, and for the last
                                         voltage step */
} reshape_log;

/*
 * Keep the columns of the amplifiers and the rows of the targets of the influence matrix, in place.
 */
static void keep_control_part(void)
{
    for (int i = 0; i < DEMO_OUTPUTS; i++)
        for (int j = 0; j < DEMO_INPUTS; j++)
            influence[i * DEMO_INPUTS + j] = influence[i * DEMO_ALL_INPUTS + j];
}

static pzs_status influence_at_rest(pzs_model *model, reshape_log *log)
{
    const uint32_t start = board_count();
    pzs_status status = pzs_model_init(model, &demo_structure, model_work, sizeof model_work);
    if (!PZS_IS_ERROR(status))
        status = pzs_assemble(model, NULL, NULL);
    if (!PZS_IS_ERROR(status))
        status = pzs_factor(model);
    if (!PZS_IS_ERROR(status))
        status = pzs_influence(model, influence);
    log->at_rest = board_instructions(start, board_count());
    keep_control_part();
    return status;
}

static pzs_status influence_at_shape(pzs_solver *solver, reshape_log *log)
{
    const uint32_t start = board_count();
    const pzs_status status = pzs_influence_at(solver, influence);
    log->at_shape = board_instructions(start, board_count());
    keep_control_part();
    return status;
}

/*
 * Find the optimal voltages for the present influence matrix and error, in as many voltage steps as
 * the work limit requires.
 */
static pzs_status choose_volts(pzs_control *control, reshape_log *log)
{
    const uint32_t start = board_count();
    pzs_status status =
        pzs_control_init(control, &demo_problem, influence, control_work, sizeof control_work);
    for (int again = 0;
         again < 10 && !PZS_IS_ERROR(status) && (again == 0 || status == PZS_W_ITERATIONS); again++)
        status = pzs_step(control, error);
    log->step = board_instructions(start, board_count());
    if (PZS_IS_ERROR(status))
        return status;
    pzs_report report;
    status = pzs_assess(control, error, &report);
    log->optimality = report.kkt_violation;
    log->active = report.active_limits;
    log->passes = control->info.iterations;
    for (int j = 0; j < DEMO_INPUTS; j++) {
        log->outside += !(control->info.voltage[j] >= demo_lower[j] &&
                          control->info.voltage[j] <= demo_upper[j]);
        amount[j] = control->info.voltage[j];
    }
    return status;
}

static pzs_real shape_error(void)
{
    pzs_real missed = 0, wanted = 0;
    for (int i = 0; i < DEMO_OUTPUTS; i++) {
        const pzs_real off = demo_weight[i] * (output[i] - demo_target[i]),
                       all = demo_weight[i] * demo_target[i];
        missed += off * off;
        wanted += all * all;
    }
    return PZS_SQRT(missed / wanted);
}

/* Compute the equilibrium under the input values, and its outputs. */
static pzs_status reach(const char *name, pzs_solver *solver, pzs_real *missed)
{
    const pzs_status status = demo_equilibrium(name, solver, amount);
    pzs_observe(&demo_structure, solver->info.displacement, output);
    *missed = shape_error();
    return status;
}

/*
 * Compute the shape that the voltages must make, counted from zero voltage: target minus reached
 * shape plus the influence matrix times the present voltages.
 */
static void error_at_shape(void)
{
    for (int i = 0; i < DEMO_OUTPUTS; i++) {
        error[i] = demo_target[i] - output[i];
        for (int j = 0; j < DEMO_INPUTS; j++)
            error[i] += influence[i * DEMO_INPUTS + j] * amount[j];
    }
}

static pzs_status reshape(const demo_nonlinear_image *image, reshape_log *log)
{
    pzs_model model = {0};
    pzs_solver solver = {0};
    pzs_control control = {0};
    pzs_status status = influence_at_rest(&model, log);

    for (int i = 0; i < DEMO_OUTPUTS; i++)
        error[i] = demo_target[i];
    for (int j = DEMO_INPUTS; j < DEMO_ALL_INPUTS; j++)
        amount[j] = demo_full_input[j];
    if (!PZS_IS_ERROR(status))
        status = choose_volts(&control, log);
    if (!PZS_IS_ERROR(status))
        status = demo_open_path(&model, &solver, image);
    if (!PZS_IS_ERROR(status))
        status = reach("linear-optimum", &solver, &log->missed[0]);
    if (!PZS_IS_ERROR(status))
        status = influence_at_shape(&solver, log);
    if (!PZS_IS_ERROR(status))
        error_at_shape();
    if (!PZS_IS_ERROR(status))
        status = choose_volts(&control, log);
    if (!PZS_IS_ERROR(status))
        status = reach("relinearised", &solver, &log->missed[1]);
    return status;
}

static void report(const reshape_log *log, pzs_status status)
{
    print_text("result");
    print_hex("scene", demo_structure.scene);
    print_count("bits", PZS_REAL_BITS);
    print_count("dof", demo_structure.free_dof);
    print_count("status", status);
    print_real("error_linear", log->missed[0]);
    print_real("error_relinearised", log->missed[1]);
    print_real("kkt", log->optimality);
    print_count("active", log->active);
    print_count("iterations", log->passes);
    print_count("outside", log->outside);
    print_hex("voltages", ~pzs_guard_crc(GUARD_CRC_START, amount, sizeof amount));
    print_text("\ncost influence");
    print_count("at_rest", log->at_rest);
    print_count("at_shape", log->at_shape);
    print_count("voltage_step", log->step);
    print_text(" instructions\ncost stack");
    print_count("used", board_stack_used());
    print_text(" bytes\n");
}

int main(void)
{
    static const demo_nonlinear_image image = DEMO_NONLINEAR_IMAGE;
    reshape_log log = {0};

    board_start();
    const int failed = drill_path(&image);
    const pzs_status status = reshape(&image, &log);
    report(&log, status);
    return failed || status != PZS_OK || log.outside || !(log.missed[1] < log.missed[0]);
}
