/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Displacement of the cross-sections of a shell whose elements move with straight cross-sections:
 * the part by which transverse shear bends the cross-sections, and the displacement of the plies
 * along the normal by their thickness strains. Equations in stress_warp.h.
 */
#ifndef STRESS_BEND_H
#define STRESS_BEND_H

#include "stress_stencil.h"

/*
 * Displacement of a bent and stretched cross-section at one height of an element (m): in-plane
 * displacement along the two shell axes, and displacement along the normal.
 */
typedef struct bend {
    double along[2], rise;
} bend;

typedef bend section[STENCIL_SAMPLES];

/*
 * Compute the displacement of the cross-sections of all elements from their transverse stresses
 * (all [elements] out). The member `rise`, the displacement along the normal, is 0 unless the
 * displacement of the structure is corrected (stress_corrected.h).
 */
void bend_fill(const stress_field *field, section *all);

/*
 * Compute the in-plane strains 11, 22 and 12 (twice the tensor's) of the displacement of the
 * cross-sections at one height, in the shell axes of the element of the stencil.
 */
void bend_strain(const stress_field *field, const stencil *stencil, section *all, int sample,
                 double strain[3]);

#endif
