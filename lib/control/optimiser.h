/* SPDX-License-Identifier: BSD-2-Clause */
/* What the parts of the voltage optimiser share: how far loops over the entries of its vectors go.
 */
#ifndef PZS_LIB_OPTIMISER_H
#define PZS_LIB_OPTIMISER_H

#include "pzs_control_state.h"

/* Whether the processor works on whole vectors. Only the speed depends on it. */
#define OPTIMISER_WIDE (PZS_TILE > 4)

/*
 * Entries that a loop over the inputs visits. On vector processors it is the width, a multiple of
 * the tile: the mask tells the compiler that such a loop has no remainder. The entries behind the
 * inputs are zero.
 */
static inline size_t optimiser_span(const pzs_optimiser *optimiser)
{
    return OPTIMISER_WIDE ? optimiser->width & ~(PZS_TILE - 1u) : optimiser->inputs;
}

#endif
