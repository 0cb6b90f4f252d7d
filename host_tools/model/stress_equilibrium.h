/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Transverse shear and normal stresses from equilibrium through the thickness.
 *
 * In the directions a = 1, 2 of the principal curvatures k_a, with c_a = 1 + k_a z, the equilibrium
 * of a shell without body forces is (",a" is the derivative along direction a of the reference
 * surface)
 *   d(c_1^2 c_2 s_13)/dz = -c_1^2 c_2 (s_11,1/c_1 + s_12,2/c_2),  and so for s_23,
 *   d(c_1 c_2 s_33)/dz = -c_2 s_13,1 - c_1 s_23,2 + c_2 k_1 s_11 + c_1 k_2 s_22.
 * The gradients are least-squares fits to the element and its neighbours. The gradients of two
 * forces and of two bending moments of the package are then corrected so that the shear is zero at
 * the outer face, as at the inner one, and integrates to the shear resultant of the element.
 * Without neighbours these two moments alone carry the shear, as in laminate_shear.h. The constant
 * of the normal stress makes its mean the normal stress of the element.
 */
#ifndef STRESS_EQUILIBRIUM_H
#define STRESS_EQUILIBRIUM_H

#include "stress_field.h"

/*
 * Compute the transverse shear stresses and the normal stresses of all samples of a field whose
 * in-plane stresses are known.
 */
void stress_equilibrium(stress_field *field);

/* Shear resultants Q13, Q23 of an element in the shell axes (N/m). */
void stress_shear_resultants(const stress_field *field, int element, double shear[2]);

#endif
