/* SPDX-License-Identifier: BSD-2-Clause */
/* Area of the overlap of two electrodes of any outline that lie on different layers. */
#ifndef OUTLINE_COMMON_H
#define OUTLINE_COMMON_H

#include "scene.h"

/*
 * Return the area of an element that two electrodes of different layers cover together, as a
 * fraction of its area. Polygons in one plane are intersected. For formulas or different planes,
 * the covered areas are taken as independent: product of both fractions.
 */
double outline_common_share(const scene *scene, const scene_patches *one, int electrode,
                            const scene_patches *other, int other_electrode, int element);

#endif
