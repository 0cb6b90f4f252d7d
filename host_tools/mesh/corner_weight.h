/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Shares of the four corners in the area of a quadrilateral element. Over an element that is no
 * parallelogram, the area per unit of the natural coordinates xi1 and xi2 is proportional to 1 +
 * alpha_1 xi2 + alpha_2 xi1, with the skew coefficients alpha_1 and alpha_2 of the element (member
 * skew of laminate_place).
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
 * Return the difference between two values of the integral of the product of two corners' shape
 * functions over the element, divided by the element's area: the value on this element less that on
 * a parallelogram, which is 4/36, 2/36 or 1/36 for the same, neighbouring or opposite corners.
 */
double corner_pair_excess(const laminate_place *place, int first, int second);

#endif
