/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Stresses of a structure whose displacement is corrected for assumptions of the elements: straight
 * cross-sections, a transverse shear stiffness, and one normal stress 33 of all plies. The
 * recovered stresses show strains and resultants that the elements leave out:
 *   shear       g_i = integral of P_ji e_j3 over the thickness - Q_i/K
 *   resultants  N_ab, M_ab = integrals of s_ab (1, z)
 *     P_ji      shear stress j3 in equilibrium with a moment of unit gradient i (laminate_shear.h)
 *     e_j3      shear strains of the recovered shear stresses
 *     Q, K      shear forces and shear stiffness of the element
 *     s_ab      in-plane stresses of bent cross-sections, and those that the normal stress 33 at
 *         each height causes (stress_warp.h)
 * Both are prescribed to the elements like those of a temperature. The displacement that they cause
 * is added, and the stresses are recovered once more. This has two consequences. The stresses do
 * not depend on whether the elements have a uniform shear strain or a shear stiffness from
 * equilibrium. And the change of the displacement is an estimate of its error.
 *
 * The displacement is not corrected in two cases: equilibrium makes a laminate more than three
 * times as flexible in shear as its elements are, as in a sandwich, or the stresses of bent
 * cross-sections do not converge.
 */
#ifndef STRESS_CORRECTED_H
#define STRESS_CORRECTED_H

#include "../../lib/model/model.h"
#include "stress.h"

/*
 * Recover the stresses of a structure with linear kinematics from its displacement and input
 * values. The displacement is corrected for assumptions of the elements before the final recovery.
 *   model in  structure with the factors of its stiffness matrix
 * Returns 0, or -1 if memory runs out; call stress_free in both cases.
 */
int stress_recover_corrected(stress_field *field, const stress_state *state,
                             const pzs_model *model);

#endif
