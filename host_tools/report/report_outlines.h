/* SPDX-License-Identifier: BSD-2-Clause */
/* Pictures of electrodes of any outline on the map of a surface. */
#ifndef REPORT_OUTLINES_H
#define REPORT_OUTLINES_H

#include "report_picture.h"

/*
 * Return whether electrodes of two items of the section `patches` may lie over each other; at least
 * one of the items has outlines.
 */
bool outlines_meet(const scene_patches *one, const scene_patches *other);

/*
 * Write the area of an electrode (outlines_area) or its outline (outlines_border) as the path of an
 * SVG element that the caller has begun.
 */
void outlines_area(const shell *s, const scene_patches *patches, int electrode);
void outlines_border(const shell *s, const scene_patches *patches, int electrode);

/*
 * Compute the middle of an electrode in the picture, and the side of a square of the same area
 * (pixels).
 */
void outlines_room(const shell *s, const scene_patches *patches, int electrode, double at[2],
                   double *size);

#endif
