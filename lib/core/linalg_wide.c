/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Innermost loop of the factorisation A = L D L^T of symmetric matrices, for hosts with the vector
 * unit AVX2 (linalg_wide.h).
 */
#include "linalg_wide.h"
#include "unrolled.h"

#if PZS_WIDE

#define AVX2 __attribute__((target("avx2")))

/* A column of one panel: PZS_TILE matrix entries, one for each row of the panel. */
typedef pzs_real tile_column
    __attribute__((vector_size(PZS_TILE * sizeof(pzs_real)), aligned(sizeof(pzs_real)), may_alias));

bool pzs_linalg_has_wide(void)
{
    return __builtin_cpu_supports("avx2") != 0;
}

/*
 * Return the address of the matrix column that lies `count` columns before another column of a
 * panel (PZS_TILE rows).
 */
static inline const pzs_real *before(const pzs_real *at, uint32_t count)
{
    return at - (size_t)count * PZS_TILE;
}

/*
 * Step of the factorisation A = L D L^T with W = L D: subtract the sum over k of W_ik L_jk from
 * each entry i, j of a strip, PZS_TILE neighbouring columns j in one panel (PZS_TILE rows i). Here
 * k runs over the columns before the strip, without the last `rest` of them.
 */
AVX2 static void subtract_one(const wide_strip *strip, uint32_t rest, const pzs_real *lower)
{
    const pzs_real *scaled = before(strip->entry, strip->count);
    tile_column *column = (tile_column *)(void *)strip->entry;
    tile_column sum[PZS_TILE];
    lower = before(lower, strip->count);
    UNROLLED
    for (int j = 0; j < PZS_TILE; j++)
        sum[j] = column[j];
    for (uint32_t k = rest; k < strip->count; k++, scaled += PZS_TILE, lower += PZS_TILE)
        UNROLLED
    for (int j = 0; j < PZS_TILE; j++)
        sum[j] -= *(const tile_column *)(const void *)scaled * lower[j];
    UNROLLED
    for (int j = 0; j < PZS_TILE; j++)
        column[j] = sum[j];
}

/*
 * Step of the factorisation A = L D L^T with W = L D: subtract the sum over k of W_ik L_jk from
 * each entry i, j of a strip, PZS_TILE neighbouring columns j in two panels (PZS_TILE rows i each).
 * Here k runs over the last `count` columns before the strip.
 */
AVX2 static void subtract_two(const wide_strip strip[2], uint32_t count, const pzs_real *lower)
{
    const pzs_real *scaled = before(strip[0].entry, count);
    const pzs_real *other_scaled = before(strip[1].entry, count);
    tile_column *column = (tile_column *)(void *)strip[0].entry;
    tile_column *other_column = (tile_column *)(void *)strip[1].entry;
    tile_column sum[PZS_TILE], other_sum[PZS_TILE];
    lower = before(lower, count);
    UNROLLED
    for (int j = 0; j < PZS_TILE; j++) {
        sum[j] = column[j];
        other_sum[j] = other_column[j];
    }
    for (; count > 0; count--) {
        const tile_column factor = *(const tile_column *)(const void *)scaled;
        const tile_column other_factor = *(const tile_column *)(const void *)other_scaled;
        UNROLLED
        for (int j = 0; j < PZS_TILE; j++) {
            sum[j] -= factor * lower[j];
            other_sum[j] -= other_factor * lower[j];
        }
        scaled += PZS_TILE;
        other_scaled += PZS_TILE;
        lower += PZS_TILE;
    }
    UNROLLED
    for (int j = 0; j < PZS_TILE; j++) {
        column[j] = sum[j];
        other_column[j] = other_sum[j];
    }
}

/*
 * Step of the factorisation A = L D L^T with W = L D: subtract the sum over k of W_ik L_jk from
 * each entry i, j of a strip, PZS_TILE neighbouring columns j in one panel (PZS_TILE rows i). Here
 * k runs over the columns of the strip itself that come before column j.
 */
AVX2 static void subtract_own(const wide_strip *strip, const pzs_real *lower)
{
    tile_column *column = (tile_column *)(void *)strip->entry;
    UNROLLED
    for (int k = 0; k < PZS_TILE; k++)
        UNROLLED
    for (int j = k + 1; j < PZS_TILE; j++)
        column[j] -= column[k] * lower[k * PZS_TILE + j];
}

void pzs_linalg_wide(const wide_strip strip[2], const pzs_real *lower)
{
    const uint32_t common = strip[0].count < strip[1].count ? strip[0].count : strip[1].count;
    for (int panel = 0; panel < 2; panel++)
        if (strip[panel].count > common)
            subtract_one(&strip[panel], common, lower);
    subtract_two(strip, common, lower);
    for (int panel = 0; panel < 2; panel++)
        subtract_own(&strip[panel], lower);
}

#endif
