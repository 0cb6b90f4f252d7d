/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * What the parts of the voltage optimiser share: how far loops over the entries of its vectors go,
 * and the work that is counted and limited.
 */
#ifndef PZS_LIB_OPTIMISER_H
#define PZS_LIB_OPTIMISER_H

#include "pzs_control.h"

/*
 * Entries that a loop over the inputs visits. On vector processors it is the width, a multiple of
 * the tile: the mask tells the compiler that such a loop has no remainder. The entries behind the
 * inputs are zero.
 */
static inline size_t optimiser_span(const pzs_optimiser *optimiser)
{
    return PZS_TILE > 4 ? optimiser->width & ~(PZS_TILE - 1u) : optimiser->inputs;
}

/*
 * Whether work of `cost` multiply-adds is within the limit, besides the true gradient that ends
 * every round, and that at its start if the round may be undone and it was only predicted.
 */
static inline bool optimiser_affords(const pzs_optimiser *optimiser, uint64_t cost)
{
    const uint64_t products = optimiser->is_predicted ? 2u : 1u;
    const uint64_t to_end = products * PZS_PRODUCT_WORK(optimiser->inputs);
    return optimiser->work + cost + to_end <= optimiser->work_limit;
}

#endif
