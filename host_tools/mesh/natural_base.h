/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Strains and areas at a height of an element that does not lie along lines of curvature
 * (laminate_place.is_general). Its base vectors at height z are the columns of base + z slope;
 * without the element option metric, those of the reference surface.
 */
#ifndef NATURAL_BASE_H
#define NATURAL_BASE_H

#include "laminate.h"

/* Area at height z over that of the reference surface. */
double natural_area_ratio(const scene_element *element, const laminate_place *place, double z);

/*
 * Strains in material axes from strains in the base vectors at height z: t [6][6], Voigt order 11
 * 22 33 23 13 12, engineering shears. With b the inverse of the base, e_ij = sum_ab b_ai b_bj E_ab.
 */
void natural_strain_map(const scene_element *element, const laminate_place *place, double z,
                        double t[6][6]);

#endif
