/*
 * Laws of lib/core/linalg.c, for every precision and tile. Build it without floating-point
 * contraction, as for all comparisons of bits:
 *
 *   gcc -std=c99 -O2 -ffp-contract=off -DPZS_REAL_BITS=32 -DPZS_TILE=4 -Iinclude \
 *       tests/unit/test_linalg.c lib/core/linalg.c -lcmocka -lm
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "../../lib/core/linalg.h"

#ifndef SEEDS
#define SEEDS 6u /* random matrices of each pattern; fewer under an emulator */
#endif
#ifndef MOST
#define MOST 300u /* rows of the largest matrix of the tests; fewer where memory is short */
#endif
#define USUAL 97u /* rows of the largest matrix of most tests */
#define GUARD 16u
#define CANARY ((pzs_real)-12345)
#define NOT_A_NUMBER ((pzs_real)NAN)
#define ENDLESS ((pzs_real)INFINITY)

typedef long double wide;

/* The patterns of the tests; band widths and skylines are drawn from the matrix's own seed. */
enum pattern { DENSE, BAND, SKYLINE, ARROW, DIAGONAL, PATTERNS };

static const uint32_t orders[] = {1,  2,  3,  PZS_TILE - 1, PZS_TILE, PZS_TILE + 1, 15,
                                  16, 17, 31, 33,           48,       64,           USUAL};
#define ORDERS (sizeof orders / sizeof *orders)

/* ---- a matrix in envelope storage, and the same dense ------------------ */

static uint16_t first[MOST];
static uint32_t start[MOST / PZS_TILE + 2u + GUARD];
static pzs_real value[(MOST + 16u) * (MOST + 32u)];
static pzs_real before[(MOST + 16u) * (MOST + 32u)];
static pzs_real inverse[MOST + GUARD];
static pzs_real dense[MOST][MOST]; /* lower triangle */
static pzs_envelope a;
static size_t reals;

static uint32_t seed;

static uint32_t draw(void)
{
    seed = seed * 1664525u + 1013904223u;
    return seed >> 8;
}

/* A multiple of 1/1024 in [-1, 1]: the same number in both precisions. */
static pzs_real draw_real(void)
{
    return (pzs_real)((int32_t)(draw() % 2049u) - 1024) / 1024;
}

static void make_pattern(enum pattern pattern, uint32_t n, uint32_t s)
{
    const uint32_t band = 1u + s * 7u % 29u;

    seed = s * 7919u + n * 31u + (uint32_t)pattern;
    for (uint32_t i = 0; i < n; i++)
        switch (pattern) {
        case BAND: first[i] = (uint16_t)(i > band ? i - band : 0u); break;
        case SKYLINE: first[i] = (uint16_t)(draw() % (i + 1u)); break;
        case ARROW: first[i] = (uint16_t)(i + 1u < n ? i : 0u); break;
        case DIAGONAL: first[i] = (uint16_t)i; break;
        default: first[i] = 0; break;
        }
    for (uint32_t i = 0; i < sizeof start / sizeof *start; i++)
        start[i] = 0xDEADu;
    for (uint32_t i = 0; i < MOST + GUARD; i++)
        inverse[i] = CANARY;
    memset(dense, 0, sizeof dense);
    a = (pzs_envelope){n, first, start, value, inverse};
    reals = pzs_linalg_reals(first, n);
    assert_true(reals < sizeof value / sizeof *value);
    value[reals] = CANARY;
    pzs_linalg_layout(&a);
    pzs_linalg_clear(&a);
    assert_true(value[reals] == CANARY);
}

/* From dense to the envelope. */
static void load(void)
{
    for (uint32_t i = 0; i < a.n; i++)
        for (uint32_t j = first[i]; j <= i; j++)
            *pzs_linalg_entry(&a, i, j) = dense[i][j];
}

static void make_random(enum pattern pattern, uint32_t n, uint32_t s)
{
    make_pattern(pattern, n, s);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = first[i]; j <= i; j++)
            dense[i][j] = draw_real();
}

