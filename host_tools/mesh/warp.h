/* SPDX-License-Identifier: BSD-2-Clause */
/* Warping correction of the membrane shear strain of an element (pzs_element_type.warp). */
#ifndef WARP_H
#define WARP_H

#include "pzs.h"

/*
 * Compute the warping correction of an element type, type->warp, from its thickness and its corner
 * tables (which map the displacements of the corners to strains).
 *
 * The correction adds to the mean membrane shear strain of both faces the difference of the shear
 * strain between them, less multiples of eight other strains, times `share`:
 *  12m^00 += share (12d^00 - sum over k of c_k strain_k),
 *  strains 13^01 23^10 13^00 23^00 11d^00 11d^01 22d^00 22d^10.
 * The numbers are the components of the strains, m is the mean and d the difference of both faces,
 * and the exponent is the shape of the strain over the element: 00 constant, 01 and 10 linear along
 * one direction. The factors c_k are such that, in the reference state, no tilt of the four
 * directors changes the expression in brackets. The membrane strains then contain displacements of
 * the middle surface alone, and a thin shell cannot relax them by rotating its directors, which
 * would cost no energy.
 *   share  in  tau (L1^2 k1 + L2^2 k2)/(12 h), with tau the element option of this name, L1 and L2
 *          the lengths of the element, k1 and k2 its curvatures and h the thickness; 0: no
 *          correction
 * Returns 0, or -1 if the eight strains cannot remove the effect of the directors, because the
 * element has no extent.
 */
int warp_fill(pzs_element_type *type, double share);

#endif
