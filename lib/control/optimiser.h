/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Helpers that the parts of the voltage optimiser share: range of loops over the inputs, and work
 * that is counted and limited.
 */
#ifndef PZS_LIB_OPTIMISER_H
#define PZS_LIB_OPTIMISER_H

#include "pzs_control.h"

/*
 * Return the number of entries that a loop over the inputs visits. On vector processors it is the
 * width, a multiple of PZS_TILE; the mask tells the compiler that the loop has no remainder. The
 * entries beyond the inputs are zero.
 */
static inline size_t optimiser_span(const pzs_optimiser *optimiser)
{
    return PZS_TILE > 4 ? optimiser->width & ~(PZS_TILE - 1u) : optimiser->inputs;
}

/*
 * Return whether the dual method handles the active set. A number PZS_DUAL_INPUTS above
 * PZS_INPUT_LIMIT makes this constant, so that the method is not linked.
 */
static inline bool optimiser_is_dual(const pzs_optimiser *optimiser)
{
    return PZS_DUAL_INPUTS <= PZS_INPUT_LIMIT && optimiser->is_dual;
}

/*
 * Return whether work of `cost` multiply-adds is within the work limit, together with the products
 * that end the round: the true gradient at its end, and, if the gradient at its start was
 * predicted, the true gradient there, which is needed to undo the round.
 */
static inline bool optimiser_affords(const pzs_optimiser *optimiser, uint64_t cost)
{
    const uint64_t products = optimiser->is_predicted ? 2u : 1u;
    const uint64_t to_end = products * PZS_PRODUCT_WORK(optimiser->inputs);
    return optimiser->work + cost + to_end <= optimiser->work_limit;
}

#endif
