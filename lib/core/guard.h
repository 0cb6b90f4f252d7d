/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Checks of data before use: checksums of tables, search for NaN and infinity, size of a workspace,
 * majority of three copies.
 */
#ifndef PZS_LIB_GUARD_H
#define PZS_LIB_GUARD_H

#include <string.h>
#include "pzs_base.h"

#define GUARD_CRC_START 0xFFFFFFFFu

/*
 * Continue a CRC-32 (reflected polynomial EDB88320) over `bytes` bytes of data. In the first call
 * crc is GUARD_CRC_START; the bitwise complement of the last result is the checksum.
 */
uint32_t pzs_guard_crc(uint32_t crc, const void *data, size_t bytes);

/* Return the index of the first of `count` values that is NaN or infinite, or -1. */
int32_t pzs_guard_nonfinite(const pzs_real *value, uint32_t count);

/*
 * Check that a workspace is aligned for pzs_real and has at least `need` bytes. Returns -1 if so,
 * and otherwise the number of bytes needed (at most INT32_MAX), which PZS_E_WORKSPACE reports in
 * info.where.
 */
static inline int32_t guard_missing_bytes(const void *work, size_t bytes, size_t need)
{
    if (bytes >= need && (uintptr_t)work % sizeof(pzs_real) == 0)
        return -1;
    return need > INT32_MAX ? INT32_MAX : (int32_t)need;
}

/*
 * Continue a CRC-32 over an array of `count` entries of `size` bytes. For an absent array (NULL)
 * the checksum is returned unchanged.
 */
uint32_t pzs_guard_array_crc(uint32_t crc, const void *data, size_t count, size_t size);

/*
 * Replace each bit of three copies of some data by the value that at least two copies have, which
 * restores a bit that has flipped in one copy. `bytes` is the length of each copy, a multiple of 4.
 */
void pzs_guard_vote(void *one, void *two, void *three, size_t bytes);

/*
 * Return the exclusive or of all 32-bit words of some data, which changes with every single flipped
 * bit. `bytes` is the length of the data, a multiple of 4.
 */
uint32_t pzs_guard_word_sum(const void *data, size_t bytes);

/*
 * Restore a bool whose memory may be damaged to a valid value: any byte other than 0 becomes true.
 */
static inline void guard_repair_bool(bool *flag)
{
    uint8_t byte;
    memcpy(&byte, flag, sizeof byte);
    *flag = byte != 0;
}

/*
 * Continue a checksum over real numbers by one number, and return it. The checksum changes with
 * every single flipped bit of `number`, and costs less than a CRC-32.
 */
static inline uint32_t guard_add(uint32_t sum, pzs_real number)
{
    uint32_t word[sizeof number / sizeof(uint32_t)];
    memcpy(word, &number, sizeof word);
    for (uint32_t k = 0; k < sizeof word / sizeof *word; k++)
        sum = (sum << 1 | sum >> 31) + word[k];
    return sum;
}

/*
 * Return whether the number of entries of sparse rows is at most the number of rows times the
 * number of columns, `dof`. A larger number shows damaged memory: neither a checksum nor a check of
 * indices may then read the entries.
 */
bool pzs_guard_rows_fit(const pzs_rows *rows, uint32_t dof);

/*
 * Continue a CRC-32 over the arrays of sparse rows, whose column indices are below `dof`: starts of
 * the rows, columns and values of the entries.
 */
uint32_t pzs_guard_rows_crc(uint32_t crc, const pzs_rows *rows, uint32_t dof);

#endif
