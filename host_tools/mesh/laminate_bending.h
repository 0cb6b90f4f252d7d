/* SPDX-License-Identifier: BSD-2-Clause */
/* How much a laminate's transverse shear counts in its bending. */
#ifndef LAMINATE_BENDING_H
#define LAMINATE_BENDING_H

#include "laminate.h"

/* Stiffnesses per width along material axis 1. */
typedef struct laminate_bending {
    double bending;  /* of the laminate (N m) */
    double faces;    /* sum of the stiff plies' own bending stiffnesses (N m); 0 without a soft
                        core */
    double shear;    /* transverse shear from equilibrium (N/m) */
    double constant; /* transverse shear under a strain that is constant in the height (N/m) */
} laminate_bending;

/* Fill the stiffnesses of all plies of a laminate. Returns 0, or -1 where it has none. */
int laminate_bending_fill(const laminate *laminate, laminate_bending *bending);

#endif