/* Positive definite by dominance. */
static void make_definite(enum pattern pattern, uint32_t n, uint32_t s)
{
    make_random(pattern, n, s);
    for (uint32_t i = 0; i < n; i++)
        dense[i][i] = (pzs_real)n + draw_real();
    load();
}

/* Indefinite, pivots well away from zero: every third diagonal entry is negative. */
static void make_indefinite(enum pattern pattern, uint32_t n, uint32_t s)
{
    make_random(pattern, n, s);
    for (uint32_t i = 0; i < n; i++)
        dense[i][i] = ((i + s) % 3u == 0u ? -1 : 1) * ((pzs_real)n + draw_real());
    load();
}

/* L D L^T of small whole numbers, L in {-1, 0, 1} and D as given: the factorisation is exact. */
static pzs_real whole_l[MOST][MOST];

static void make_whole(enum pattern pattern, uint32_t n, uint32_t s, const pzs_real *d)
{
    make_pattern(pattern, n, s);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < i; j++)
            whole_l[i][j] = j < first[i] ? 0 : (pzs_real)((int)(draw() % 3u) - 1);
    for (uint32_t i = 0; i < n; i++)
        whole_l[i][i] = 1;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j <= i; j++)
            for (uint32_t k = 0; k <= j; k++)
                dense[i][j] += whole_l[i][k] * d[k] * whole_l[j][k];
    load();
}

static void make_powers(pzs_real *d, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++)
        d[i] = (pzs_real)(1u << (draw() % 3u)) * (draw() % 2u != 0u ? 1 : -1);
}

static pzs_real at(uint32_t i, uint32_t j)
{
    return j < first[i] ? 0 : *pzs_linalg_entry(&a, i, j);
}

static pzs_real larger(pzs_real x, pzs_real y)
{
    return x > y ? x : y;
}

static int same_bits(pzs_real x, pzs_real y)
{
    return memcmp(&x, &y, sizeof x) == 0;
}

/* (|L| |D| |L^T|)_ij of the factor in a. */
static wide size_of_factor(uint32_t i, uint32_t j)
{
    wide sum = 0;

    for (uint32_t k = 0; k <= (i < j ? i : j); k++) {
        const wide li = i == k ? 1 : fabsl((wide)at(i, k));
        const wide lj = j == k ? 1 : fabsl((wide)at(j, k));
        sum += li * fabsl((wide)at(k, k)) * lj;
    }
    return sum;
}

/* ---- the reference: row by row, the same products in the same order ----- */

static pzs_real ref[MOST][MOST], ref_inverse[MOST];

static void reference_factor(void)
{
    for (uint32_t i = 0; i < a.n; i++) {
        pzs_real w[MOST], d = dense[i][i];
        for (uint32_t j = first[i]; j < i; j++) {
            w[j] = dense[i][j];
            for (uint32_t k = first[i] > first[j] ? first[i] : first[j]; k < j; k++)
                w[j] -= w[k] * ref[j][k];
        }
        for (uint32_t k = first[i]; k < i; k++) {
            ref[i][k] = w[k] * ref_inverse[k];
            d -= w[k] * ref[i][k];
        }
        ref[i][i] = d;
        ref_inverse[i] = 1 / d;
    }
}

static void reference_solve(pzs_real *x)
{
    for (uint32_t i = 0; i < a.n; i++)
        for (uint32_t k = first[i]; k < i; k++)
            x[i] -= ref[i][k] * x[k];
    for (uint32_t i = 0; i < a.n; i++)
        x[i] *= ref_inverse[i];
    for (uint32_t i = a.n; i-- > 0;)
        for (uint32_t k = first[i]; k < i; k++)
            x[k] -= ref[i][k] * x[i];
}

/* ---- laws --------------------------------------------------------------- */

