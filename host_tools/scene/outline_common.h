/* SPDX-License-Identifier: BSD-2-Clause */
/* Area of the overlap of two electrodes of any outline that lie on different layers. */
#ifndef OUTLINE_COMMON_H
#define OUTLINE_COMMON_H

#include "scene.h"

/*
 * Return the area of an element that two electrodes of different layers cover together, as a
 * fraction of the area of the element. Polygons in one plane are intersected. If one of the two
 * electrodes is given by a formula, or if their outlines lie in different planes, both areas are
 * taken as independent: the result is the product of the fractions that the electrodes cover.
 */
double outline_common_share(const scene *scene, const scene_patches *one, int electrode,
                            const scene_patches *other, int other_electrode, int element);

#endif
