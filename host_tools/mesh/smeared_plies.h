/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Plies of patches with smeared stiffness, which may end within an element. Integrals over the
 * thickness count such a ply by the fraction of the area that it covers. In-plane strains, and with
 * the element option lin33 the normal stress 33, are the same in the covered part and beside it.
 */
#ifndef SMEARED_PLIES_H
#define SMEARED_PLIES_H

#include "laminate.h"

/*
 * Set the members `present_plies` and `absent` of an element's description for those plies that
 * patches with smeared stiffness cover, at least in a part of the element.
 */
void smeared_plies_set(laminate_place *place, const scene *scene, int element);

#endif
