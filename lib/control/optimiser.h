/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Functions that all parts of the voltage optimiser use: the length of loops over the inputs
 * (voltages), and the check of the largest number of multiply-adds that a tick may take.
 */
#ifndef PZS_LIB_OPTIMISER_H
#define PZS_LIB_OPTIMISER_H

#include "pzs_control.h"

/* Whether this file is compiled for the vector unit AVX2 (boxls_wide.c). */
#ifndef IS_WIDE
#define IS_WIDE false
#endif

/*
 * Return the number of entries that a loop over the inputs (voltages) visits: the number of inputs.
 * For vector processors it is rounded up to a multiple of PZS_TILE; the entries beyond the inputs
 * are zero.
 */
static inline size_t optimiser_span(const pzs_optimiser *optimiser)
{
    // With wide vectors, `width` is a multiple of PZS_TILE already. The mask does not change it,
    // but tells the compiler so, which then leaves out the code for a remainder of the loop.
    return IS_WIDE || PZS_TILE > 4 ? optimiser->width & ~(PZS_TILE - 1u) : optimiser->inputs;
}

/*
 * Return whether the optimiser finds the active set (the voltages at their limits) by its dual
 * active-set method, which is for PZS_DUAL_INPUTS or more inputs. If the library is compiled for
 * fewer inputs (PZS_INPUT_LIMIT), the result is false at compile time, and the compiler leaves the
 * method out.
 */
static inline bool optimiser_is_dual(const pzs_optimiser *optimiser)
{
    return PZS_DUAL_INPUTS <= PZS_INPUT_LIMIT && optimiser->is_dual;
}

/* Return whether the work limit of the optimiser allows `cost` more multiply-adds now. */
static inline bool optimiser_affords(const pzs_optimiser *optimiser, uint64_t cost)
{
    // Keep enough work in reserve for the end of the iterations: a product of the Hessian with a
    // vector, which gives the gradient there. A second product is needed if the iterations may be
    // undone and the gradient at their start was only predicted.
    const uint64_t products = optimiser->is_predicted ? 2u : 1u;
    const uint64_t to_end = products * PZS_PRODUCT_WORK(optimiser->inputs);
    return optimiser->work + cost + to_end <= optimiser->work_limit;
}

#endif
