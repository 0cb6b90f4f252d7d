/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Symmetric linear equations in envelope storage, which covers dense, banded and skyline matrices.
 *
 *   - The envelope holds each row of the lower triangle from its first nonzero column to the
 *     diagonal.
 *   - PZS_TILE rows form a panel. All of them start at the same column, a multiple of PZS_TILE.
 *   - A panel is stored column by column, the order in which the innermost loop reads it.
 *
 * Factors and solutions have the same bits for every PZS_TILE, vector width and processor, because
 * every entry subtracts its products in ascending order. The compiler must not contract
 * floating-point operations.
 */
#ifndef PZS_LIB_LINALG_H
#define PZS_LIB_LINALG_H

#include "pzs_base.h"

/*
 * Return the number of reals that the entries of a symmetric matrix in envelope storage take,
 * padding included.
 *   first [rows] in  column of the first stored entry of each row
 */
size_t pzs_linalg_reals(const uint16_t *first, uint32_t rows);

/*
 * pzs_linalg_layout completes a matrix in envelope storage whose number of rows, first stored
 * columns and memory have been set: it computes the start of each panel (PZS_TILE rows) and sets
 * all entries to zero. pzs_linalg_clear only sets all entries to zero.
 */
void pzs_linalg_layout(pzs_envelope *matrix);
void pzs_linalg_clear(pzs_envelope *matrix);

/*
 * Initialise a symmetric matrix of `rows` rows as dense, with all entries of the lower triangle
 * stored and zero.
 *   work  [PZS_DENSE(rows)] in  memory of the entries and of the reciprocals of the pivots
 *   index                   in  memory of pzs_envelope.start, rows / PZS_TILE + 2 numbers of type
 *                               uint32_t, followed by pzs_envelope.first, `rows` numbers of type
 *                               uint16_t
 */
void pzs_linalg_dense_layout(pzs_envelope *dense, uint32_t rows, pzs_real *work, void *index);

/*
 * Return the address of entry (i, j) in the lower triangle of a symmetric matrix; column j must be
 * stored in row i.
 */
pzs_real *pzs_linalg_entry(const pzs_envelope *matrix, uint32_t i, uint32_t j);

/*
 * Scale a matrix symmetrically by powers of two, so that its diagonal entries lie between 1/2 and
 * 2: entry (i, j) is multiplied by scale[i] scale[j].
 *   scale [rows] out  the powers of two
 * Returns -1, or the first row whose diagonal entry is zero, negative or not finite; the matrix is
 * then unchanged.
 */
int32_t pzs_linalg_scale(pzs_envelope *matrix, pzs_real *scale);

/*
 * Scale a matrix symmetrically: entry (i, j) is multiplied by scale[i] scale[j].
 *   scale [rows] in  factors of the rows and columns
 */
void pzs_linalg_apply_scale(pzs_envelope *matrix, const pzs_real *scale);

/*
 * Return the 1-norm of a symmetric matrix, its largest sum of absolute values in a column.
 *   sum [rows] out  work array
 */
pzs_real pzs_linalg_norm1(const pzs_envelope *matrix, pzs_real *sum);

typedef struct linalg_inertia {
    uint32_t negative;      /* number of negative pivots in the factorisation L D L^T of a matrix */
    int32_t first_negative; /* row of the first negative pivot of the factorisation L D L^T; -1: no
                               pivot is negative */
    int32_t zero; /* row of the first pivot of the factorisation L D L^T that is below its bound or
                     not finite, which makes the factors unusable; -1: no such pivot */
    pzs_real growth; /* growth of the pivots in the factorisation L D L^T (dimensionless): largest
                        absolute pivot, divided by the largest absolute diagonal entry of the matrix
                        before the factorisation */
} linalg_inertia;

/*
 * Factor a symmetric matrix in place as L D L^T, with unit lower triangular L, without pivoting, up
 * to the first pivot that counts as zero. A pivot counts as zero if its reciprocal is not finite,
 * or its absolute value is at most
 *   min(n epsilon, 2^-23) * diagonal entry before the elimination
 *   n        number of rows
 *   epsilon  machine epsilon
 */
linalg_inertia pzs_linalg_factor(pzs_envelope *matrix);

/* Return the scalar product of two vectors, summed in ascending order. */
pzs_real pzs_linalg_inner(const pzs_real *left, const pzs_real *right, uint32_t count);

/*
 * Solve linear equations by the factors L D L^T of their matrix.
 *   vector [rows] in/out  in: right-hand side; out: solution
 */
void pzs_linalg_solve(const pzs_envelope *matrix, pzs_real *vector);

/*
 * Solve linear equations by the factors L D L^T of their matrix for `count` right-hand sides, each
 * replaced by its solution. The first entries of two successive right-hand sides are `stride` reals
 * apart.
 */
void pzs_linalg_solve_many(const pzs_envelope *matrix, pzs_real *vector, uint32_t count,
                           size_t stride);

/*
 * Estimate the condition number of a factored matrix in the 1-norm, by the method of Hager and
 * Higham.
 *   norm1          in   1-norm of the matrix before its factorisation
 *   work  [3 rows] out  work array
 */
pzs_real pzs_linalg_condition(const pzs_envelope *matrix, pzs_real norm1, pzs_real *work);

#endif