static void layout(void **state)
{
    /* Law: every entry has a place of its own inside pzs_linalg_reals entries, and nothing else is
     * written. */
    (void)state;
    for (size_t o = 0; o < ORDERS; o++)
        for (int p = 0; p < PATTERNS; p++) {
            size_t kept = 0, ones = 0;
            make_pattern((enum pattern)p, orders[o], 3);
            for (uint32_t i = 0; i < a.n; i++)
                for (uint32_t j = first[i]; j <= i; j++, kept++) {
                    assert_true(pzs_linalg_entry(&a, i, j) >= value &&
                                pzs_linalg_entry(&a, i, j) < value + reals);
                    *pzs_linalg_entry(&a, i, j) += 1;
                }
            for (size_t e = 0; e < reals; e++) {
                assert_true(value[e] == 0 || value[e] == 1);
                ones += value[e] == 1;
            }
            assert_true(ones == kept);
            assert_true(start[(a.n + PZS_TILE - 1u) / PZS_TILE] == reals);
            assert_true(start[(a.n + PZS_TILE - 1u) / PZS_TILE + 1u] == 0xDEADu);
        }
}

/* Compare the factor of the matrix in the envelope with the reference, bit by bit. */
static void check_bits_of_factor(void)
{
    assert_int_equal(pzs_linalg_factor(&a).zero, -1);
    reference_factor();
    for (uint32_t i = 0; i < a.n; i++) {
        assert_true(same_bits(inverse[i], ref_inverse[i]));
        for (uint32_t j = first[i]; j <= i; j++)
            assert_true(same_bits(at(i, j), ref[i][j]));
    }
    assert_true(inverse[a.n] == CANARY && value[reals] == CANARY);
}

/* Run a check on definite and indefinite matrices of all orders and patterns. */
static void check_all_matrices(void (*check)(void))
{
    for (size_t o = 0; o < ORDERS; o++)
        for (int p = 0; p < PATTERNS; p++)
            for (uint32_t s = 0; s < SEEDS; s++) {
                s % 2u ? make_definite((enum pattern)p, orders[o], s)
                       : make_indefinite((enum pattern)p, orders[o], s);
                check();
            }
}

static void bits_of_factor(void **state)
{
    /* Law: factor and pivots have the bits of the row by row reference, whatever the tile; no byte
     * beyond them. */
    (void)state;
    check_all_matrices(check_bits_of_factor);
}

static void bits_of_groups(void **state)
{
    /* Law: the factor has the bits of the reference also where the matrix has more rows than the
     * panels that are eliminated together, 16 panels of 4, 8 or 16 rows. */
    static const uint32_t large[] = {129, 200, 257, 263, MOST};
    (void)state;
    for (size_t o = 0; o < sizeof large / sizeof *large && large[o] <= MOST; o++)
        for (int p = 0; p < PATTERNS; p++) {
            make_definite((enum pattern)p, large[o], (uint32_t)o);
            check_bits_of_factor();
        }
}

static void bits_of_solution(void **state)
{
    /* Law: a solution has the bits of the row by row reference, whatever the tile; x beyond n does
     * not exist. */
    (void)state;
    for (size_t o = 0; o < ORDERS; o++)
        for (int p = 0; p < PATTERNS; p++)
            for (uint32_t s = 0; s < SEEDS; s++) {
                pzs_real x[MOST + GUARD], y[MOST];
                make_indefinite((enum pattern)p, orders[o], s);
                for (uint32_t i = 0; i < a.n; i++)
                    x[i] = y[i] = draw_real();
                for (uint32_t i = a.n; i < a.n + GUARD; i++)
                    x[i] = NOT_A_NUMBER; /* would spread if it were read */
                pzs_linalg_factor(&a);
                pzs_linalg_solve(&a, x);
                reference_factor();
                reference_solve(y);
                for (uint32_t i = 0; i < a.n; i++)
                    assert_true(same_bits(x[i], y[i]));
                for (uint32_t i = a.n; i < a.n + GUARD; i++)
                    assert_true(isnan(x[i]));
            }
}

