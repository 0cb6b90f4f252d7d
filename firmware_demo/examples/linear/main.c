/*
 * The device assembles and factors the structure, computes its influence matrix, and holds a shape
 * with it. The first element type is 5 % softer than in the scene, as after a year of heat.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "board.h"
#include "plate.h"

#if PLATE_ALL_INPUTS != PLATE_INPUTS
#error "the influence matrix has columns of electrodes without amplifier: see pzs_influence"
#endif

static pzs_real model_work[PLATE_MODEL_BYTES / sizeof(pzs_real) + 1];
static pzs_real work[PLATE_LOOP_BYTES / sizeof(pzs_real) + 1];
static pzs_real influence[PLATE_ALL_OUTPUTS * PLATE_ALL_INPUTS];
static pzs_model model;
static pzs_loop loop;

/* Compute the influence matrix. Returns the first status that is not PZS_OK. */
static pzs_status make_influence(void)
{
    static pzs_real stiffness_factor[sizeof plate_element_types / sizeof *plate_element_types];
    for (unsigned k = 0; k < sizeof plate_element_types / sizeof *plate_element_types; k++)
        stiffness_factor[k] = k == 0 ? PZS_R(0.95) : 1;
    pzs_status status = pzs_model_init(&model, &plate_structure, model_work, sizeof model_work);
    if (status == PZS_OK)
        status = pzs_assemble(&model, stiffness_factor, NULL);
    if (status == PZS_OK)
        status = pzs_factor(&model);
    if (status == PZS_OK)
        status = pzs_influence(&model, influence);
    return status;
}

static void print(const char *text)
{
    while (*text)
        board_put(*text++);
}

int main(void)
{
    pzs_report report = {0};
    int kicks = 0;
    board_start();
    pzs_status status = make_influence();
    if (status == PZS_OK)
        status = pzs_loop_init(&loop, plate_blocks, PLATE_BLOCKS, influence, work, sizeof work);
    for (int tick = 0; tick < 50 && !PZS_IS_ERROR(status); tick++) {
        status = pzs_loop_tick(&loop, plate_target, NULL);   /* NULL: there are no sensors */
        kicks += board_kick(pzs_loop_take_heartbeat(&loop)); /* the hardware watchdog */
    }
    if (!PZS_IS_ERROR(status))
        status = pzs_assess(loop.info.control, plate_target, &report);
    print(pzs_status_text(status));
    print("\n");
    /* The voltages are optimal within their limits: the KKT violation is a rounding error. */
    return PZS_IS_ERROR(status) || kicks != 50 || !(report.kkt_violation < 1000 * PZS_EPSILON);
}
