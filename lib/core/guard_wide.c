/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * CRC-32 of long arrays by products of polynomials over the field of two
 * elements (guard_wide.h, Gopal et al., Fast CRC Computation Using PCLMULQDQ,
 * Intel 2009).
 */
#include "guard_wide.h"
#include <string.h>
#include "unrolled.h"

#if PZS_WIDE

#define AHEAD 2048u /* bytes of data fetched into the cache before the checksum reaches them */
#define PCLMUL __attribute__((target("pclmul,sse2")))

/*
 * A polynomial over the field of two elements with 128 coefficients (one bit each), the highest one
 * in the lowest bit.
 */
typedef long long polynomial __attribute__((vector_size(16)));

/* Two neighbouring numbers of an array, in one register of the processor. */
typedef pzs_real real_pair __attribute__((vector_size(16), aligned(sizeof(pzs_real)), may_alias));

bool pzs_guard_has_fold(void)
{
    return __builtin_cpu_supports("pclmul") != 0;
}

static inline polynomial load(const uint8_t *data)
{
    polynomial value;
    memcpy(&value, data, sizeof value);
    return value;
}

/*
 * Multiply a polynomial of a CRC-32 by x^n, modulo the polynomial of the CRC-32. In the CRC-32 of
 * an array, the product added to the data n bits later has the same effect as the value in its own
 * place, so that long data can be folded onto later data.
 *   factor in  powers of x modulo the CRC-32 polynomial, by which the lower and the upper 64 bits
 *              of `value` are multiplied; they determine n
 */
PCLMUL static inline polynomial move(polynomial value, polynomial factor)
{
    return __builtin_ia32_pclmulqdq128(value, factor, 0x00) ^
           __builtin_ia32_pclmulqdq128(value, factor, 0x11);
}

PCLMUL void pzs_wide_fold(uint8_t rest[CRC_REST], uint32_t crc, const uint8_t *data, size_t bytes)
{
    /*
     * factor for the function `move` that folds data onto the data CRC_BLOCK bytes later, which is
     * the distance of one step
     */
    const polynomial over_block = {0x154442bd4, 0x1c6e41596};
    /*
     * factor for the function `move` that folds CRC_REST bytes onto the next CRC_REST bytes; at the
     * end it joins the remaining parts (array `part`) into one
     */
    const polynomial over_rest = {0x1751997d0, 0x0ccaa009e};
    const polynomial start = {(long long)crc, 0};
    polynomial part[4];
    for (unsigned k = 0; k < 4u; k++)
        part[k] = load(data + k * CRC_REST);
    part[0] ^= start;
    for (size_t i = CRC_BLOCK; i < bytes; i += CRC_BLOCK) {
        __builtin_prefetch(data + i + AHEAD);
        UNROLLED
        for (unsigned k = 0; k < 4u; k++)
            part[k] = move(part[k], over_block) ^ load(data + i + k * CRC_REST);
    }
    for (unsigned k = 1; k < 4u; k++)
        part[k] ^= move(part[k - 1u], over_rest);
    memcpy(rest, &part[3], CRC_REST);
}

/*
 * A number minus itself is 0 if the number is finite, otherwise NaN. NaN stays in a sum, so that
 * one test of the sum suffices for the whole array.
 */
bool pzs_wide_is_finite(const pzs_real *value, size_t count)
{
    real_pair sum[4] = {{0}, {0}, {0}, {0}};
    for (size_t i = 0; i < count; i += FINITE_BLOCK) {
        UNROLLED
        for (unsigned k = 0; k < 4u; k++) {
            const real_pair pair = *(const real_pair *)(value + i + 2u * k);
            sum[k] += pair - pair;
        }
    }
    const real_pair all = (sum[0] + sum[1]) + (sum[2] + sum[3]);
    return all[0] + all[1] <= 0;
}

#endif
