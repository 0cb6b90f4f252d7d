/* The share of the warp in the membrane shear of an element (pzs_element_type.warp). */
#ifndef WARP_H
#define WARP_H

#include "pzs.h"

/*
 * Fill kind->warp from the corner tables and the thickness, which must be there. The warp is the
 * 12 difference of mode 00 less those shares of eight other strains that take the directors out
 * of it:
 *   12m^00 += share (12d^00 - sum_k c_k row_k),
 *   rows 13^01 23^10 13^00 23^00 11d^00 11d^01 22d^00 22d^10,
 * with c such that at rest no tilt of the four directors is left in the bracket. Then the
 * membrane strains hold displacements of the middle alone, and a thin shell cannot relax them by
 * its directors, which cost nothing there.
 *   share in  tau (L1^2 k1 + L2^2 k2)/(12 h) (1); 0: no warp
 * Returns 0, or -1 where the eight rows cannot take the directors out: an element without extent.
 */
int warp_fill(pzs_element_type *type, double share);

#endif
