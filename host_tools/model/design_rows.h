/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Limits between amplifiers as limit rows of the voltage problem: tables, voltages that keep all of
 * them, and a message that names limits without common voltages.
 */
#ifndef MODEL_DESIGN_ROWS_H
#define MODEL_DESIGN_ROWS_H

#include "design.h"

/*
 * Build the limit rows of a design whose voltage limits are known, into design->rows and
 * design->problem. Returns 0, or -1 with error filled.
 */
int design_rows_build(design *design, char *error);

/*
 * Find voltages inside voltage limits and limit rows, near the reference voltages.
 *   lower, upper [amplifiers] in   voltage limits (V)
 *   safe         [amplifiers] out  (V)
 * Returns 0, or -1 with error filled: with the names of limits that have no common voltages.
 */
int design_rows_safe(const design *design, const double *lower, const double *upper, double *safe,
                     char *error);

/* Write the name of limit row k, such as `v_1 - v_2`, to `text` of `size` bytes. */
void design_row_name(const design *design, int k, char *text, size_t size);

/* Return whether voltages [amplifiers] are at a limit of row k, up to rounding errors. */
bool design_row_binds(const design *design, int k, const double *voltage);

/* Return the number of limit rows of which voltages [amplifiers] are at a limit. */
int design_rows_active(const design *design, const double *voltage);

#endif
