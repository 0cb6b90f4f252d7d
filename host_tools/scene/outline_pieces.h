/* SPDX-License-Identifier: BSD-2-Clause */
/* Pieces of electrodes of any outline, element by element, for pictures. */
#ifndef OUTLINE_PIECES_H
#define OUTLINE_PIECES_H

#include "scene.h"

/*
 * Draw the areas of an electrode in an element, or (where draws_outline is true) the parts of its
 * outline. Returns 0, or -1: out of memory.
 */
int outline_pieces(const scene *scene, const scene_patches *patches, int electrode, int element,
                   bool draws_outline, outline_draw *draw, void *context);

#endif
