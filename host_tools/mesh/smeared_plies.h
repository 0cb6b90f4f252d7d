/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Plies of patches with smeared stiffness in an element.
 *
 * Where such patches end within an element, their ply is present in a part of its area. The
 * integrals over the thickness that make up the stiffness, the mass and the thermal expansion of
 * the element count the ply by the covered fraction. In-plane strains are the same in the covered
 * part and beside it. With the element option lin33 the normal stress 33 is the same in both, and
 * each thickens freely, as the plies do among themselves.
 */
#ifndef SMEARED_PLIES_H
#define SMEARED_PLIES_H

#include "laminate.h"

/*
 * Take the patches with smeared stiffness into the description of an element: set present_plies
 * and `absent` of the plies that these patches cover, at least in part.
 */
void smeared_plies_set(laminate_place *place, const scene *scene, int element);

#endif
