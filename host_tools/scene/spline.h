/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Cubic splines of a plane curve over the chord length between its points: interpolating or
 * smoothing.
 */
#ifndef SPLINE_H
#define SPLINE_H

typedef struct spline spline;

/*
 * Fit a cubic spline curve s(t) to points p_i, with t the chord length from the first point. The
 * curve minimises
 *   sum |p_i - s(t_i)|^2 + lambda integral |s''|^2 dt
 *   point      [knots][2] in  points p_i in order, neighbours distinct; at least 4, or 2 with
 *       tangents
 *   tangent    [2][2]     in  directions at the first and the last point, of any length; NULL:
 *       not-a-knot (third derivative continuous at the second and the last but one point)
 *   smoothing             in  lambda >= 0 (length^3); 0: the curve interpolates the points
 * Returns the curve, to be released with spline_free, or NULL when memory runs out, two neighbours
 * coincide or the numbers leave the range of a double.
 */
spline *spline_fit(int knots, const double (*point)[2], const double (*tangent)[2],
                   double smoothing);
void spline_free(spline *spline);

/*
 * Return the parameter of the last point of a spline, its total chord length; the parameter of the
 * first point is 0.
 */
double spline_length(const spline *spline);

/*
 * Return the first knot above a parameter, or infinity beyond the last knot. The third derivative
 * of the spline may jump at a knot.
 */
double spline_next_knot(const spline *spline, double parameter);

/*
 * Compute the position x and the first and second derivatives d1 and d2 of a spline at a parameter.
 * Outside the range of the knots the first and the last piece are extrapolated.
 *   x, d1, d2  [2] out  point, first and second derivative
 */
void spline_at(const spline *spline, double parameter, double x[2], double d1[2], double d2[2]);

#endif
