/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Interpolation between values at scattered points by moving least squares: a linear function
 * fitted to the nearest points, with weights 1/distance^2. It equals the value at a point, is exact
 * for linear functions in directions that the points span, and constant in others.
 */
#ifndef SCATTER_H
#define SCATTER_H

#include <stddef.h>

enum { SCATTER_AXES = 3 };

typedef struct scatter scatter;

/*
 * Make an interpolation (k-d tree) from copies of scattered points and their values.
 *   axes   in                 number of coordinates of a point, 1 to 3
 *   point  [count][axes] in   coordinates of the points, finite
 *   value  [count] in         values at the points, finite
 * Returns NULL when memory runs out; otherwise scatter_close releases the result.
 */
scatter *scatter_open(int axes, size_t count, const double *point, const double *value);
void scatter_close(scatter *scatter);

/*
 * Return the value, at a place [axes], of the linear function that is fitted to the nearest
 * scattered points. If `distance` is not NULL, *distance becomes the distance to the nearest of
 * these points.
 */
double scatter_value(const scatter *scatter, const double *place, double *distance);

/* Return the median distance of a point to its nearest neighbour, over at most 500 points. */
double scatter_spacing(const scatter *scatter);

#endif
