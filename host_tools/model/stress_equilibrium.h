/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Transverse shear stresses and normal stress 33 from equilibrium through the thickness. Without
 * body forces, in the directions 1 and 2 of the principal curvatures,
 *   d(c_1^2 c_2 s_13)/dz = -c_1^2 c_2 (s_11,1/c_1 + s_12,2/c_2), and so for s_23,
 *   d(c_1 c_2 s_33)/dz = -c_2 s_13,1 - c_1 s_23,2 + c_2 k_1 s_11 + c_1 k_2 s_22.
 *   s_ij  stresses at the height z above the reference surface
 *   c_a   1 + k_a z, with the principal curvature k_a
 *   ,a    derivative along direction a, by a least-squares fit to the element and its neighbours.
 *       At edges the fit is a quadratic polynomial, also to the neighbours of the neighbours
 *
 * The gradients are corrected so that the shear stress vanishes at both faces and its integral is
 * the shear resultant of the element. An element without neighbours has no gradients; the stresses
 * then balance gradients of the two bending moments alone (laminate_shear.h). The mean of s_33 is
 * the element's normal stress.
 */
#ifndef STRESS_EQUILIBRIUM_H
#define STRESS_EQUILIBRIUM_H

#include "stress_field.h"

/*
 * Compute the transverse shear stresses and the normal stresses 33 of all elements, at all heights
 * of all layers. The in-plane stresses stored in `field` must have been computed before.
 */
void stress_equilibrium(stress_field *field);

/* Compute the transverse shear resultants Q13 and Q23 of an element in its shell axes (N/m). */
void stress_shear_resultants(const stress_field *field, int element, double shear[2]);

#endif
