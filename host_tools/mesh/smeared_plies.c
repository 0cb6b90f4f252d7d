/* SPDX-License-Identifier: BSD-2-Clause */
/* Plies of patches with smeared stiffness in an element (smeared_plies.h). */
#include "smeared_plies.h"
#include "../scene/outline_shares.h"

void smeared_plies_set(laminate_place *place, const scene *scene, int element)
{
    for (int layer = 0; layer < scene->layers && layer < LAMINATE_LAYERS; layer++) {
        const double cover = outline_smeared_share(scene, layer, element);
        if (!(cover > 0))
            continue;
        place->present_plies |= 1u << layer;
        place->absent[layer] = 1 - cover;
    }
}
