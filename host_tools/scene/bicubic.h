/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Bicubic spline function of x and y, fitted to values at scattered points by least squares on a
 * rectangle of equal cells. A small penalty on the second derivatives fills cells without points.
 * The function is twice continuously differentiable and reproduces linear functions.
 */
#ifndef BICUBIC_H
#define BICUBIC_H

#include <stdbool.h>
#include <stddef.h>

/* Largest number of cells of the spline function along one coordinate. */
enum { BICUBIC_CELLS = 64 };

typedef struct bicubic {
    int cells[2];          /* number of cells of the spline function along x and y */
    double from[2], to[2]; /* rectangle that contains all points to which the spline function is
                              fitted: smallest and largest x and y (unit of length of the points) */
    double *coefficient;   /* [cells[1] + 3][cells[0] + 3] coefficients of the products of cubic
                              B-splines (unit of the values) */
    unsigned *points_in; /* [cells[1]][cells[0]] number of fitted points in each cell of the spline
                            function */
    size_t points;       /* number of points that the spline function is fitted to */
    double rms, largest; /* root mean square and largest difference between the values given at the
                            points and the spline function fitted to them */
    size_t worst; /* index, from 0, of the point at which the given value differs most from the
                     fitted spline function */
} bicubic;

/* Value of a bicubic spline function at a point (x, y), with its first and second derivatives. */
typedef struct bicubic_jet {
    double value;
    double first[2];  /* derivatives of the spline function with respect to x and to y */
    double second[3]; /* second derivatives of the spline function: twice with respect to x, twice
                         with respect to y, and mixed */
} bicubic_jet;

/*
 * Fit a bicubic spline function to values at scattered points.
 *   point [count][3] in  x, y and value of each point, finite
 *   cells [2]        in  number of cells along x and y; 0: as many as give about four points to a
 *                        cell
 * Returns 0, or -1 with the function empty: memory runs out, or the points are fewer than three or
 * on a line.
 */
int bicubic_fit(bicubic *function, size_t count, const double (*point)[3], const int cells[2]);
void bicubic_free(bicubic *function);

/*
 * Return a bicubic spline function and its derivatives at a point. Outside the rectangle of the
 * fitted points the polynomials of the cells at its edge are continued.
 */
bicubic_jet bicubic_at(const bicubic *function, double x, double y);

/*
 * Return whether the point (x, y) lies among the points to which a spline function is fitted: in a
 * cell that contains one of them, or beside such a cell.
 */
bool bicubic_is_known(const bicubic *function, double x, double y);

#endif
