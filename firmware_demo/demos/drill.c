/*
 * Fault drill: each provoked fault must end in its status, with all voltages inside their limits.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <string.h>
#include "demo.h"
#include "print.h"

int drill_line(const char *name, int ok, pzs_status status)
{
    print_text("drill ");
    print_text(name);
    if (ok) {
        print_text(" ok\n");
    } else {
        print_text(" FAILED:");
        print_count("status", status);
        print_text("\n");
    }
    return !ok;
}

static int inside(const pzs_control *control)
{
    const pzs_problem *problem = control->state.problem;
    for (int j = 0; j < problem->inputs; j++)
        if (!(control->info.voltage[j] >= problem->lower[j] &&
              control->info.voltage[j] <= problem->upper[j]))
            return 0;
    return 1;
}

static pzs_real not_a_number(void)
{
    pzs_real number;
    memset(&number, 0xFF, sizeof number);
    return number;
}

int drill_model(const pzs_structure *structure, void *work, size_t bytes)
{
    pzs_model model = {0};
    pzs_structure damaged = *structure;
    pzs_status status;
    int failed = 0;

    status = pzs_factor(&model);
    failed += drill_line("factor-before-init", status == PZS_E_STAGE, status);

    damaged.crc ^= 1u;
    status = pzs_model_init(&model, &damaged, work, bytes);
    failed += drill_line("structure-damaged", status == PZS_E_CRC, status);

    status = pzs_model_init(&model, structure, work, sizeof(pzs_real));
    failed += drill_line("model-work-too-small",
                         status == PZS_E_WORKSPACE && model.info.where > 0 &&
                             (size_t)model.info.where <= bytes,
                         status);

    status = pzs_model_init(&model, structure, work, bytes);
    failed += drill_line("init", status == PZS_OK, status);
    status = pzs_factor(&model);
    failed += drill_line("factor-before-assemble", status == PZS_E_STAGE, status);
    return failed;
}

#if PZS_NONLINEAR
/*
 * Call pzs_solver_init with faulty tables and with too little memory, on the model of the image.
 * Returns the number of wrong results.
 */
static int drill_path_init(const demo_nonlinear_image *image, pzs_model *model)
{
    pzs_solver solver = {0};
    pzs_nonlinear damaged = *image->nonlinear;
    pzs_status status;
    int failed = 0;

    damaged.crc ^= 1u;
    status = pzs_solver_init(&solver, model, &damaged, image->path_work, image->path_bytes);
    failed += drill_line("path-tables-damaged", status == PZS_E_CRC, status);

    damaged = *image->nonlinear;
    damaged.scene++;
    status = pzs_solver_init(&solver, model, &damaged, image->path_work, image->path_bytes);
    failed += drill_line("path-of-another-scene", status == PZS_E_FORMAT, status);

    status = pzs_solver_init(&solver, model, image->nonlinear, image->path_work, sizeof(pzs_real));
    failed += drill_line("path-work-too-small",
                         status == PZS_E_WORKSPACE && solver.info.where > 0 &&
                             (size_t)solver.info.where <= image->path_bytes,
                         status);
    return failed;
}

int drill_path(const demo_nonlinear_image *image)
{
    pzs_model model = {0};
    pzs_solver solver = {0};
    const pzs_real bad = not_a_number();
    pzs_status status;
    int failed = 0;

    status = pzs_equilibrium(&solver, &bad);
    failed += drill_line("equilibrium-before-init",
                         status == PZS_E_ARGUMENT || status == PZS_E_STAGE, status);
    status =
        pzs_solver_init(&solver, &model, image->nonlinear, image->path_work, image->path_bytes);
    failed += drill_line("path-before-model", status == PZS_E_ARGUMENT, status);

    status = demo_open_path(&model, &solver, image);
    failed += drill_line("path-init", status == PZS_OK, status);
    failed += drill_path_init(image, &model);
    return failed;
}
#endif

/*
 * Provoke faults of the initialisation, on a separate controller. Returns the number of wrong
 * results.
 */
static int drill_init(const demo_image *image)
{
    pzs_control control = {0};
    pzs_problem damaged = *image->problem;
    pzs_status status;
    int failed = 0;

    status = pzs_tick(&control, image->wanted, image->measured);
    failed += drill_line("tick-before-init", status == PZS_E_STAGE, status);

    damaged.crc ^= 1u;
    status = pzs_control_init(&control, &damaged, image->influence, image->work, image->bytes);
    failed += drill_line("problem-damaged", status == PZS_E_CRC, status);

    damaged = *image->problem;
    damaged.format++;
    status = pzs_control_init(&control, &damaged, image->influence, image->work, image->bytes);
    failed += drill_line("format-unknown", status == PZS_E_FORMAT, status);

    status =
        pzs_control_init(&control, image->problem, image->influence, image->work, sizeof(pzs_real));
    failed += drill_line("control-work-too-small",
                         status == PZS_E_WORKSPACE && control.info.where > 0 &&
                             (size_t)control.info.where <= image->bytes,
                         status);
    return failed;
}

static int drill_sensor(pzs_control *control, const demo_image *image)
{
    const pzs_real kept = image->measured[0];
    pzs_status status;

    image->measured[0] = not_a_number();
    status = pzs_tick(control, image->wanted, image->measured);
    image->measured[0] = kept;
    return drill_line("measurement-not-a-number",
                      status == PZS_W_SENSOR && control->info.where == 0 && inside(control),
                      status);
}

static int drill_target(pzs_control *control, const demo_image *image)
{
    const pzs_real kept = image->wanted[0], voltage = control->info.voltage[0];
    pzs_status status;

    image->wanted[0] = not_a_number();
    status = pzs_tick(control, image->wanted, image->measured);
    image->wanted[0] = kept;
    return drill_line(
        "target-not-a-number",
        status == PZS_W_HELD && control->info.voltage[0] == voltage && inside(control), status);
}

/*
 * Hold all electrodes as dead: their voltages must stay where they are held, and the loop must go
 * on.
 */
static int drill_dead(pzs_control *control, const demo_image *image)
{
    pzs_status status = PZS_OK;
    int held = 1;

    for (uint16_t j = 0; j < image->problem->inputs && status == PZS_OK; j++)
        status = pzs_hold(control, j, 0);
    if (status == PZS_OK)
        status = pzs_tick(control, image->wanted, image->measured);
    for (int j = 0; j < image->problem->inputs; j++)
        held = held && control->info.voltage[j] == control->info.lower[j] &&
               control->info.voltage[j] == control->info.upper[j];
    return drill_line("all-dead", !PZS_IS_ERROR(status) && held && inside(control), status);
}

static int drill_recovery(pzs_control *control, const demo_image *image)
{
    pzs_status status = PZS_OK;
    int moved = 0;

    for (uint16_t j = 0; j < image->problem->inputs && status == PZS_OK; j++)
        status = pzs_release(control, j);
    for (int tick = 0; tick < 3 && !PZS_IS_ERROR(status); tick++)
        status = pzs_tick(control, image->wanted, NULL);
    for (int j = 0; j < image->problem->inputs; j++)
        moved = moved || control->info.voltage[j] < 0 || control->info.voltage[j] > 0;
    return drill_line("alive-again", status == PZS_OK && moved && inside(control), status);
}

int drill_control(pzs_control *control, const demo_image *image)
{
    int failed = 0;
    failed += drill_sensor(control, image);
    failed += drill_target(control, image);
    failed += drill_dead(control, image);
    failed += drill_recovery(control, image);
    failed += drill_init(image); /* last, because it may overwrite the memory of the controller */
    return failed;
}
