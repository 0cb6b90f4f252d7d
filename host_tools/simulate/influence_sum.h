/* SPDX-License-Identifier: BSD-2-Clause */
/* Static response of a linear structure to its inputs. */
#ifndef INFLUENCE_SUM_H
#define INFLUENCE_SUM_H

#include <stddef.h>

/*
 * Static displacements, or other outputs, of a linear structure: sum [rows] = influence
 * [rows][inputs] times input [inputs]. Each sum is computed in ascending order of the inputs, so
 * that the result has the same bits on every computer.
 */
void influence_sum(const double *influence, const double *input, size_t rows, size_t inputs,
                   double *sum);

#endif
