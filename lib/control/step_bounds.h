/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Range of voltages that a step limit (largest change of a voltage in a tick) allows. Rounding may
 * narrow this range but never widens it: the computed difference to the last voltage is at most the
 * step limit.
 */
#ifndef PZS_LIB_STEP_BOUNDS_H
#define PZS_LIB_STEP_BOUNDS_H

#include "../core/numbers.h"

/* Return the lowest voltage that one tick can reach from the voltage `last` (V). */
static inline pzs_real step_down(pzs_real last, pzs_real step_limit)
{
    const pzs_real down = last - step_limit;
    const pzs_real inner =
        last - down > step_limit ? down + PZS_EPSILON * number_absolute(down) : down;
    return inner < last ? inner : last;
}

/* Return the highest voltage that one tick can reach from the voltage `last` (V). */
static inline pzs_real step_up(pzs_real last, pzs_real step_limit)
{
    const pzs_real up = last + step_limit;
    const pzs_real outer = up - last > step_limit ? up - PZS_EPSILON * number_absolute(up) : up;
    return outer > last ? outer : last;
}

#endif
