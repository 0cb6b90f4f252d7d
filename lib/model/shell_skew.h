/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Strain modes of a quadrilateral that is not a parallelogram (pzs_element_type.skew).
 *
 * With the base vectors g_1, g_2 and the hourglass vector g_h of the element, alpha_a = g_h . g^a
 * (dual base) and r = L_2/L_1, the area varies as 1 + alpha_1 xi2 + alpha_2 xi1 over the element. A
 * constant strain then appears in the modes 01 and 10 as well, and the average over the corners
 * differs from the value at the centre. Both are removed by adding multiples of other strains, so
 * the mode 00 holds the strain at the centre and the other modes are 0 under a constant strain.
 * On a parallelogram (alpha = 0) nothing changes.
 */
#ifndef PZS_LIB_SHELL_SKEW_H
#define PZS_LIB_SHELL_SKEW_H

#include <stdbool.h>
#include "pzs_model.h"

/* Whether the element is not a parallelogram, so that the two functions below have an effect. */
static inline bool shell_is_skewed(const pzs_element_type *type)
{
    return type->skew[0] != 0 || type->skew[1] != 0;
}

/*
 * Correct the strains of the modes, warp included, in place.
 *   skew [3]     in      alpha_1, alpha_2, L_2/L_1
 *   strain    [4][10] in/out  the strains that a mode does not keep are neither read nor written
 */
void pzs_shell_skew_strains(const pzs_real skew[3], pzs_real strain[4][10]);

/* Transpose of pzs_shell_skew_strains: apply it to the resultants of the corrected strains. */
void pzs_shell_skew_resultants(const pzs_real skew[3], pzs_real resultant[4][10]);

#endif
