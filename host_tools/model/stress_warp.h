/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * In-plane strains of cross-sections that the transverse shear bends. A shell's cross-sections stay
 * straight on the mean; in its plies the shear strains g_a3 = dw_a/dz displace them by w_a(z) along
 * direction a, and where the shear changes along the surface, w causes in-plane strains:
 *   e_ab = (w_a,b + w_b,a)/2 + m_ab + z b_ab
 * The membrane strains m and curvatures b keep the resultants of the element. The shear stresses
 * follow from equilibrium with the in-plane stresses (stress_equilibrium.h), which the strains e
 * change: the strains are computed, then the shear stresses, then the strains once more (Noor,
 * Burton and Peters 1990). Further shear stresses would contain third derivatives of the moments,
 * which a mesh does not have.
 */
#ifndef STRESS_WARP_H
#define STRESS_WARP_H

#include "stress_field.h"

/*
 * Add the strains of bent cross-sections to the recovered stresses, whose transverse shear stresses
 * are known, and compute the transverse shear stresses anew. Where the second change of the
 * in-plane stresses is not less than half the first one, as in a soft core whose faces bend by
 * themselves, the stresses remain those of straight cross-sections. Returns 0, or -1 if memory runs
 * out.
 */
int stress_warp(stress_field *field);

#endif
