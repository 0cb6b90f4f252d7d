/* SPDX-License-Identifier: BSD-2-Clause */
/* Absolute value, clamping and finiteness of a real number. */
#ifndef PZS_LIB_NUMBERS_H
#define PZS_LIB_NUMBERS_H

#include "pzs_base.h"

static inline pzs_real number_absolute(pzs_real number)
{
    return PZS_ABS(number);
}

/* Return the number clamped to [lower, upper]; for NaN the result is NaN. */
static inline pzs_real number_clamp(pzs_real number, pzs_real lower, pzs_real upper)
{
    const pzs_real below_upper = number > upper ? upper : number;
    return number < lower ? lower : below_upper;
}

/*
 * Return whether a number is neither NaN nor infinite: only a finite number minus itself is zero.
 */
static inline bool number_is_finite(pzs_real number)
{
    const pzs_real zero = number - number;
    return zero <= 0;
}

#endif
