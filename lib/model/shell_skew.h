/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Correction of the strains of a quadrilateral element that is not a parallelogram. Without it, a
 * constant strain appears in the linear strain modes 01 and 10 too, and mode 00 differs from the
 * strain at the centre of the element.
 *
 *   alpha_a = g_h . g^a                     skew; 0 on a parallelogram
 *   area ~ 1 + alpha_1 xi2 + alpha_2 xi1
 *   g_h       hourglass vector of the element
 *   g^a       dual base vectors
 *   xi1, xi2  element coordinates; mode ab varies as xi1^a xi2^b
 */
#ifndef PZS_LIB_SHELL_SKEW_H
#define PZS_LIB_SHELL_SKEW_H

#include <stdbool.h>
#include "pzs_model.h"

/*
 * Return whether an element is not a parallelogram, so that its strain modes (constant, linear and
 * bilinear over the element) must be corrected for the skew of the element.
 */
static inline bool shell_is_skewed(const pzs_element_type *type)
{
    return type->skew[0] != 0 || type->skew[1] != 0;
}

/*
 * Correct the strains of an element's four strain modes for the skew of the element, its deviation
 * from a parallelogram.
 *   skew   [3]     in      pzs_element_type.skew
 *   strain [4][10] in/out  ten strains of each mode, already corrected for the warp of the element
 *                          (pzs_element_type.warp); strains outside kept_strain are not used
 */
void pzs_shell_skew_strains(const pzs_real skew[3], pzs_real strain[4][10]);

/*
 * Turn stress resultants that are conjugate to the strains corrected for the skew of an element
 * (its deviation from a parallelogram) into resultants that are conjugate to the uncorrected
 * strains. This is the transpose of pzs_shell_skew_strains.
 */
void pzs_shell_skew_resultants(const pzs_real skew[3], pzs_real resultant[4][10]);

#endif
