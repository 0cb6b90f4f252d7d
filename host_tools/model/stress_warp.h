/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * In-plane stresses that the elements leave out, because their cross-sections are straight and all
 * plies have the same normal stress 33.
 *   bent cross-sections  A cross-section is displaced by w_a(z). Shells with straight
 *       cross-sections have a line in z instead; the line that does the same work with forces and
 *       moments is subtracted from w_a. The cause are the shear strains g_a3 of the plies and the
 *       gradient of the plies' displacement w_3 along the normal:
 *         c_a (w_a/c_a),z = g_a3 - w_3,a/c_a       w_3,z = e_33
 *         e_ab = (w_a,b/c_b + w_b,a/c_a)/2, and e_aa contains k_a w_3/c_a
 *   normal stress 33     At unchanged strains it causes the stress c_ab33/c_3333 s_33.
 *   c_a, k_a             lengths along direction a over those in the reference surface, principal
 *       curvature
 * Without a corrected displacement (stress_corrected.h) the stresses by the normal stress 33, and
 * w_3, are left out. Membrane strains and curvatures are then added, so that the resultants of the
 * element remain the same. With a corrected displacement, the equilibrium of the structure contains
 * the resultants of these stresses. Only what that equilibrium does not contain is then removed by
 * membrane strains and curvatures.
 *
 * The transverse stresses follow from equilibrium with the in-plane stresses
 * (stress_equilibrium.h), and change with them. Three steps are made: the strains are computed,
 * then the transverse stresses, then the strains once more (Noor, Burton and Peters 1990). Further
 * steps would need higher derivatives than a mesh can give. Instead, the changes that they would
 * make are taken for a geometric series: if the second change is r times the first one, with r < 0,
 * 1/(1 - r) of it is added.
 */
#ifndef STRESS_WARP_H
#define STRESS_WARP_H

#include "stress_field.h"

/*
 * Add the stresses of bent cross-sections, and of a normal stress 33 that varies over the
 * thickness, to recovered stresses whose transverse stresses are known. Then compute the transverse
 * stresses anew. If bend_change (second change of the in-plane stresses over the first one) exceeds
 * 1/2, as in a soft core whose faces bend by themselves, the stresses remain those of straight
 * cross-sections (is_straight). Returns 0, or -1 if memory runs out.
 */
int stress_warp(stress_field *field);

#endif
