/* SPDX-License-Identifier: BSD-2-Clause */
/* Checksums, search for numbers that are not finite, and majority of three copies (guard.h). */
#include "guard.h"
#include "guard_wide.h"
#include "unrolled.h"

/*
 * Remainders of the CRC-32 of a 32-bit word in which only one group of four bits is not zero: one
 * row for each of the eight groups, the lowest bits first, and one column for each of the 16 values
 * of the group. The table takes 512 bytes of flash; a table for whole bytes would take 4 KB.
 */
static const uint32_t nibble_crc[8][16] = {
    {0x00000000u, 0xB8BC6765u, 0xAA09C88Bu, 0x12B5AFEEu, 0x8F629757u, 0x37DEF032u, 0x256B5FDCu,
     0x9DD738B9u, 0xC5B428EFu, 0x7D084F8Au, 0x6FBDE064u, 0xD7018701u, 0x4AD6BFB8u, 0xF26AD8DDu,
     0xE0DF7733u, 0x58631056u},
    {0x00000000u, 0x5019579Fu, 0xA032AF3Eu, 0xF02BF8A1u, 0x9B14583Du, 0xCB0D0FA2u, 0x3B26F703u,
     0x6B3FA09Cu, 0xED59B63Bu, 0xBD40E1A4u, 0x4D6B1905u, 0x1D724E9Au, 0x764DEE06u, 0x2654B999u,
     0xD67F4138u, 0x866616A7u},
    {0x00000000u, 0x01C26A37u, 0x0384D46Eu, 0x0246BE59u, 0x0709A8DCu, 0x06CBC2EBu, 0x048D7CB2u,
     0x054F1685u, 0x0E1351B8u, 0x0FD13B8Fu, 0x0D9785D6u, 0x0C55EFE1u, 0x091AF964u, 0x08D89353u,
     0x0A9E2D0Au, 0x0B5C473Du},
    {0x00000000u, 0x1C26A370u, 0x384D46E0u, 0x246BE590u, 0x709A8DC0u, 0x6CBC2EB0u, 0x48D7CB20u,
     0x54F16850u, 0xE1351B80u, 0xFD13B8F0u, 0xD9785D60u, 0xC55EFE10u, 0x91AF9640u, 0x8D893530u,
     0xA9E2D0A0u, 0xB5C473D0u},
    {0x00000000u, 0x191B3141u, 0x32366282u, 0x2B2D53C3u, 0x646CC504u, 0x7D77F445u, 0x565AA786u,
     0x4F4196C7u, 0xC8D98A08u, 0xD1C2BB49u, 0xFAEFE88Au, 0xE3F4D9CBu, 0xACB54F0Cu, 0xB5AE7E4Du,
     0x9E832D8Eu, 0x87981CCFu},
    {0x00000000u, 0x4AC21251u, 0x958424A2u, 0xDF4636F3u, 0xF0794F05u, 0xBABB5D54u, 0x65FD6BA7u,
     0x2F3F79F6u, 0x3B83984Bu, 0x71418A1Au, 0xAE07BCE9u, 0xE4C5AEB8u, 0xCBFAD74Eu, 0x8138C51Fu,
     0x5E7EF3ECu, 0x14BCE1BDu},
    {0x00000000u, 0x77073096u, 0xEE0E612Cu, 0x990951BAu, 0x076DC419u, 0x706AF48Fu, 0xE963A535u,
     0x9E6495A3u, 0x0EDB8832u, 0x79DCB8A4u, 0xE0D5E91Eu, 0x97D2D988u, 0x09B64C2Bu, 0x7EB17CBDu,
     0xE7B82D07u, 0x90BF1D91u},
    {0x00000000u, 0x1DB71064u, 0x3B6E20C8u, 0x26D930ACu, 0x76DC4190u, 0x6B6B51F4u, 0x4DB26158u,
     0x5005713Cu, 0xEDB88320u, 0xF00F9344u, 0xD6D6A3E8u, 0xCB61B38Cu, 0x9B64C2B0u, 0x86D3D2D4u,
     0xA00AE278u, 0xBDBDF21Cu},
};

/* Return the CRC-32 remainder of one 32-bit word, by table look-ups for its groups of four bits. */
static inline uint32_t word_crc(uint32_t word)
{
    uint32_t crc = 0;
    UNROLLED
    for (unsigned k = 0; k < 8u; k++)
        crc ^= nibble_crc[k][word >> 4u * k & 15u];
    return crc;
}

