/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Stiffnesses of a laminate in bending and in transverse shear, from which the program judges how
 * much transverse shear matters for bending.
 */
#ifndef LAMINATE_BENDING_H
#define LAMINATE_BENDING_H

#include "laminate.h"

/*
 * Bending and transverse shear stiffnesses of a laminate per width, for bending along material axis
 * 1.
 */
typedef struct laminate_bending {
    double bending;  /* bending stiffness of the laminate (N m) */
    double faces;    /* sum of the bending stiffnesses of the single stiff plies (N m); 0 without a
                        soft core */
    double shear;    /* transverse shear stiffness of the laminate from the equilibrium of stresses
                        (N/m) */
    double constant; /* transverse shear stiffness of the laminate for a shear strain that is
                        constant through the thickness (N/m) */
} laminate_bending;

/*
 * Compute the bending and transverse shear stiffnesses of a laminate in which all plies are
 * present. Returns 0, or -1 if the laminate has no bending or shear stiffness.
 */
int laminate_bending_fill(const laminate *laminate, laminate_bending *bending);

#endif
