/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Area fraction (0 to 1) of each element that an electrode of any outline covers. If several
 * electrodes together cover an element, their fractions have the sum 1. Outlines are drawn in a
 * plane: that of two coordinates in space, or that of theta1 and theta2.
 *   polygon  is clipped to the element, whose sides are straight in this plane. The ratio of an
 *       area on the surface to its picture in the plane is taken as linear over the element. This
 *       is exact on plates and polar meshes; elsewhere the error is of second order in the element
 *       size
 *   formula  covers the region in which the formula is positive. The formula is replaced by a
 *       linear function on each triangle of a 16 x 16 grid in the element
 */
#ifndef OUTLINE_SHARES_H
#define OUTLINE_SHARES_H

#include "scene.h"

/*
 * Return the area fraction of an element that an electrode covers, from 0 to 1. outline_find_shares
 * must have been called before.
 */
double outline_share(const scene_outlines *outlines, int electrode, int element);

/*
 * Return the fraction of the area of an element that all patches with smeared stiffness on one
 * layer cover, from 0 to 1. outline_find_shares must have been called before for all patches of the
 * layer.
 */
double outline_smeared_share(const scene *scene, int layer, int element);

/*
 * Elements that patches with smeared stiffness cover in part, so that their stiffness is smeared:
 * number, and smallest and largest covered area as a fraction of the area of the element.
 */
typedef struct outline_cuts {
    int elements;
    double least, most;
} outline_cuts;

/* Return whether a layer has patches with smeared stiffness. */
bool outline_is_smeared(const scene *scene, int layer);

/*
 * Find the elements that the patches with smeared stiffness of one layer cover in part.
 * outline_find_shares must have been called before.
 */
outline_cuts outline_cuts_of(const scene *scene, int layer, int elements);

/*
 * Compute, for every element, the area fraction that each electrode of one item of `patches`
 * covers. An electrode with a part outside the surface, or where its layer does not exist, is
 * refused unless the scene asks to cut it off. Returns 0, or -1 with error filled.
 */
int outline_find_shares(const scene *scene, scene_patches *patches, char *error);

#endif
