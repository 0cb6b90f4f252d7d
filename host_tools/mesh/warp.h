/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Warping correction of an element (pzs_element_type.warp): a term of the membrane shear strain of
 * a curved element, for normal displacements of its four corners with alternating signs, which warp
 * it.
 */
#ifndef WARP_H
#define WARP_H

#include "pzs.h"

/*
 * Compute the warping correction of an element type (type->warp) from its thickness and its corner
 * tables, which map the displacements of the corners to strains. The correction adds a term to the
 * mean 12m of the membrane shear strain of both faces:
 *   share (12d - sum over k of c_k e_k), k = 1 to 8,
 * where 12d is the difference of the shear strain 12 between both faces, constant over the element.
 * The strains e_k are, with the natural coordinates xi1 and xi2:
 *   transverse shear  13 linear in xi2, 23 linear in xi1, 13 constant, 23 constant;
 *   bending (difference between both faces)  11 constant, 11 linear in xi2, 22 constant, 22 linear
 *       in xi1.
 * The factors c_k make the bracket independent of the tilts of the four directors (unit normals) in
 * the reference state: eight strains for eight tilts, two at each corner. The corrected membrane
 * strains then depend on displacements of the middle surface alone. Otherwise tilted directors
 * could cancel the membrane strains of a thin shell.
 *   share  in  tau (L1^2 k1 + L2^2 k2)/(12 h), with tau the element option of this name, L1 and L2
 *       the lengths of the element, k1 and k2 its curvatures and h the thickness; 0: no correction
 * Returns 0, or -1 if the eight strains cannot remove the effect of the directors, because the
 * element has no extent.
 */
int warp_fill(pzs_element_type *type, double share);

#endif
