/* SPDX-License-Identifier: BSD-2-Clause */
/* Electrodes of any outline that lie over each other on two layers. */
#ifndef OUTLINE_COMMON_H
#define OUTLINE_COMMON_H

#include "scene.h"

/*
 * Part of an element that two electrodes of different layers cover together. Where one of them is
 * given by a formula the two are taken to be independent: the result is the product of their parts.
 */
double outline_common_share(const scene *scene, const scene_patches *one, int electrode,
                            const scene_patches *other, int other_electrode, int element);

#endif
