/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Transverse shear and normal stresses from equilibrium through the thickness.
 *
 * The stresses s_ij depend on the height z above the reference surface. In the directions a = 1, 2
 * of the principal curvatures k_a, with c_a = 1 + k_a z, the equilibrium of a shell without body
 * forces is (",a" is the derivative along direction a of the reference surface)
 *   d(c_1^2 c_2 s_13)/dz = -c_1^2 c_2 (s_11,1/c_1 + s_12,2/c_2),  and so for s_23,
 *   d(c_1 c_2 s_33)/dz = -c_2 s_13,1 - c_1 s_23,2 + c_2 k_1 s_11 + c_1 k_2 s_22.
 * The derivatives ,1 and ,2 are least-squares fits to the element and its neighbours. The gradients
 * of the two normal forces and of the two bending moments of the laminate are then corrected, so
 * that the shear stress is zero at the outer face as it is at the inner face, and integrates to the
 * shear resultant of the element. In an element without neighbours the gradients of the two moments
 * alone are used, as in laminate_shear.h. The integration constant of the normal stress s_33 is
 * chosen so that its mean is the normal stress of the element.
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
