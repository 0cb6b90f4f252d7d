/* SPDX-License-Identifier: BSD-2-Clause */
/* Area that two electrodes of any outline on two layers cover together. */
#ifndef OUTLINE_COMMON_H
#define OUTLINE_COMMON_H

#include "scene.h"

/*
 * Return the part of an element that two electrodes of different layers cover together. Where one
 * of the two is given by a formula, their places in the element are taken to be independent, and
 * the result is the product of their parts.
 */
double outline_common_share(const scene *scene, const scene_patches *one, int electrode,
                            const scene_patches *other, int other_electrode, int element);

#endif
