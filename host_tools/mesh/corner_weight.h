/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Shares of the corners r = 0..3 in the area of an element, which varies as 1 + alpha_1 xi2 +
 * alpha_2 xi1 over a quadrilateral that is not a parallelogram (laminate_place.skew).
 */
#ifndef CORNER_WEIGHT_H
#define CORNER_WEIGHT_H

#include "laminate.h"

/* Area at a corner over that at the centre: 1 + alpha_1 xi2_r + alpha_2 xi1_r. */
double corner_jacobian(const laminate_place *place, int corner);

/* Integral of the shape function N_r over the element, divided by area/4. */
double corner_share(const laminate_place *place, int corner);

/*
 * Part of the integral of N_r N_s over the element, divided by its area, that the varying area adds
 * to the 4/36, 2/36 or 1/36 of a parallelogram.
 */
double corner_pair_excess(const laminate_place *place, int first, int second);

#endif
