/* SPDX-License-Identifier: BSD-2-Clause */
/* Materials that differ from the scene by factors. */
#ifndef MATERIAL_SCALE_H
#define MATERIAL_SCALE_H

#include "../scene/scene.h"

/* Multiply all elastic constants by `stiffness` and all piezoelectric strain constants by `d`. */
void material_scale(scene_material *material, double stiffness, double d);

#endif
