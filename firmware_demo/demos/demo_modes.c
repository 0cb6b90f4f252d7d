/*
 * Natural frequencies and mode shapes on the device, before and after a change of the stiffness in
 * the field. The frequencies must be those that the host has written into the tables; the exit code
 * is then 0. Electrodes are open where the tables say so.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <string.h>
#include "demo.h"
#include "../boards/board.h"
#include "print.h"
#include DEMO_TABLES

#define REALS(bytes) (((bytes) + sizeof(pzs_real) - 1u) / sizeof(pzs_real))

/*
 * Largest relative difference of a squared frequency from that of the tables: rounding errors of
 * the sum of the strain energies of all elements.
 */
#define CLOSE_TO (64 * PZS_EPSILON)

static pzs_real model_work[REALS(DEMO_MODEL_BYTES)] BOARD_LARGE;
static pzs_real modes_work[REALS(DEMO_MODES_BYTES)] BOARD_LARGE;
static pzs_real response[DEMO_MODES * DEMO_INPUTS];
static pzs_real stiffness_factor[sizeof demo_element_types / sizeof *demo_element_types];

#ifdef DEMO_MODES_OPEN
static pzs_real open_work[REALS(DEMO_MODES_OPEN_BYTES)] BOARD_LARGE;
static pzs_real charge[sizeof demo_electrode_value / sizeof *demo_electrode_value];
static pzs_electrodes electrodes;

/*
 * Open the electrodes that are open in the tables while the structure vibrates, with their
 * capacitances divided by a number.
 */
static pzs_status open_electrodes(pzs_modes *modes, pzs_real divisor)
{
    electrodes = demo_electrodes;
    for (size_t k = 0; k < sizeof charge / sizeof *charge; k++)
        charge[k] = demo_electrode_value[k] / divisor;
    electrodes.direct.value = charge;
    const pzs_status status = pzs_electrodes_seal(&electrodes, &demo_structure);
    if (status != PZS_OK)
        return status;
    return pzs_modes_open_electrodes(modes, &electrodes, demo_modes_open, open_work,
                                     sizeof open_work);
}

/* Provoke a fault of the memory of the open electrodes. Returns the number of wrong results. */
static int drill_open(pzs_modes *modes)
{
    const pzs_status status = pzs_modes_open_electrodes(modes, &demo_electrodes, demo_modes_open,
                                                        open_work, DEMO_MODES_OPEN_BYTES - 1);
    return drill_line(
        "open-work-too-small",
        status == PZS_E_WORKSPACE && modes->info.where == (int32_t)DEMO_MODES_OPEN_BYTES, status);
}
#else
static pzs_status open_electrodes(pzs_modes *modes, pzs_real divisor)
{
    (void)modes;
    (void)divisor;
    return PZS_OK;
}

static int drill_open(pzs_modes *modes)
{
    (void)modes;
    return 0;
}
#endif

/* Assemble and factor the stiffness with the same factor for all element types. */
static pzs_status factor(pzs_model *model, pzs_real of_all)
{
    for (size_t k = 0; k < sizeof stiffness_factor / sizeof *stiffness_factor; k++)
        stiffness_factor[k] = of_all;
    const pzs_status status = pzs_assemble(model, stiffness_factor, NULL);
    return status == PZS_OK ? pzs_factor(model) : status;
}

static pzs_status find(const char *name, pzs_modes *modes)
{
    const uint32_t start = board_count();
    pzs_status status = pzs_modes_find(modes);
    const uint32_t spent = board_instructions(start, board_count());
    if (!PZS_IS_ERROR(status))
        status = pzs_modes_response(modes, response);
    demo_modes_lines(name, modes, status, spent, response, sizeof response / sizeof *response);
    return status;
}

/* Provoke faults of the mass tables and of the memory. Returns the number of wrong results. */
static int drill_modes(pzs_model *model)
{
    pzs_modes modes = {0};
    pzs_mass damaged = demo_mass;
    pzs_status status = pzs_modes_find(&modes);
    int failed = drill_line("modes-before-init", status == PZS_E_STAGE, status);
    damaged.crc ^= 1u;
    status = pzs_modes_init(&modes, model, &damaged, DEMO_MODES, DEMO_MODES_VECTORS, modes_work,
                            sizeof modes_work);
    failed += drill_line("mass-damaged", status == PZS_E_CRC, status);
    damaged = demo_mass;
    damaged.scene++;
    status = pzs_modes_init(&modes, model, &damaged, DEMO_MODES, DEMO_MODES_VECTORS, modes_work,
                            sizeof modes_work);
    failed += drill_line("mass-of-another-scene", status == PZS_E_FORMAT, status);
    status = pzs_modes_init(&modes, model, &demo_mass, DEMO_MODES, DEMO_MODES_VECTORS, modes_work,
                            DEMO_MODES_BYTES - 1);
    failed += drill_line("modes-work-too-small",
                         status == PZS_E_WORKSPACE && modes.info.where == (int32_t)DEMO_MODES_BYTES,
                         status);
    return failed;
}

/*
 * Find the modes, then again with twice the stiffness and half the capacitance of each electrode,
 * from the sum of the mode shapes before. Returns the number of wrong results.
 */
static int find_twice(pzs_model *model)
{
    static pzs_real start[DEMO_FREE_DOF];
    pzs_modes modes = {0};
    pzs_status status = pzs_modes_init(&modes, model, &demo_mass, DEMO_MODES, DEMO_MODES_VECTORS,
                                       modes_work, sizeof modes_work);
    modes.settings.shift = DEMO_MODES_SHIFT;
    if (status == PZS_OK)
        status = open_electrodes(&modes, 1);
    if (status == PZS_OK)
        status = find("reference", &modes);
    int failed =
        drill_line("frequencies",
                   status == PZS_OK && demo_modes_are(&modes, demo_frequency, 1, CLOSE_TO), status);
    if (failed)
        return failed;
    for (size_t i = 0; i < DEMO_MODES; i++)
        for (size_t k = 0; k < DEMO_FREE_DOF; k++)
            start[k] += modes.info.shape[i * DEMO_FREE_DOF + k];
    modes.settings.start = start;
    status = factor(model, 2);
    if (status == PZS_OK)
        status = open_electrodes(&modes, 2);
    if (status == PZS_OK)
        status = find("stiffer", &modes);
    failed +=
        drill_line("frequencies-of-twice-the-stiffness",
                   status == PZS_OK && demo_modes_are(&modes, demo_frequency, 2, CLOSE_TO), status);
    return failed + drill_open(&modes);
}

int main(void)
{
    pzs_model model = {0};
    board_start();
    pzs_status status = pzs_model_init(&model, &demo_structure, model_work, sizeof model_work);
    const uint32_t start = board_count();
    if (status == PZS_OK)
        status = factor(&model, 1);
    const uint32_t spent = board_instructions(start, board_count());
    print_text("model");
    print_hex("scene", demo_structure.scene);
    print_count("status", status);
    print_count("dof", DEMO_FREE_DOF);
    print_count("modes", DEMO_MODES);
    print_count("vectors", DEMO_MODES_VECTORS);
    print_real("condition", model.info.condition);
    print_text("\ncost model");
    print_count("factor", spent);
    print_text(" instructions\n");
    int failed = status != PZS_OK;
    if (!failed) {
        failed += find_twice(&model);
        failed += drill_modes(&model);
    }
    print_text("cost stack");
    print_count("used", board_stack_used());
    print_text("\n");
    return failed > 0;
}
