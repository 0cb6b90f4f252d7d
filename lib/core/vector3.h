/* SPDX-License-Identifier: BSD-2-Clause */
/* Vectors of three components. */
#ifndef PZS_LIB_VECTOR3_H
#define PZS_LIB_VECTOR3_H

#include "pzs_base.h"

/* Scalar product of two vectors. */
static inline pzs_real vector3_dot(const pzs_real left[3], const pzs_real right[3])
{
    return left[0] * right[0] + left[1] * right[1] + left[2] * right[2];
}

#endif
