/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Values at scattered points, interpolated by moving least squares: around the place, a linear
 * function is fitted to the nearest points, weighted by the inverse square of their distance.
 *
 * The result is the given value at a point, exact for linear functions wherever the points span
 * their directions, and constant in a direction that they do not span.
 */
#ifndef SCATTER_H
#define SCATTER_H

#include <stddef.h>

enum { SCATTER_AXES = 3 };

typedef struct scatter scatter;

/*
 * Keep copies of points and values.
 *   axes                     in  number of coordinates of a point, 1 to 3
 *   point [count][axes]      in  finite
 *   value [count]            in  finite
 * Returns NULL where memory runs out.
 */
scatter *scatter_open(int axes, size_t count, const double *point, const double *value);
void scatter_close(scatter *scatter);

/*
 * Interpolate at a place, place [axes]. distance out: to the nearest point; NULL where it does not
 * matter.
 */
double scatter_value(const scatter *scatter, const double *place, double *distance);

/* Median distance of a point to its nearest neighbour, over at most 500 of the points. */
double scatter_spacing(const scatter *scatter);

#endif
