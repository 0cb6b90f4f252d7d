/* SPDX-License-Identifier: BSD-2-Clause */
/* Share of the warp in the membrane shear of an element (pzs_element_type.warp). */
#ifndef WARP_H
#define WARP_H

#include "pzs.h"

/*
 * Fill type->warp from the corner tables and the thickness of the type, which must be filled.
 *
 * The warp is the 12 difference of mode 00 less those shares of eight other strains that remove the
 * effect of the directors:
 *   12m^00 += share (12d^00 - sum_k c_k row_k),
 *   rows 13^01 23^10 13^00 23^00 11d^00 11d^01 22d^00 22d^10,
 * with c such that in the reference state no tilt of the four directors changes the bracket. The
 * membrane strains then contain displacements of the middle surface alone, and a thin shell cannot
 * relax them by rotating its directors, which would cost no energy.
 *   share  in  tau (L1^2 k1 + L2^2 k2)/(12 h), dimensionless; 0: no warp
 * Returns 0, or -1 where the eight rows cannot remove the directors: an element without extent.
 */
int warp_fill(pzs_element_type *type, double share);

#endif
