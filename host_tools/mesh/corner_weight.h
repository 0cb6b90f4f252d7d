/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Shares of the four corners in the area of a quadrilateral element. Its area per unit of the
 * natural coordinates xi1, xi2 is proportional to 1 + alpha_1 xi2 + alpha_2 xi1. The skew
 * coefficients alpha (member skew of laminate_place) are 0 for a parallelogram.
 */
#ifndef CORNER_WEIGHT_H
#define CORNER_WEIGHT_H

#include "laminate.h"

/*
 * Return the area of an element per unit of the natural coordinates at a corner, divided by its
 * value at the centre of the element.
 */
double corner_jacobian(const laminate_place *place, int corner);

/*
 * Return the integral of the shape function of a corner over the element, divided by a quarter of
 * the element's area.
 */
double corner_share(const laminate_place *place, int corner);

/*
 * Take the integral, over an element, of the product of two corners' shape functions, divided by
 * the element's area. Return the difference of this number from its value on a parallelogram, which
 * is 4/36 for one corner with itself, 2/36 for neighbouring and 1/36 for opposite corners.
 */
double corner_pair_excess(const laminate_place *place, int first, int second);

#endif
