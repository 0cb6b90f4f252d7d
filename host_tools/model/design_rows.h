/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Limits between amplifiers, such as the difference of two voltages, as limit rows: limits of
 * weighted sums of voltages in the least-squares problem. This file makes their tables, finds
 * voltages that obey all of them, and names contradictory limits in a message.
 */
#ifndef MODEL_DESIGN_ROWS_H
#define MODEL_DESIGN_ROWS_H

#include "design.h"

/*
 * Build the limit rows (limits of weighted sums of voltages) of a scene into design->rows and
 * design->problem. The voltage limits of the amplifiers must be known. Returns 0, or -1 with error
 * filled.
 */
int design_rows_build(design *design, char *error);

/*
 * Find voltages near the reference voltages, to which the regularisation draws the optimum, that
 * obey all voltage limits and limit rows (limits of sums of voltages).
 *   lower, upper [amplifiers] in   voltage limits (V)
 *   safe         [amplifiers] out  the voltages found (V)
 * Returns 0, or -1 with error filled; the error names limits that contradict each other.
 */
int design_rows_safe(const design *design, const double *lower, const double *upper, double *safe,
                     char *error);

/*
 * Return the first limit row (limit of a weighted sum of voltages) that voltages [amplifiers]
 * violate or nearly reach; -1 if there is none. Nearly means that rounding in single precision
 * might violate the limit.
 */
int design_rows_violated(const design *design, const double *voltage);

/*
 * Write the name of limit row k, a limit of a weighted sum of voltages, such as `v_1 - v_2`, to
 * `text` of `size` bytes.
 */
void design_row_name(const design *design, int k, char *text, size_t size);

/*
 * Write the limits of limit row k (limit of a weighted sum of voltages), such as `from -1 to 1`, or
 * `up to 1` for a sum of absolute values, to `text` of `size` bytes.
 */
void design_row_range(const design *design, int k, char *text, size_t size);

/*
 * Return whether voltages [amplifiers] reach the lower or upper limit of limit row k (limit of a
 * weighted sum of voltages), except for rounding errors.
 */
bool design_row_binds(const design *design, int k, const double *voltage);

/*
 * Return the number of limit rows (limits of weighted sums of voltages) whose lower or upper limit
 * the voltages [amplifiers] reach.
 */
int design_rows_active(const design *design, const double *voltage);

#endif
