/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Innermost loop of the factorisation L D L^T of symmetric matrices, for hosts with the vector unit
 * AVX2 (option PZS_WIDE). Two panels, groups of PZS_TILE matrix rows, are processed together: the
 * eight sums of vectors that this takes fit into the registers and do not wait for each other. Each
 * entry is computed by the operations of the portable loop in their order, so that the bits of the
 * factors are the same.
 */
#ifndef PZS_LIB_LINALG_WIDE_H
#define PZS_LIB_LINALG_WIDE_H

#include "pzs_base.h"

/*
 * A strip: PZS_TILE neighbouring matrix columns in one panel of PZS_TILE rows. In memory, the
 * columns that have already been eliminated precede the strip.
 */
typedef struct wide_strip {
    pzs_real *entry; /* [PZS_TILE][PZS_TILE] columns of the matrix A = L D L^T, which become columns
                        of W = L D */
    uint32_t count;  /* number of columns k of W before the strip (PZS_TILE neighbouring columns j)
                        for which W_ik L_jk is subtracted from entry i, j of the strip; W = L D,
                        where A = L D L^T is factored */
} wide_strip;

#if PZS_WIDE

/*
 * Return whether this processor has the AVX2 instructions that pzs_linalg_wide, the innermost loop
 * of the factorisation of a matrix, executes.
 */
bool pzs_linalg_has_wide(void);

/*
 * Step of the factorisation A = L D L^T with W = L D: compute W_ij = A_ij - sum over k < j of W_ik
 * L_jk. Here j are the PZS_TILE columns of a strip, and i the rows of two panels (PZS_TILE rows
 * each). Panels are stored column by column, with PZS_TILE entries in each column.
 *   strip [2]                  in/out  the strip in both panels
 *   lower [PZS_TILE][PZS_TILE] in      entries L_jk of the columns k of the strip, in the panel
 *                                      whose rows are the rows j; the entries L_jk of earlier
 *                                      columns k must lie directly before them in memory
 */
void pzs_linalg_wide(const wide_strip strip[2], const pzs_real *lower);

#else

static inline bool pzs_linalg_has_wide(void)
{
    return false;
}

static inline void pzs_linalg_wide(const wide_strip strip[2], const pzs_real *lower)
{
    (void)strip;
    (void)lower;
}

#endif
#endif
