/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Warping correction of a curved element (pzs_element_type.warp): a term of the membrane shear
 * strain that depends on normal displacements of the four corners with alternating signs. In nearly
 * inextensional bending it reduces the error from second to fourth order in the element's length.
 */
#ifndef WARP_H
#define WARP_H

#include "pzs.h"

/*
 * Compute the warping correction of an element type (type->warp) from its thickness and corner
 * tables. The correction is added to the membrane shear strain 12, and keeps tilted directors from
 * cancelling the membrane strains of a thin shell:
 *   share (d12 - sum over i of c_i e_i), i = 1 to 8
 *   d12    difference of the strain 12 between both faces, constant over the element
 *   e_i    strains 13 linear in xi2, 23 linear in xi1, 13 and 23 constant; then differences between
 *          both faces of 11 constant, 11 linear in xi2, 22 constant, 22 linear in xi1
 *   c_i    eight factors, computed so that a tilt of the director at any corner of the undeformed
 *          element leaves the correction 0
 *   share  in  tau (L1^2 k1 + L2^2 k2)/(12 h), with the element option tau, lengths L1 and L2 of
 *          the element, curvatures k1 and k2, and thickness h; 0: no correction
 * Returns 0, or -1 if no factors c_i exist, because the element has no extent.
 */
int warp_fill(pzs_element_type *type, double share);

#endif
