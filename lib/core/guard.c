/* SPDX-License-Identifier: BSD-2-Clause */
/* Checksums and tests for finite numbers (guard.h). */
#include "guard.h"

/*
 * CRC remainders of the upper and of the lower four bits of a byte. Two tables of 16 entries take
 * 128 bytes of flash instead of the 1 KB of one table of 256.
 */
static const uint32_t upper_half[16] = {
    0x00000000u, 0x1DB71064u, 0x3B6E20C8u, 0x26D930ACu, 0x76DC4190u, 0x6B6B51F4u,
    0x4DB26158u, 0x5005713Cu, 0xEDB88320u, 0xF00F9344u, 0xD6D6A3E8u, 0xCB61B38Cu,
    0x9B64C2B0u, 0x86D3D2D4u, 0xA00AE278u, 0xBDBDF21Cu,
};
static const uint32_t lower_half[16] = {
    0x00000000u, 0x77073096u, 0xEE0E612Cu, 0x990951BAu, 0x076DC419u, 0x706AF48Fu,
    0xE963A535u, 0x9E6495A3u, 0x0EDB8832u, 0x79DCB8A4u, 0xE0D5E91Eu, 0x97D2D988u,
    0x09B64C2Bu, 0x7EB17CBDu, 0xE7B82D07u, 0x90BF1D91u,
};

uint32_t pzs_guard_crc(uint32_t crc, const void *data, size_t bytes)
{
    const uint8_t *byte = data;
    for (size_t i = 0; i < bytes; i++) {
        crc ^= byte[i];
        crc = (crc >> 8) ^ lower_half[crc & 15u] ^ upper_half[crc >> 4 & 15u];
    }
    return crc;
}

/* x - x is 0 for a finite number, and NaN for NaN and the infinities. */
int32_t pzs_guard_nonfinite(const pzs_real *x, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) {
        const pzs_real none = x[i] - x[i];
        if (!(none <= 0))
            return (int32_t)i;
    }
    return -1;
}

uint32_t pzs_guard_array_crc(uint32_t crc, const void *data, size_t count, size_t size)
{
    return data != NULL ? pzs_guard_crc(crc, data, count * size) : crc;
}

bool pzs_guard_rows_fit(const pzs_rows *rows, uint32_t dof)
{
    return rows->start == NULL || rows->start[rows->count] <= (uint32_t)rows->count * dof;
}

/* The number of entries is part of the table itself, so `start` is hashed first. */
uint32_t pzs_guard_rows_crc(uint32_t crc, const pzs_rows *rows, uint32_t dof)
{
    if (rows->start == NULL)
        return crc;
    crc = pzs_guard_crc(crc, rows->start, ((size_t)rows->count + 1u) * sizeof rows->start[0]);
    if (!pzs_guard_rows_fit(rows, dof))
        return ~crc;
    const uint32_t entries = rows->start[rows->count];
    crc = pzs_guard_array_crc(crc, rows->dof, entries, sizeof rows->dof[0]);
    return pzs_guard_array_crc(crc, rows->value, entries, sizeof rows->value[0]);
}

void pzs_guard_vote(void *one, void *two, void *three, size_t bytes)
{
    uint8_t *x = one, *y = two, *z = three;
    const uint8_t *const end = x + bytes;
    for (; x < end; x += sizeof(uint32_t), y += sizeof(uint32_t), z += sizeof(uint32_t)) {
        uint32_t a, b, c;
        memcpy(&a, x, sizeof a);
        memcpy(&b, y, sizeof b);
        memcpy(&c, z, sizeof c);
        if (a == b && b == c)
            continue;
        const uint32_t most = (a & b) | (a & c) | (b & c);
        memcpy(x, &most, sizeof most);
        memcpy(y, &most, sizeof most);
        memcpy(z, &most, sizeof most);
    }
}
