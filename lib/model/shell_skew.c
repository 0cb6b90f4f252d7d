/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Correction of the strain modes (constant, linear and bilinear over the element) of a
 * quadrilateral that is not a parallelogram (shell_skew.h).
 */
#include "shell_skew.h"
#include "shell_corner.h"

/*
 * Correct the in-plane strains of an element that is not a parallelogram, with skew a1, a2 and
 * length ratio r (pzs_element_type.skew). e10_22, for example, is strain 22 in strain mode 10. With
 *   b = r (e10_22 - a2 e00_22) - a1 e00_12
 *   c = (a1 (e01_11 - a1 e00_11) + a2 r b) / (1 - a1^2 - a2^2)
 * the correction subtracts, in this order,
 *   c                            from e00_11, and c / r^2 from e00_22
 *   2 a1 e00_11 + a2 r e00_12    from e01_11
 *   2 a2 e00_22 + a1/r e00_12    from e10_22
 *   face in  0: the strains are means of the two faces, 1: differences
 */
static void skew_plane(const pzs_real skew[3], pzs_real strain[4][10], int face)
{
    const pzs_real a1 = skew[0], a2 = skew[1], ratio = skew[2], e12 = strain[0][E12M + face];
    pzs_real *e11 = &strain[0][E11M + face], *e22 = &strain[0][E22M + face];
    pzs_real *along1 = &strain[1][E11M + face], *along2 = &strain[2][E22M + face];
    const pzs_real of_22 = ratio * (*along2 - a2 * *e22) - a1 * e12;
    const pzs_real sum = a1 * (*along1 - a1 * *e11) + a2 * ratio * of_22;
    const pzs_real excess = sum / (1 - a1 * a1 - a2 * a2);
    // Change the constant strains (mode 00) from the mean over the four corners to the value at the
    // centre of the element.
    *e11 -= excess;
    *e22 -= excess / (ratio * ratio);
    // Subtract from the strains of the linear modes 01 and 10 the parts that a strain constant over
    // the element would cause in them.
    *along1 -= 2 * a1 * *e11 + a2 * ratio * e12;
    *along2 -= 2 * a2 * *e22 + a1 / ratio * e12;
}

/*
 * Turn stress resultants that are conjugate to the strains corrected for the skew of an element
 * (its deviation from a parallelogram) into resultants that are conjugate to the uncorrected
 * strains. This is the transpose of skew_plane.
 */
static void skew_plane_back(const pzs_real skew[3], pzs_real resultant[4][10], int face)
{
    const pzs_real a1 = skew[0], a2 = skew[1], ratio = skew[2];
    pzs_real *h11 = &resultant[0][E11M + face], *h22 = &resultant[0][E22M + face],
             *h12 = &resultant[0][E12M + face];
    pzs_real *along1 = &resultant[1][E11M + face], *along2 = &resultant[2][E22M + face];
    *h11 -= 2 * a1 * *along1;
    *h22 -= 2 * a2 * *along2;
    *h12 -= a2 * ratio * *along1 + a1 / ratio * *along2;
    const pzs_real excess = -(*h11 + *h22 / (ratio * ratio)) / (1 - a1 * a1 - a2 * a2);
    *along1 += a1 * excess;
    *along2 += a2 * ratio * ratio * excess;
    *h11 -= a1 * a1 * excess;
    *h22 -= a2 * a2 * ratio * ratio * excess;
    *h12 -= a1 * a2 * ratio * excess;
}

void pzs_shell_skew_strains(const pzs_real skew[3], pzs_real strain[4][10])
{
    const pzs_real a1 = skew[0], a2 = skew[1], ratio = skew[2], third = (pzs_real)1 / 3;
    for (int face = 0; face < 2; face++) {
        skew_plane(skew, strain, face);
        strain[0][E33M + face] +=
            third * (a1 * strain[1][E33M + face] + a2 * strain[2][E33M + face]);
    }
    strain[1][E13] -= a1 * strain[0][E13] + a2 * ratio * strain[0][E23];
    strain[2][E23] -= a1 / ratio * strain[0][E13] + a2 * strain[0][E23];
}

void pzs_shell_skew_resultants(const pzs_real skew[3], pzs_real resultant[4][10])
{
    const pzs_real a1 = skew[0], a2 = skew[1], ratio = skew[2], third = (pzs_real)1 / 3;
    resultant[0][E13] -= a1 * resultant[1][E13] + a1 / ratio * resultant[2][E23];
    resultant[0][E23] -= a2 * ratio * resultant[1][E13] + a2 * resultant[2][E23];
    for (int face = 0; face < 2; face++) {
        skew_plane_back(skew, resultant, face);
        resultant[1][E33M + face] += third * a1 * resultant[0][E33M + face];
        resultant[2][E33M + face] += third * a2 * resultant[0][E33M + face];
    }
}