/* FNV-1a over the bits of one number. */
static uint32_t mix(uint32_t hash, pzs_real number)
{
    unsigned char byte[sizeof number];

    memcpy(byte, &number, sizeof byte);
    for (size_t i = 0; i < sizeof byte; i++)
        hash = (hash ^ byte[i]) * 16777619u;
    return hash;
}

static void bits_everywhere(void **state)
{
    /* Law: factor, solution, norm and condition have these bits on every target, compiler and tile.
     */
    uint32_t hash = 2166136261u;

    (void)state;
    for (uint32_t n = 1; n <= USUAL; n += 7)
        for (int p = 0; p < PATTERNS; p++) {
            pzs_real x[MOST], work[3u * MOST], norm;
            make_indefinite((enum pattern)p, n, n);
            norm = pzs_linalg_norm1(&a, work);
            pzs_linalg_factor(&a);
            for (uint32_t i = 0; i < n; i++)
                x[i] = draw_real();
            pzs_linalg_solve(&a, x);
            for (uint32_t i = 0; i < n; i++) {
                hash = mix(mix(hash, x[i]), inverse[i]);
                for (uint32_t j = first[i]; j <= i; j++)
                    hash = mix(hash, at(i, j));
            }
            hash = mix(mix(hash, norm), pzs_linalg_condition(&a, norm, work));
        }
    assert_int_equal(hash, PZS_BY_BITS(0x12e70e32u, 0x7abf1047u));
}

static void factor_gives_matrix_back(void **state)
{
    /* Law: |A - L D L^T| <= (n + 4) epsilon |L| |D| |L^T| entry by entry (Higham 2002,
     * theorem 9.3). */
    (void)state;
    for (size_t o = 0; o < ORDERS; o++)
        for (int p = 0; p < PATTERNS; p++)
            for (uint32_t s = 0; s < 2; s++) {
                s ? make_definite((enum pattern)p, orders[o], s)
                  : make_indefinite((enum pattern)p, orders[o], s);
                pzs_linalg_factor(&a);
                for (uint32_t i = 0; i < a.n; i++)
                    for (uint32_t j = 0; j <= i; j++) {
                        wide sum = 0;
                        for (uint32_t k = 0; k <= j; k++)
                            sum += (i == k ? 1 : (wide)at(i, k)) * (wide)at(k, k) *
                                   (j == k ? 1 : (wide)at(j, k));
                        assert_true(fabsl(sum - (wide)dense[i][j]) <=
                                    (wide)(a.n + 4u) * (wide)PZS_EPSILON * size_of_factor(i, j));
                    }
            }
}

static void residual_of_solution(void **state)
{
    /* Law: |b - A x| <= (3 n + 8) epsilon |L| |D| |L^T| |x| entry by entry (Higham 2002,
     * theorem 9.4). */
    (void)state;
    for (size_t o = 0; o < ORDERS; o++)
        for (int p = 0; p < PATTERNS; p++)
            for (uint32_t s = 0; s < 2; s++) {
                pzs_real b[MOST], x[MOST];
                s ? make_definite((enum pattern)p, orders[o], s)
                  : make_indefinite((enum pattern)p, orders[o], s);
                for (uint32_t i = 0; i < a.n; i++)
                    x[i] = b[i] = draw_real();
                pzs_linalg_factor(&a);
                pzs_linalg_solve(&a, x);
                for (uint32_t i = 0; i < a.n; i++) {
                    wide rest = (wide)b[i], bound = 0;
                    for (uint32_t j = 0; j < a.n; j++) {
                        rest -= (wide)(j <= i ? dense[i][j] : dense[j][i]) * (wide)x[j];
                        bound += size_of_factor(i, j) * fabsl((wide)x[j]);
                    }
                    assert_true(fabsl(rest) <= (wide)(3u * a.n + 8u) * (wide)PZS_EPSILON * bound);
                }
            }
}

