/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Warping correction of a curved element (pzs_element_type.warp). Normal displacements of the four
 * corners with alternating signs warp an element. The correction is a term of its membrane shear
 * strain that depends on this warping. In nearly inextensional bending of a curved shell it reduces
 * the error from second to fourth order in the element's length.
 */
#ifndef WARP_H
#define WARP_H

#include "pzs.h"

/*
 * Compute the warping correction of an element type (type->warp) from its thickness and corner
 * tables. It keeps tilted directors from cancelling the membrane strains of a thin shell, by a term
 * that is added to the membrane shear strain 12 of the element:
 *   share (k12 - sum over k of c_k e_k), k = 1 to 8.
 *   k12  difference of the strain 12 between both faces, constant over the element
 *   e_k  strains 13 linear in xi2, 23 linear in xi1, 13 and 23 constant; then differences between
 *       both faces of 11 constant, 11 linear in xi2, 22 constant, 22 linear in xi1
 *   c_k  factors for which no tilt of a corner's director changes the term in the reference state
 *   share  in  tau (L1^2 k1 + L2^2 k2)/(12 h), with tau the element option of this name, L1 and L2
 *       the lengths of the element, k1 and k2 its curvatures and h the thickness; 0: no correction
 * Returns 0, or -1 if no factors c_k exist, because the element has no extent.
 */
int warp_fill(pzs_element_type *type, double share);

#endif
