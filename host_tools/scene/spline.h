/* Cubic splines of a plane curve over the chord length between its points, interpolating or
 * smoothing. */
#ifndef SPLINE_H
#define SPLINE_H

typedef struct spline spline;

/*
 * Fit a curve to points.
 *   point      [n][2]  in   in order, no two neighbours equal; n >= 4, or n >= 2 with tangents
 *   tangent    [2][2]  in   directions at the first and last point (any length), or NULL:
 * not-a-knot ends smoothing          in   lambda >= 0 of sum |p_i - s(t_i)|^2 + lambda integral
 * |s''|^2 dt, in length^3; 0 interpolates Returns NULL when memory runs out, two neighbours
 * coincide or the numbers leave the range of a double; spline_free releases it.
 */
spline *spline_fit(int n, const double (*point)[2], const double (*tangent)[2], double smoothing);
void spline_free(spline *spline);

/* Parameter of the last point; the first has 0. */
double spline_length(const spline *spline);

/* The first knot above t, where the third derivative may jump; infinite after the last one. */
double spline_next_knot(const spline *spline, double t);

/* Position, first, second derivative at t (outside [0, length] the end pieces go on). [2] out each
 */
void spline_at(const spline *spline, double t, double x[2], double d1[2], double d2[2]);

#endif
