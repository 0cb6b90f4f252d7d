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

/*
 * Number of reals that the entries of an envelope take, padding included.
 *   first [n]  in  first column of each row
 */
size_t pzs_linalg_reals(const uint16_t *first, uint32_t rows);

/*
 * Lay out an envelope whose n, first and start pointers are set: compute the panel starts and set
 * all entries to zero. pzs_linalg_clear only sets all entries to zero.
 */
void pzs_linalg_layout(pzs_envelope *matrix);
void pzs_linalg_clear(pzs_envelope *matrix);

/*
 * Lay out a dense matrix of n rows, with all entries zero.
 *   work  [PZS_DENSE(n)]           memory of the entries
 *   index [n / PZS_TILE + 2], [n]  memory of the panel starts (uint32_t), followed by the
 *                                  first columns (uint16_t)
 */
void pzs_linalg_dense_layout(pzs_envelope *dense, uint32_t rows, pzs_real *work, void *index);

/* Address of entry (i, j), first[i] <= j <= i. */
pzs_real *pzs_linalg_entry(const pzs_envelope *matrix, uint32_t i, uint32_t j);

/*
 * Scale a to unit diagonal within a factor of two: a_ij *= s_i s_j, s a power of two.
 *   scale [n] out
 * Returns -1, or the first row whose diagonal is zero, negative or not finite (a untouched).
 */
int32_t pzs_linalg_scale(pzs_envelope *matrix, pzs_real *scale);

/*
 * Apply a given scale: a_ij *= s_i s_j.
 *   scale [n]  in
 */
void pzs_linalg_apply_scale(pzs_envelope *matrix, const pzs_real *scale);

/* 1-norm of the symmetric matrix.  sum [n] work */
pzs_real pzs_linalg_norm1(const pzs_envelope *matrix, pzs_real *sum);

typedef struct linalg_inertia {
    uint32_t negative;      /* number of pivots below zero */
    int32_t first_negative; /* row of the first pivot below zero, or -1: none */
    int32_t zero; /* row of the first pivot that is below its tolerance or not finite: the factor is
                     then unusable; -1: none */
    pzs_real growth; /* largest |pivot| divided by the largest |diagonal entry| before the
                        factorisation */
} linalg_inertia;

/*
 * Factor a = L D L^T in place, L unit lower triangular, without pivoting.
 * A pivot of size at most min(n epsilon, 2^-23) times its own diagonal entry before elimination,
 * or whose inverse is not finite, is reported as zero and ends the factorisation.
 */
linalg_inertia pzs_linalg_factor(pzs_envelope *matrix);

/* x . y, summed in ascending order. */
pzs_real pzs_linalg_inner(const pzs_real *left, const pzs_real *right, uint32_t count);

/* Solve L D L^T x = b in place. vector [n] in b, out solution. */
void pzs_linalg_solve(const pzs_envelope *matrix, pzs_real *vector);

/*
 * Solve L D L^T x = b in place for `count` right-hand sides x of n entries each, whose first
 * entries are `stride` apart.
 */
void pzs_linalg_solve_many(const pzs_envelope *matrix, pzs_real *vector, uint32_t count,
                           size_t stride);

/*
 * Estimate the condition number in the 1-norm (Hager, Higham) from the factor.
 *   norm1       in    1-norm of the matrix before its factorisation
 *   work [2 n]  work
 */
pzs_real pzs_linalg_condition(const pzs_envelope *matrix, pzs_real norm1, pzs_real *work);

#endif