static void many_equal_one(void **state)
{
    /* Law: solve_many equals solve bit for bit, and leaves what lies between the right-hand sides
     * alone. */
    static pzs_real many[5][MOST + 3u];

    (void)state;
    for (size_t o = 0; o < ORDERS; o++)
        for (uint32_t count = 0; count <= 5; count++) {
            pzs_real one[5][MOST + 3u];
            make_indefinite(SKYLINE, orders[o], count);
            for (uint32_t r = 0; r < 5; r++)
                for (uint32_t i = 0; i < MOST + 3u; i++)
                    one[r][i] = many[r][i] = draw_real();
            pzs_linalg_factor(&a);
            pzs_linalg_solve_many(&a, many[0], count, MOST + 3u);
            for (uint32_t r = 0; r < count; r++)
                pzs_linalg_solve(&a, one[r]);
            assert_memory_equal(one, many, sizeof many);
        }
}

static void known_inertia(void **state)
{
    /* Law: a factorisation in whole numbers is exact: factor, pivots, their signs, the first
     * negative, the growth. */
    (void)state;
    for (size_t o = 0; o < ORDERS; o++)
        for (int p = 0; p < PATTERNS; p++)
            for (uint32_t s = 0; s < SEEDS; s++) {
                pzs_real d[MOST], pivot = 0, diagonal = 0;
                uint32_t negative = 0;
                int32_t first_negative = -1;
                linalg_inertia found;
                seed = s;
                make_powers(d, orders[o]);
                make_whole((enum pattern)p, orders[o], s, d);
                for (uint32_t i = a.n; i-- > 0;) {
                    if (d[i] < 0) {
                        negative++;
                        first_negative = (int32_t)i;
                    }
                    pivot = larger(pivot, d[i] < 0 ? -d[i] : d[i]);
                    diagonal = larger(diagonal, dense[i][i] < 0 ? -dense[i][i] : dense[i][i]);
                }
                found = pzs_linalg_factor(&a);
                assert_int_equal(found.zero, -1);
                assert_int_equal(found.negative, negative);
                assert_int_equal(found.first_negative, first_negative);
                assert_true(found.growth == pivot / diagonal);
                for (uint32_t i = 0; i < a.n; i++)
                    for (uint32_t j = first[i]; j <= i; j++)
                        assert_true(at(i, j) == (i == j ? d[i] : whole_l[i][j]));
            }
}

static void zero_pivot(void **state)
{
    /* Law: a matrix singular at a known row is reported with that row, the inertia of the rows
     * before it with it. */
    (void)state;
    for (size_t o = 0; o < ORDERS; o++)
        for (int p = 0; p < PATTERNS; p++)
            for (uint32_t row = 0; row < orders[o]; row++) {
                pzs_real d[MOST];
                uint32_t negative = 0;
                linalg_inertia found;
                seed = row;
                make_powers(d, orders[o]);
                d[row] = 0;
                make_whole((enum pattern)p, orders[o], row, d);
                for (uint32_t i = 0; i < row; i++)
                    negative += d[i] < 0;
                found = pzs_linalg_factor(&a);
                assert_int_equal(found.zero, row);
                assert_int_equal(found.negative, negative);
                assert_true(inverse[a.n] == CANARY);
            }
}

static void small_pivot(void **state)
{
    /* Law: the border is min(n epsilon, 2^-23) times the row's own diagonal entry: half of it is
     * zero, four times it is not. */
    const uint32_t n = 40;

    (void)state;
    for (uint32_t row = 0; row < n; row++)
        for (int sign = -1; sign <= 1; sign += 2)
            for (int twice = 0; twice < 2; twice++) {
                pzs_real d[MOST], border;
                linalg_inertia found;
                for (uint32_t i = 0; i < n; i++)
                    d[i] = i == row ? 0 : 1;
                make_whole(DENSE, n, row, d);
                if (dense[row][row] == 0) /* nothing left of the diagonal: any pivot but zero counts
                                             there */
                    continue;
                border = (pzs_real)fmin(n * (double)PZS_EPSILON, ldexp(1, -23)) * dense[row][row];
                *pzs_linalg_entry(&a, row, row) +=
                    (pzs_real)sign * (twice ? 4 * border : border / 2);
                found = pzs_linalg_factor(&a);
                if (twice)
                    assert_true(found.zero != (int32_t)row);
                else
                    assert_int_equal(found.zero, row);
            }
}

