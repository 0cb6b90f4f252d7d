/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Innermost loop of the factorisation L D L^T of symmetric matrices for processors with AVX2
 * (option PZS_WIDE), with the bits of the portable loop. It processes two panels of PZS_TILE matrix
 * rows together: their eight vector sums fit into the registers and are independent.
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
 * Step of the factorisation A = L D L^T with W = L D, for the PZS_TILE columns j of a strip and the
 * rows i of two panels (PZS_TILE rows each, stored column by column):
 *   W_ij = A_ij - sum over k < j of W_ik L_jk
 * The sum runs over the columns k of the strip before j, and over the strip[].count columns before
 * the strip, which also precede it in memory.
 *   strip [2]                  in/out  the strip in both panels
 *   lower [PZS_TILE][PZS_TILE] in      entries L_jk of the columns k of the strip, in the panel of
 *                                      the rows j; directly before them in memory: L_jk of earlier
 *                                      columns
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
