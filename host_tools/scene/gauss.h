/* SPDX-License-Identifier: BSD-2-Clause */
/* Gauss-Legendre quadrature with eight points over an interval. */
#ifndef GAUSS_H
#define GAUSS_H

enum { GAUSS_POINTS = 8 };

/*
 * Point of the quadrature rule. The integral of a function is the sum over all points of `weight`
 * times the function at `place`.
 */
typedef struct gauss_point {
    double place;  /* coordinate of the quadrature point in the interval, in the same unit as the
                      ends of the interval */
    double weight; /* weight of the point, in the unit of the interval; the weights add up to its
                      length */
} gauss_point;

/*
 * Return point number i (0 to GAUSS_POINTS - 1) of the quadrature rule for the interval from `from`
 * to `to`. The rule is exact for polynomials up to degree 15.
 */
gauss_point gauss_point_at(int i, double from, double to);

#endif
