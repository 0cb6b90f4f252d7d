/* SPDX-License-Identifier: BSD-2-Clause */
/* Cubic splines of a plane curve over the chord length between its points, interpolating or
 * smoothing. */
#ifndef SPLINE_H
#define SPLINE_H

typedef struct spline spline;

/*
 * Fit a curve to points.
 *   point     [n][2] in  in order, neighbours distinct; n >= 4, or n >= 2 with tangents
 *   tangent   [2][2] in  directions at the first and last point (any length); NULL: not-a-knot ends
 *   smoothing        in  lambda >= 0 (length^3); 0 interpolates
 * The curve minimises sum |p_i - s(t_i)|^2 + lambda integral |s''|^2 dt. Returns NULL when memory
 * runs out, two neighbours coincide or the numbers leave the range of a double. spline_free
 * releases the result.
 */
spline *spline_fit(int knots, const double (*point)[2], const double (*tangent)[2],
                   double smoothing);
void spline_free(spline *spline);

/* Return the parameter of the last point of a spline; the parameter of the first point is 0. */
double spline_length(const spline *spline);

/*
 * Return the first knot above the parameter t, at which the third derivative may be discontinuous,
 * or infinity after the last knot.
 */
double spline_next_knot(const spline *spline, double parameter);

/*
 * Compute the position and the first and second derivatives at the parameter t. Outside [0, length]
 * the first and last pieces are extrapolated.
 *   x, d1, d2  [2] out
 */
void spline_at(const spline *spline, double parameter, double x[2], double d1[2], double d2[2]);

#endif
