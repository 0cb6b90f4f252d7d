/*
 * Functions that the two demonstrations of vibration modes share: two lines about each search, one
 * about the result and one about the work, and the comparison of frequencies with the tables.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "demo.h"
#include "../boards/board.h"
#include "../../lib/core/guard.h"
#include "print.h"

void demo_modes_lines(const char *name, const pzs_modes *modes, pzs_status status, uint32_t spent,
                      const pzs_real *response, size_t responses)
{
    const size_t shapes =
        (size_t)modes->info.number * modes->state.model->state.structure->free_dof;
    print_text("modes ");
    print_text(name);
    print_count("status", status);
    print_count("converged", modes->info.converged);
    print_count("below", modes->info.below);
    print_count("solves", modes->info.linear_solves);
    print_count("counts", modes->info.counts);
    print_real("condition", modes->info.condition);
    print_hex("shapes",
              ~pzs_guard_crc(GUARD_CRC_START, modes->info.shape, shapes * sizeof(pzs_real)));
    print_hex("response", ~pzs_guard_crc(GUARD_CRC_START, response, responses * sizeof(pzs_real)));
    for (uint16_t i = 0; i < modes->info.number; i++)
        print_real("Hz", pzs_modes_frequency(modes, i));
    print_text("\ncost modes ");
    print_text(name);
    print_count("all", spent);
    print_count("solve", modes->info.linear_solves ? spent / modes->info.linear_solves : 0);
    print_text(" instructions\n");
}

int demo_modes_are(const pzs_modes *modes, const pzs_real *frequency, pzs_real stiffness,
                   pzs_real difference)
{
    int are = 1;
    for (uint16_t i = 0; i < modes->info.number; i++) {
        const pzs_real found = pzs_modes_frequency(modes, i),
                       ratio = found / frequency[i] * (found / frequency[i]) / stiffness;
        are = are && ratio > 1 - difference && ratio < 1 + difference;
    }
    return are;
}