static void not_finite(void **state)
{
    /* Law: a NaN or an infinity in row i ends the factorisation at pivot i. */
    const pzs_real bad[] = {NOT_A_NUMBER, ENDLESS, -ENDLESS};
    const uint32_t n = 2u * PZS_TILE + 3u;

    (void)state;
    for (size_t b = 0; b < 3; b++)
        for (uint32_t i = 0; i < n; i++)
            for (uint32_t j = 0; j <= i; j++) {
                make_indefinite(DENSE, n, i + j);
                *pzs_linalg_entry(&a, i, j) = bad[b];
                assert_int_equal(pzs_linalg_factor(&a).zero, i);
            }
}

static void no_inverse(void **state)
{
    /* Law: a pivot whose inverse overflows is zero, not an infinity in the factor. */
    const pzs_real least = PZS_BY_BITS(FLT_MIN, DBL_MIN) * PZS_EPSILON;

    (void)state;
    make_pattern(DIAGONAL, 3, 0);
    for (uint32_t i = 0; i < 3; i++)
        *pzs_linalg_entry(&a, i, i) = i == 1 ? least : 1;
    assert_int_equal(pzs_linalg_factor(&a).zero, 1);
}

static void growth(void **state)
{
    /* Law: growth is largest pivot over largest diagonal entry: (1/d - d) / d for [d 1; 1 d]. */
    (void)state;
    for (int k = 1; k < 10; k++) {
        const pzs_real d = (pzs_real)ldexp(1, -k);
        linalg_inertia found;
        make_pattern(DENSE, 2, 0);
        dense[0][0] = dense[1][1] = d;
        dense[1][0] = 1;
        load();
        found = pzs_linalg_factor(&a);
        assert_int_equal(found.zero, -1);
        assert_int_equal(found.first_negative, 1);
        assert_true(found.growth == (1 / d - d) / d);
    }
}

static void scale_is_exact(void **state)
{
    /* Law: scales are powers of two, the scaled diagonal lies in [1/2, 2], and scaling back
     * restores every bit. */
    (void)state;
    for (size_t o = 0; o < ORDERS; o++)
        for (int p = 0; p < PATTERNS; p++) {
            pzs_real scale[MOST];
            make_definite((enum pattern)p, orders[o], 1);
            for (uint32_t i = 0; i < a.n; i++) {
                const int power = (int)(draw() % 61u) - 30;
                for (uint32_t j = first[i]; j <= i; j++)
                    *pzs_linalg_entry(&a, i, j) *= (pzs_real)ldexp(1, power);
            }
            memcpy(before, value, reals * sizeof *value);
            assert_int_equal(pzs_linalg_scale(&a, scale), -1);
            for (uint32_t i = 0; i < a.n; i++) {
                int exponent;
                assert_true(frexp((double)scale[i], &exponent) == 0.5);
                assert_true(at(i, i) >= (pzs_real)0.5 && at(i, i) <= 2);
                for (uint32_t j = first[i]; j <= i; j++)
                    *pzs_linalg_entry(&a, i, j) = at(i, j) / scale[i] / scale[j];
            }
            assert_memory_equal(before, value, reals * sizeof *value);
        }
}

