/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Functions for limits of weighted sums of absolute values of voltages that both the choice of
 * signs (absolute_rows.c) and the iterations of the optimiser (absolute_dual.c) use.
 */
#ifndef PZS_LIB_ABSOLUTE_ROWS_H
#define PZS_LIB_ABSOLUTE_ROWS_H

#include "row_solver.h"

/* Return the row of the tableau that belongs to the first limited sum of absolute values. */
static inline uint32_t absolute_first(const rows_run *run)
{
    return run->count - run->rows->absolute_count;
}

/*
 * Whether the bound of input i on the given side (-1 lower, 1 upper) is 0 V only because the
 * voltage must keep the sign chosen for it. With the other sign the voltage may go beyond 0 V.
 */
static inline bool absolute_is_split(const rows_run *run, uint32_t i, pzs_real side)
{
    return side < 0 ? run->optimiser->lower[i] < run->tableau->lower[i]
                    : run->optimiser->upper[i] > run->tableau->upper[i];
}

/*
 * Reverse the chosen sign of the voltage of input i, and adapt the bounds of the voltage, which
 * must keep the chosen sign. The sign (1 or -1) replaces the absolute value in limited sums of
 * absolute values: |voltage| = sign * voltage. An input that is kept at 0 V stays there. The caller
 * must then call pzs_absolute_renew for the tableau of the optimiser.
 */
void pzs_absolute_reverse(const rows_run *run, uint32_t i);

/*
 * Compute the slope f of each input: limits of sums of absolute values of voltages act like a term
 * f * |voltage| in half the objective. It is the sum of (weight of the input * absolute value of
 * the multiplier) over these limits.
 *   multiplier [inputs + rows] in   multipliers of the limits (m2/V), 0 for inactive limits
 *   slope      [inputs]        out  slope f of each input (m2/V)
 */
void pzs_absolute_slopes(const rows_run *run, const pzs_real *multiplier, pzs_real *slope);

/* Set the multipliers of all limited sums of absolute values that are not active to zero. */
void pzs_absolute_clear(const rows_run *run);

/*
 * After chosen signs of voltages have changed, compute anew what limited sums of absolute values
 * contribute to the optimiser: their rows in its tableau and, for active limits, in the Cholesky
 * factor. All limits keep their multipliers. An active limit becomes inactive only if it now
 * depends linearly on others.
 */
void pzs_absolute_renew(const rows_run *run);

/*
 * Return the largest number of multiply-adds of one call of pzs_absolute_renew and one of
 * pzs_absolute_slopes.
 */
uint64_t pzs_absolute_renew_work(const rows_run *run);

/*
 * Make the iterations of the dual active-set method where sums of absolute values of voltages are
 * limited (absolute_dual.c). Returns false if they end before all voltages and sums are inside
 * their bounds.
 *   rounding in  multipliers whose sign is wrong by no more than this count as right (m2/V)
 */
bool pzs_iterate_absolute(pzs_control *control, pzs_real rounding);

#endif
