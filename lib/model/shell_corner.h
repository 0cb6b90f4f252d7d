/* SPDX-License-Identifier: BSD-2-Clause */
/* Constants of the GEX7P4 element that its two files share: shell.c (undeformed state, resultants)
 * and shell_at.c (tangent at a deformed shape). */
#ifndef PZS_LIB_SHELL_CORNER_H
#define PZS_LIB_SHELL_CORNER_H

#include "pzs_base.h"

/* Strain components in the order of the stiffness D. M: mean of the two faces, D: difference of the
 * faces; the transverse shears 13 and 23 have no difference. */
enum { E11M, E11D, E22M, E22D, E33M, E33D, E12M, E12D, E13, E23 };

/* neighbour[r][a]: the corner next to corner r in direction a, 0 for theta1 and 1 for theta2. */
static const uint8_t neighbour[4][2] = {{1, 3}, {0, 2}, {3, 1}, {2, 0}};

/* mode_sign[m][r] = xi1^r1 xi2^r2 of mode m (00, 01, 10, 11) at corner r. */
static const pzs_real mode_sign[4][4] = {
    {1, 1, 1, 1}, {-1, -1, 1, 1}, {-1, 1, 1, -1}, {1, -1, 1, -1}};

#endif