static void scale_of_extremes(void **state)
{
    /* Law: the smallest and the largest positive numbers scale like any other. */
    const pzs_real most = PZS_BY_BITS(FLT_MAX, DBL_MAX), least = PZS_BY_BITS(FLT_MIN, DBL_MIN);
    const pzs_real d[] = {most,          least, least * PZS_EPSILON, 2,
                          (pzs_real)0.5, 1,     2 - PZS_EPSILON,     4 - 2 * PZS_EPSILON};
    pzs_real scale[8];

    (void)state;
    make_pattern(DIAGONAL, 8, 0);
    for (uint32_t i = 0; i < 8; i++)
        *pzs_linalg_entry(&a, i, i) = d[i];
    assert_int_equal(pzs_linalg_scale(&a, scale), -1);
    for (uint32_t i = 0; i < 8; i++) {
        assert_true(at(i, i) >= (pzs_real)0.5 && at(i, i) <= 2);
        assert_true(at(i, i) / scale[i] / scale[i] == d[i]);
    }
}

static void scale_refuses(void **state)
{
    /* Law: the first diagonal entry that is zero, negative or not finite is named, and the matrix
     * stays as it was. */
    const pzs_real bad[] = {0, -1, NOT_A_NUMBER, ENDLESS, -ENDLESS};

    (void)state;
    for (size_t b = 0; b < 5; b++)
        for (uint32_t row = 0; row < 20; row++) {
            pzs_real scale[MOST];
            make_definite(SKYLINE, 20, row);
            for (uint32_t i = 0; i < 20; i++)
                *pzs_linalg_entry(&a, i, i) *= 64;
            *pzs_linalg_entry(&a, row, row) = bad[b];
            *pzs_linalg_entry(&a, 19, 19) = bad[b];
            memcpy(before, value, reals * sizeof *value);
            assert_int_equal(pzs_linalg_scale(&a, scale), row);
            assert_memory_equal(before, value, reals * sizeof *value);
        }
}

static void norm(void **state)
{
    /* Law: norm1 is the largest sum of absolute values of a column; what is not finite stays so. */
    (void)state;
    for (size_t o = 0; o < ORDERS; o++)
        for (int p = 0; p < PATTERNS; p++) {
            pzs_real work[MOST];
            wide most = 0;
            make_indefinite((enum pattern)p, orders[o], 2);
            for (uint32_t j = 0; j < a.n; j++) {
                wide sum = 0;
                for (uint32_t i = 0; i < a.n; i++)
                    sum += fabsl((wide)(j <= i ? dense[i][j] : dense[j][i]));
                most = sum > most ? sum : most;
            }
            assert_true(fabsl((wide)pzs_linalg_norm1(&a, work) - most) <=
                        (wide)a.n * (wide)PZS_EPSILON * most);
            for (uint32_t i = 0; i < a.n; i++) {
                load();
                *pzs_linalg_entry(&a, i, first[i]) = NOT_A_NUMBER;
                assert_true(isnan(pzs_linalg_norm1(&a, work)));
                *pzs_linalg_entry(&a, i, first[i]) = -ENDLESS;
                assert_true(isinf(pzs_linalg_norm1(&a, work)));
            }
        }
}

/* 1-norm of the inverse of dense, by Gauss-Jordan with row exchange in the widest type. */
static wide norm_of_inverse(void)
{
    static wide m[MOST][2u * MOST];
    const uint32_t n = a.n;
    wide most = 0;

    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) {
            m[i][j] = (wide)(j <= i ? dense[i][j] : dense[j][i]);
            m[i][n + j] = i == j;
        }
    for (uint32_t c = 0; c < n; c++) {
        uint32_t best = c;
        for (uint32_t i = c + 1u; i < n; i++)
            best = fabsl(m[i][c]) > fabsl(m[best][c]) ? i : best;
        for (uint32_t j = 0; j < 2u * n; j++) {
            const wide t = m[c][j];
            m[c][j] = m[best][j];
            m[best][j] = t;
        }
        for (uint32_t i = 0; i < n; i++) {
            const wide factor = m[i][c] / m[c][c];
            if (i != c)
                for (uint32_t j = c; j < 2u * n; j++)
                    m[i][j] -= factor * m[c][j];
        }
    }
    for (uint32_t j = 0; j < n; j++) {
        wide sum = 0;
        for (uint32_t i = 0; i < n; i++)
            sum += fabsl(m[i][n + j] / m[i][i]);
        most = sum > most ? sum : most;
    }
    return most;
}