/* Continue a CRC-32 over bytes, four bytes at a time. */
static uint32_t add_bytes(uint32_t crc, const uint8_t *byte, size_t bytes)
{
    size_t i = 0;
    for (; i + 4u <= bytes; i += 4u) {
        const uint32_t low = byte[i] | (uint32_t)byte[i + 1u] << 8;
        const uint32_t high = byte[i + 2u] | (uint32_t)byte[i + 3u] << 8;
        crc = word_crc(crc ^ (low | high << 16));
    }
    for (; i < bytes; i++) {
        crc ^= byte[i];
        crc = (crc >> 8) ^ nibble_crc[6][crc & 15u] ^ nibble_crc[7][crc >> 4 & 15u];
    }
    return crc;
}

uint32_t pzs_guard_crc(uint32_t crc, const void *data, size_t bytes)
{
    const size_t folded = bytes / CRC_BLOCK * CRC_BLOCK;
    uint8_t rest[CRC_REST];
    if (folded == 0 || !pzs_guard_has_fold())
        return add_bytes(crc, data, bytes);
    pzs_wide_fold(rest, crc, data, folded);
    return add_bytes(add_bytes(0, rest, CRC_REST), (const uint8_t *)data + folded, bytes - folded);
}

/*
 * Add up the differences of each number and itself: 0 for a finite number, NaN for NaN or infinity.
 * This needs no classification of numbers.
 */
int32_t pzs_guard_nonfinite(const pzs_real *value, uint32_t count)
{
    const uint32_t blocks = count / FINITE_BLOCK * FINITE_BLOCK;
    for (uint32_t i = PZS_WIDE && pzs_wide_is_finite(value, blocks) ? blocks : 0; i < count; i++) {
        const pzs_real none = value[i] - value[i];
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

/*
 * The array `start` of sparse rows holds the index of the first entry of each row; its last element
 * is the number of all entries. Therefore the checksum covers `start` before the arrays of entries.
 */
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

static inline uint32_t word_at(const uint8_t *at)
{
    uint32_t word;
    memcpy(&word, at, sizeof word);
    return word;
}

/* Size of the four words that an iteration of a loop over words reads (bytes). */
#define FOUR_WORDS 16u

uint32_t pzs_guard_word_sum(const void *data, size_t bytes)
{
    const uint8_t *at = data, *const end = at + bytes;
    uint32_t sum = 0;
    for (; at + FOUR_WORDS <= end; at += FOUR_WORDS)
        sum ^= word_at(at) ^ word_at(at + 4) ^ word_at(at + 8) ^ word_at(at + 12);
    for (; at < end; at += sizeof sum)
        sum ^= word_at(at);
    return sum;
}

/* Return the bits in which three copies of a word differ. */
static inline uint32_t difference(const uint8_t *first, const uint8_t *second, const uint8_t *third)
{
    const uint32_t word = word_at(first);
    return (word ^ word_at(second)) | (word ^ word_at(third));
}

/* Replace each bit of three copies of some words by the value that at least two copies have. */
static void vote_words(uint8_t *first, uint8_t *second, uint8_t *third, size_t bytes)
{
    for (size_t i = 0; i < bytes; i += sizeof(uint32_t)) {
        const uint32_t one = word_at(first + i), two = word_at(second + i);
        const uint32_t most = (one & two) | ((one | two) & word_at(third + i));
        memcpy(first + i, &most, sizeof most);
        memcpy(second + i, &most, sizeof most);
        memcpy(third + i, &most, sizeof most);
    }
}

void pzs_guard_vote(void *one, void *two, void *three, size_t bytes)
{
    uint8_t *first = one, *second = two, *third = three;
    const uint8_t *const end = first + bytes;
    for (; first + FOUR_WORDS <= end;
         first += FOUR_WORDS, second += FOUR_WORDS, third += FOUR_WORDS) {
        uint32_t wrong = 0;
        UNROLLED
        for (size_t k = 0; k < FOUR_WORDS; k += sizeof wrong)
            wrong |= difference(first + k, second + k, third + k);
        if (wrong != 0)
            vote_words(first, second, third, FOUR_WORDS);
    }
    vote_words(first, second, third, (size_t)(end - first));
}
