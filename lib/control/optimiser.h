/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Functions that all parts of the voltage optimiser use: the length of loops over the inputs
 * (voltages), and the check of the largest number of multiply-adds that a tick may take.
 */
#ifndef PZS_LIB_OPTIMISER_H
#define PZS_LIB_OPTIMISER_H

#include "pzs_control.h"

/*
 * Return the number of entries that a loop over the inputs (voltages) visits: the number of inputs,
 * or, where PZS_TILE (matrix rows processed together) is above 4 for vector processors, this number
 * rounded up to a multiple of PZS_TILE. The function clears the lowest bits of the result, which
 * are zero already, to tell the compiler that the loop has no remainder. The entries beyond the
 * inputs are zero.
 */
static inline size_t optimiser_span(const pzs_optimiser *optimiser)
{
    return PZS_TILE > 4 ? optimiser->width & ~(PZS_TILE - 1u) : optimiser->inputs;
}

/*
 * Return whether the optimiser finds the active set (the voltages at their limits) by its dual
 * active-set method, which is for many inputs (from PZS_DUAL_INPUTS on). If the library is compiled
 * for fewer inputs than that (PZS_INPUT_LIMIT), the compiler knows the result.
 */
static inline bool optimiser_is_dual(const pzs_optimiser *optimiser)
{
    return PZS_DUAL_INPUTS <= PZS_INPUT_LIMIT && optimiser->is_dual;
}

/*
 * Return whether `cost` multiply-adds are within the work limit of the optimiser, together with the
 * work that ends the present round (sequence of iterations): the gradient computed from the Hessian
 * at its end, and, if the gradient at its start was only predicted, also the gradient there, which
 * is needed to undo the round.
 */
static inline bool optimiser_affords(const pzs_optimiser *optimiser, uint64_t cost)
{
    const uint64_t products = optimiser->is_predicted ? 2u : 1u;
    const uint64_t to_end = products * PZS_PRODUCT_WORK(optimiser->inputs);
    return optimiser->work + cost + to_end <= optimiser->work_limit;
}

#endif