static unsigned estimates, good_estimates;

/* Compare the estimate for the matrix in dense with the truth. */
static void check_condition(void)
{
    pzs_real work[3u * MOST + GUARD], norm_a, estimate;
    wide truth, rounding;

    load();
    work[3u * a.n] = CANARY;
    norm_a = pzs_linalg_norm1(&a, work);
    truth = norm_of_inverse() * (wide)norm_a;
    rounding = 4 * (wide)a.n * (wide)PZS_EPSILON * truth; /* relative error of a solution: that of
                                                             its data times condition */
    assert_true(rounding < 0.25L);
    assert_int_equal(pzs_linalg_factor(&a).zero, -1);
    estimate = pzs_linalg_condition(&a, norm_a, work);
    assert_true(work[3u * a.n] == CANARY);
    assert_true((wide)estimate <= truth * (1 + rounding));
    assert_true((wide)estimate >= truth * (1 - rounding) / 10);
    estimates++;
    good_estimates += (wide)estimate * 3 >= truth;
}

static void condition(void **state)
{
    /* Law: the estimate is a lower bound of the 1-norm condition, within a factor of 10, of 3 in
     * nine cases of ten. */
    (void)state;
    check_all_matrices(check_condition);
    for (uint32_t n = 1; n <= PZS_BY_BITS(4u, 9u); n++) { /* Hilbert */
        make_pattern(DENSE, n, 0);
        for (uint32_t i = 0; i < n; i++)
            for (uint32_t j = 0; j <= i; j++)
                dense[i][j] = 1 / (pzs_real)(i + j + 1u);
        check_condition();
    }
    for (uint32_t n = 3; n <= USUAL; n += 5) { /* a string of springs: condition n^2, tied so that
                                                 floats can bear it */
        make_pattern(BAND, n, 0);
        for (uint32_t i = 0; i < n; i++) {
            dense[i][i] = 2 + (pzs_real)1 / 16;
            if (i > 0)
                dense[i][i - 1u] = -1;
        }
        check_condition();
    }
    assert_true(good_estimates * 10u >= estimates * 9u);
}

static void condition_of_overflow(void **state)
{
    /* Law: a factor whose solutions overflow has no finite condition. */
    pzs_real work[12];
    pzs_real estimate;

    (void)state;
    make_pattern(DENSE, 4, 0);
    for (uint32_t i = 0; i < 4; i++)
        *pzs_linalg_entry(&a, i, i) = PZS_BY_BITS(FLT_MIN, DBL_MIN);
    assert_int_equal(pzs_linalg_factor(&a).zero, -1);
    inverse[2] = ENDLESS;
    estimate = pzs_linalg_condition(&a, 1, work);
    assert_true(!(estimate <= PZS_BY_BITS(FLT_MAX, DBL_MAX)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(layout),
        cmocka_unit_test(bits_of_factor),
        cmocka_unit_test(bits_of_groups),
        cmocka_unit_test(bits_of_solution),
        cmocka_unit_test(bits_everywhere),
        cmocka_unit_test(factor_gives_matrix_back),
        cmocka_unit_test(residual_of_solution),
        cmocka_unit_test(many_equal_one),
        cmocka_unit_test(known_inertia),
        cmocka_unit_test(zero_pivot),
        cmocka_unit_test(small_pivot),
        cmocka_unit_test(not_finite),
        cmocka_unit_test(no_inverse),
        cmocka_unit_test(growth),
        cmocka_unit_test(scale_is_exact),
        cmocka_unit_test(scale_of_extremes),
        cmocka_unit_test(scale_refuses),
        cmocka_unit_test(norm),
        cmocka_unit_test(condition),
        cmocka_unit_test(condition_of_overflow),
    };

    return cmocka_run_group_tests_name("linalg", tests, NULL, NULL);
}
