/* SPDX-License-Identifier: BSD-2-Clause */
/* Checks of data before use: checksums of tables, finite numbers, size of a workspace. */
#ifndef PZS_LIB_GUARD_H
#define PZS_LIB_GUARD_H

#include <string.h>
#include "pzs_base.h"

#define GUARD_CRC_START 0xFFFFFFFFu

/*
 * CRC-32 (reflected, polynomial EDB88320) of `bytes` bytes of data, continued from crc. The final
 * checksum is ~crc.
 */
uint32_t pzs_guard_crc(uint32_t crc, const void *data, size_t bytes);

/* Index of the first entry of value [n] that is NaN or infinite, or -1. */
int32_t pzs_guard_nonfinite(const pzs_real *value, uint32_t count);

/*
 * Check that a workspace is aligned for pzs_real and has at least `need` bytes. Returns -1 if so.
 * Otherwise returns the value of `where` for PZS_E_WORKSPACE: the number of bytes needed, at most
 * INT32_MAX.
 */
static inline int32_t guard_missing_bytes(const void *work, size_t bytes, size_t need)
{
    if (bytes >= need && (uintptr_t)work % sizeof(pzs_real) == 0)
        return -1;
    return need > INT32_MAX ? INT32_MAX : (int32_t)need;
}

/*
 * CRC of an array of `count` entries of `size` bytes, continued from crc. An absent array (NULL)
 * leaves crc unchanged.
 */
uint32_t pzs_guard_array_crc(uint32_t crc, const void *data, size_t count, size_t size);

/*
 * Replace three copies of some data by what two of them agree on, bit by bit: a bit that has
 * flipped in one copy is restored. bytes in  length of each copy, a multiple of 4
 */
void pzs_guard_vote(void *one, void *two, void *three, size_t bytes);

/* Make a truth value whose memory may be damaged true or false: any byte but 0 is true. */
static inline void guard_repair_bool(bool *flag)
{
    uint8_t byte;
    memcpy(&byte, flag, sizeof byte);
    *flag = byte != 0;
}

/* Continue a checksum with a number: every single flipped bit changes it. Cheaper than a CRC. */
static inline uint32_t guard_add(uint32_t sum, pzs_real number)
{
    uint32_t word[sizeof number / sizeof(uint32_t)];
    memcpy(word, &number, sizeof word);
    for (uint32_t k = 0; k < sizeof word / sizeof *word; k++)
        sum = (sum << 1 | sum >> 31) + word[k];
    return sum;
}

/*
 * Whether the number of entries of sparse rows is one that rows over `dof` columns can have.
 * Neither a checksum nor a check of indices may read rows of which this is not true.
 */
bool pzs_guard_rows_fit(const pzs_rows *rows, uint32_t dof);

/* CRC of sparse rows over `dof` columns, continued from crc. */
uint32_t pzs_guard_rows_crc(uint32_t crc, const pzs_rows *rows, uint32_t dof);

#endif
