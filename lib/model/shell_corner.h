/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Constants of the four-node shell element that its two files share: shell.c (undeformed state,
 * stress resultants) and shell_at.c (tangent stiffness at a deformed shape).
 */
#ifndef PZS_LIB_SHELL_CORNER_H
#define PZS_LIB_SHELL_CORNER_H

#include "pzs_model.h"

/*
 * Strain components in the order of pzs_element_type.d. Suffix M stands for the mean of the two
 * faces, suffix D for their difference. The transverse shear strains 13 and 23 have no difference.
 */
enum { E11M, E11D, E22M, E22D, E33M, E33D, E12M, E12D, E13, E23 };

/*
 * neighbour[r][a]: corner next to corner r of an element in direction a, which is 0 for the surface
 * coordinate theta1 and 1 for theta2.
 */
static const uint8_t neighbour[4][2] = {{1, 3}, {0, 2}, {3, 1}, {2, 0}};

/*
 * mode_sign[m][r]: value of strain mode m at corner r of the element. The strain modes 00, 01, 10
 * and 11 are named by two exponents a and b; mode ab varies over the element as xi1^a xi2^b with
 * the element coordinates xi1 and xi2.
 */
static const pzs_real mode_sign[4][4] = {
    {1, 1, 1, 1}, {-1, -1, 1, 1}, {-1, 1, 1, -1}, {1, -1, 1, -1}};

/*
 * Number (kept_strains) and list (kept_strain) of the strains that the element takes into account
 * in each of its strain modes: 00 (constant over the element), 01 and 10 (linear), 11 (bilinear).
 * E11M, for example, is the mean of strain 11 of the two faces, and E11D its difference.
 */
static const uint8_t kept_strains[4] = {10, 5, 5, 2};
static const uint8_t kept_strain[4][10] = {
    {E11M, E11D, E22M, E22D, E33M, E33D, E12M, E12D, E13, E23},
    {E11M, E11D, E33M, E33D, E13},
    {E22M, E22D, E33M, E33D, E23},
    {E33M, E33D},
};

/*
 * Index in pzs_element_type.d, the stiffness of an element type, of the first entry of each strain
 * mode (constant, linear or bilinear over the element). The stiffness of a mode is a packed lower
 * triangle with a row for each strain that the mode takes into account (kept_strain).
 */
static const uint8_t first_entry[4] = {0, 55, 70, 85};

/*
 * Compute the stresses 11, 22 and 12 at a corner of an element that are conjugate to the parts of
 * the in-plane strains that are quadratic in the height (pzs_element_type.height_squared).
 *   stress [10] in  stresses at the corner, in the strain order of pzs_element_type.d
 */
static inline void shell_quadratic_stresses(const pzs_element_type *type, const pzs_real stress[10],
                                            pzs_real quadratic[3])
{
    const pzs_real *square = type->height_squared[0], *slope = type->height_squared[1];
    quadratic[0] = square[0] * stress[E11M] + slope[0] * stress[E11D];
    quadratic[1] = square[1] * stress[E22M] + slope[1] * stress[E22D];
    quadratic[2] = square[2] * stress[E12M] + slope[2] * stress[E12D];
}

#endif
