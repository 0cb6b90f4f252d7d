/* SPDX-License-Identifier: BSD-2-Clause */
/* Material constants multiplied by factors (material_scale.h). */
#include "material_scale.h"

void material_scale(scene_material *material, double stiffness, double d)
{
    for (int i = 0; i < 3; i++)
        material->e[i] *= stiffness;
    material->g23 *= stiffness;
    material->g13 *= stiffness;
    material->g12 *= stiffness;
    material->d31 *= d;
    material->d32 *= d;
    material->d33 *= d;
    material->d24 *= d;
    material->d15 *= d;
    for (int i = 0; i < 5; i++)
        material->piezo_e[i] *= stiffness * d;
}
