/* SPDX-License-Identifier: BSD-2-Clause */
/* Absolute value, clamping and finiteness of a real number. */
#ifndef PZS_LIB_NUMBERS_H
#define PZS_LIB_NUMBERS_H

#include "pzs_base.h"

static inline pzs_real number_absolute(pzs_real x)
{
    return PZS_ABS(x);
}

/* x inside [lower, upper]; upper if x is NaN and lower <= upper. */
static inline pzs_real number_clamp(pzs_real x, pzs_real lower, pzs_real upper)
{
    const pzs_real below_upper = x > upper ? upper : x;
    return x < lower ? lower : below_upper;
}

/* Neither NaN nor infinite: x - x is zero for finite numbers alone. */
static inline bool number_is_finite(pzs_real x)
{
    const pzs_real zero = x - x;
    return zero <= 0;
}

#endif
