/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Pictures of electrodes with outlines of any shape, drawn element by element: the part of an
 * electrode, or of its outline, that lies in each element.
 */
#ifndef OUTLINE_PIECES_H
#define OUTLINE_PIECES_H

#include "scene.h"

/*
 * Draw the areas that an electrode covers in an element, or, if draws_outline is true, the parts of
 * its outline that cross the element. Returns 0, or -1 where memory runs out.
 */
int outline_pieces(const scene *scene, const scene_patches *patches, int electrode, int element,
                   bool draws_outline, outline_draw *draw, void *context);

#endif
