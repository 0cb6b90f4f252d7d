/* SPDX-License-Identifier: BSD-2-Clause */
/* Gauss-Legendre quadrature with eight points over an interval. */
#ifndef GAUSS_H
#define GAUSS_H

enum { GAUSS_POINTS = 8 };

/* A point of the quadrature: the integral is the sum of weight times the function at `place`. */
typedef struct gauss_point {
    double place;  /* coordinate, in the unit of the ends of the interval */
    double weight; /* part of the length of the interval, in the same unit */
} gauss_point;

/*
 * Point number i of the quadrature from `from` to `to`, for i from 0 to GAUSS_POINTS - 1. The rule
 * is exact for polynomials of degree 15.
 */
gauss_point gauss_point_at(int i, double from, double to);

#endif
