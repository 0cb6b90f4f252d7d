/* SPDX-License-Identifier: BSD-2-Clause */
/* Recovery of all stresses of a structure (stress.h). */
#include "stress.h"
#include "stress_equilibrium.h"
#include "stress_warp.h"

int stress_recover_with(stress_field *field, const stress_state *state,
                        const stress_correction *correction)
{
    if (stress_field_fill(field, state, correction) < 0)
        return -1;
    stress_equilibrium(field);
    return stress_warp(field);
}

int stress_recover(stress_field *field, const stress_state *state)
{
    return stress_recover_with(field, state, NULL);
}
