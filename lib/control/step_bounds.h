/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * How far a step limit lets a voltage move in one step. Rounding may narrow this range, never widen
 * it: the computed difference to the last voltage is at most the step limit.
 */
#ifndef PZS_LIB_STEP_BOUNDS_H
#define PZS_LIB_STEP_BOUNDS_H

#include "../core/numbers.h"

/* Lowest voltage that one step reaches from the voltage `last` (V). */
static inline pzs_real step_down(pzs_real last, pzs_real step_limit)
{
    const pzs_real down = last - step_limit;
    const pzs_real inner =
        last - down > step_limit ? down + PZS_EPSILON * number_absolute(down) : down;
    return inner < last ? inner : last;
}

/* Highest voltage that one step reaches from the voltage `last` (V). */
static inline pzs_real step_up(pzs_real last, pzs_real step_limit)
{
    const pzs_real up = last + step_limit;
    const pzs_real outer = up - last > step_limit ? up - PZS_EPSILON * number_absolute(up) : up;
    return outer > last ? outer : last;
}

#endif
