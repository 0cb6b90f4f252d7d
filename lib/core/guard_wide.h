/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * CRC-32 of long arrays for hosts whose processor multiplies polynomials
 * (option PZS_WIDE, x86 instruction PCLMULQDQ).
 */
#ifndef PZS_LIB_GUARD_WIDE_H
#define PZS_LIB_GUARD_WIDE_H

#include "pzs_base.h"

#define CRC_BLOCK 64u /* bytes that the wide CRC-32 folds together */
#define CRC_REST 16u  /* bytes to which it folds an array */

#if PZS_WIDE

/* Return whether this processor can execute pzs_wide_fold. */
bool pzs_guard_has_fold(void);

/*
 * Fold `bytes` bytes of data, a multiple of CRC_BLOCK and not zero, into
 * CRC_REST bytes. The CRC-32 of these bytes, begun with 0, is that of the data,
 * begun with crc.
 */
void pzs_wide_fold(uint8_t rest[CRC_REST], uint32_t crc, const uint8_t *data, size_t bytes);

#else

static inline bool pzs_guard_has_fold(void)
{
    return false;
}
#define pzs_wide_fold(rest, crc, data, bytes) ((void)(rest))

#endif
#endif
