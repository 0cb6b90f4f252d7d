/* SPDX-License-Identifier: BSD-2-Clause */
/* Material constants multiplied by factors, for simulated structures that differ from the scene. */
#ifndef MATERIAL_SCALE_H
#define MATERIAL_SCALE_H

#include "../scene/scene.h"

/*
 * Multiply all elastic constants of a material by `stiffness` and all its piezoelectric strain
 * constants by `d`.
 */
void material_scale(scene_material *material, double stiffness, double d);

#endif
