/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * CRC-32 of long arrays for hosts whose processor multiplies polynomials
 * (option PZS_WIDE, x86 instruction PCLMULQDQ).
 */
#ifndef PZS_LIB_GUARD_WIDE_H
#define PZS_LIB_GUARD_WIDE_H

#include "pzs_base.h"

/* Number of bytes that one step of the CRC-32 with polynomial products processes. */
#define CRC_BLOCK 64u
/*
 * Number of bytes to which pzs_wide_fold reduces a long array, so that the CRC-32 of these bytes is
 * that of the array.
 */
#define CRC_REST 16u

/*
 * Number of reals that pzs_wide_is_finite reads in one step. The length of its array must be a
 * multiple of this number.
 */
#define FINITE_BLOCK 8u

#if PZS_WIDE

/*
 * Return whether this processor has the instructions for products of polynomials with which
 * pzs_wide_fold computes the CRC-32 of long arrays.
 */
bool pzs_guard_has_fold(void);

/*
 * Reduce `bytes` bytes of data, a multiple of CRC_BLOCK (the bytes of one step) and not zero, to
 * the few bytes (CRC_REST) of `rest`. The CRC-32 of `rest` with the start value 0 equals that of
 * the data with the start value `crc`.
 */
void pzs_wide_fold(uint8_t rest[CRC_REST], uint32_t crc, const uint8_t *data, size_t bytes);

/* Return whether all `count` numbers, a multiple of FINITE_BLOCK, are finite. */
bool pzs_wide_is_finite(const pzs_real *value, size_t count);

#else

static inline bool pzs_guard_has_fold(void)
{
    return false;
}
#define pzs_wide_fold(rest, crc, data, bytes) ((void)(rest))
#define pzs_wide_is_finite(value, count) false

#endif
#endif
