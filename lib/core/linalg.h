/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Symmetric linear systems in envelope storage: dense, banded and skyline matrices in one form.
 *
 * Row i of the lower triangle is stored from column first[i] to i. PZS_TILE rows form a panel. All
 * rows of a panel start at the smallest first column of its rows, rounded down to a tile. A panel
 * is stored column by column, its PZS_TILE rows side by side, which is the order in which the inner
 * kernel reads it.
 *
 * Every entry is computed by subtracting its products in ascending order, one after the other. So
 * the bits of a factor or a solution do not depend on PZS_TILE, vector width or target (with
 * floating-point contraction off).
 */
#ifndef PZS_LIB_LINALG_H
#define PZS_LIB_LINALG_H

#include "pzs_base.h"

/* Entries of value for n rows with the given first columns, padding included.  first [n] in */
size_t pzs_linalg_reals(const uint16_t *first, uint32_t n);

/*
 * Fill `start` of an envelope whose n, first and start pointers are set, and set all entries to
 * zero; set all entries to zero.
 */
void pzs_linalg_layout(pzs_envelope *matrix);
void pzs_linalg_clear(pzs_envelope *matrix);

/*
 * Lay out a dense matrix of n rows, zero.
 *   work  [PZS_DENSE(n)]           memory of its entries
 *   index [n / PZS_TILE + 2], [n]  memory of its uint32_t panel starts, then of its uint16_t first
 * columns
 */
void pzs_linalg_dense_layout(pzs_envelope *dense, uint32_t n, pzs_real *work, void *index);

/* Address of entry (i, j), first[i] <= j <= i. */
pzs_real *pzs_linalg_entry(const pzs_envelope *matrix, uint32_t i, uint32_t j);

/*
 * Scale a to unit diagonal within a factor of two: a_ij *= s_i s_j, s a power of two.
 *   scale [n] out
 * Returns -1, or the first row whose diagonal is zero, negative or not finite (a untouched).
 */
int32_t pzs_linalg_scale(pzs_envelope *matrix, pzs_real *scale);

/* a_ij *= s_i s_j.  scale [n] in */
void pzs_linalg_apply_scale(pzs_envelope *matrix, const pzs_real *scale);

/* 1-norm of the symmetric matrix.  sum [n] work */
pzs_real pzs_linalg_norm1(const pzs_envelope *matrix, pzs_real *sum);

typedef struct linalg_inertia {
    uint32_t negative;      /* pivots below zero */
    int32_t first_negative; /* row of the first one, or -1 */
    int32_t zero;    /* row of the first pivot below its tolerance or not finite, or -1: factor
                        unusable */
    pzs_real growth; /* largest |pivot| over largest |diagonal entry| before the factorisation */
} linalg_inertia;

/*
 * Factor a = L D L^T in place, L unit lower triangular, without pivoting.
 * A pivot of size at most min(n epsilon, 2^-23) times its own diagonal entry before elimination,
 * or whose inverse is not finite, is reported as zero and ends the factorisation.
 */
linalg_inertia pzs_linalg_factor(pzs_envelope *matrix);

/* x . y, summed in ascending order. */
pzs_real pzs_linalg_inner(const pzs_real *x, const pzs_real *y, uint32_t n);

/* Solve L D L^T x = b in place. x [n] in b, out solution. */
void pzs_linalg_solve(const pzs_envelope *matrix, pzs_real *x);

/* The same for `count` right-hand sides, each of n entries, `stride` apart. */
void pzs_linalg_solve_many(const pzs_envelope *matrix, pzs_real *x, uint32_t count, size_t stride);

/* 1-norm condition estimate (Hager, Higham): norm1 of the unfactored matrix, work [2 n]. */
pzs_real pzs_linalg_condition(const pzs_envelope *matrix, pzs_real norm1, pzs_real *work);

#endif
