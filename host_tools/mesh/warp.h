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
 * Compute the warping correction of an element type (type->warp) from its thickness and its corner
 * tables, which map the displacements of the corners to strains. The correction adds a term to the
 * membrane shear strain of the element (mean of both faces of the shear strain 12):
 *   share (k12 - sum over k of c_k e_k), k = 1 to 8.
 * Here k12 is the difference of the shear strain 12 between both faces, constant over the element.
 * The eight strains e_k are, with the natural coordinates xi1 and xi2:
 *   transverse shear  13 linear in xi2, 23 linear in xi1, 13 constant, 23 constant;
 *   bending (difference between both faces)  11 constant, 11 linear in xi2, 22 constant, 22 linear
 *       in xi1.
 * The directors (unit normals) of the four corners have eight tilts, two at each corner. The eight
 * factors c_k are chosen so that in the reference state none of these tilts changes the term. The
 * corrected membrane strains then depend on displacements of the middle surface alone. Otherwise
 * tilted directors could cancel the membrane strains of a thin shell.
 *   share  in  tau (L1^2 k1 + L2^2 k2)/(12 h), with tau the element option of this name, L1 and L2
 *       the lengths of the element, k1 and k2 its curvatures and h the thickness; 0: no correction
 * Returns 0, or -1 if the eight strains cannot remove the effect of the directors, because the
 * element has no extent.
 */
int warp_fill(pzs_element_type *type, double share);

#endif
