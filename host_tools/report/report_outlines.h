/* SPDX-License-Identifier: BSD-2-Clause */
/* Electrodes of any outline in the map of a surface. */
#ifndef REPORT_OUTLINES_H
#define REPORT_OUTLINES_H

#include "report_picture.h"

/* Whether electrodes of two items of `patches`, one with outlines at least, share an element. */
bool outlines_meet(const scene_patches *one, const scene_patches *other);

/* Write the area of an electrode, or its outline, as a path without style. */
void outlines_area(const shell *s, const scene_patches *patches, int electrode);
void outlines_border(const shell *s, const scene_patches *patches, int electrode);

/* Middle of an electrode in the picture, and the side of a square of its area (pixels). */
void outlines_room(const shell *s, const scene_patches *patches, int electrode, double at[2],
                   double *size);

#endif
