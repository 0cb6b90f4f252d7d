/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Shares of the four corners in the area of a quadrilateral element. Over an element that is no
 * parallelogram, the area per unit of the natural coordinates varies as 1 + alpha_1 xi2 + alpha_2
 * xi1 (laminate_place.skew).
 */
#ifndef CORNER_WEIGHT_H
#define CORNER_WEIGHT_H

#include "laminate.h"

/*
 * Return the area per unit of the natural coordinates at a corner, relative to that at the centre
 * of the element.
 */
double corner_jacobian(const laminate_place *place, int corner);

/*
 * Return the integral of the shape function of a corner over the element, divided by a quarter of
 * the element's area.
 */
double corner_share(const laminate_place *place, int corner);

/*
 * Return what the varying area adds to the integral of the product of two corners' shape functions
 * over the element, divided by the element's area. On a parallelogram this integral is 4/36, 2/36
 * or 1/36 of the area.
 */
double corner_pair_excess(const laminate_place *place, int first, int second);

#endif
