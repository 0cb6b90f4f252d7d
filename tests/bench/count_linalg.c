/*
 * Instructions of factor and solve on a Cortex-M: n = 200, half bandwidth 48, 197,176 multiply-adds
 * in the unpadded band. Runs on a board of firmware_demo under QEMU, or on the host to compare the
 * bits.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <string.h>
#include "../../firmware_demo/boards/board.h"
#include "../../lib/core/guard.h"
#include "../../lib/core/linalg.h"
#include "../../firmware_demo/demos/print.h"

#define N 200u
#define BAND 48u
#define REALS ((N + 15u) * (BAND + 32u))

static uint16_t first[N];
static uint32_t start[N / PZS_TILE + 2u];
static pzs_real value[REALS], inverse[N], x[N];

static void fill(pzs_envelope *matrix)
{
    for (uint32_t i = 0; i < N; i++)
        first[i] = (uint16_t)(i > BAND ? i - BAND : 0u);
    pzs_linalg_layout(matrix);
    pzs_linalg_clear(matrix);
    for (uint32_t i = 0; i < N; i++) {
        for (uint32_t j = first[i]; j <= i; j++)
            *pzs_linalg_entry(matrix, i, j) =
                i == j ? (pzs_real)(2u * BAND) : (pzs_real)((i * 37u + j * 101u) % 257u) / 128 - 1;
        x[i] = (pzs_real)(i % 7u) - 3;
    }
}

/* Over the factor's entries, not its padding, so that every tile gives the same. */
static uint32_t factor_crc(const pzs_envelope *matrix)
{
    uint32_t crc = GUARD_CRC_START;
    for (uint32_t i = 0; i < N; i++)
        for (uint32_t j = first[i]; j <= i; j++)
            crc = pzs_guard_crc(crc, pzs_linalg_entry(matrix, i, j), sizeof(pzs_real));
    return ~crc;
}

int main(void)
{
    pzs_envelope matrix = {N, first, start, value, inverse};
    board_start();
    fill(&matrix);
    const uint32_t begin = board_count();
    const linalg_inertia found = pzs_linalg_factor(&matrix);
    const uint32_t factored = board_count();
    pzs_linalg_solve(&matrix, x);
    const uint32_t solved = board_count();
    print_text("count");
    print_count("factor", board_instructions(begin, factored));
    print_count("solve", board_instructions(factored, solved));
    print_text("\nbits");
    print_hex("factor", factor_crc(&matrix));
    print_hex("solution", ~pzs_guard_crc(GUARD_CRC_START, x, sizeof x));
    print_text("\n");
    return found.zero >= 0;
}
