/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Part of the area of each element that an electrode with an outline of any shape covers.
 *
 * Outlines are drawn in a plane, either of two coordinates in space or of the surface coordinates
 * theta1 and theta2. Polygons are clipped to the element, whose sides are straight in this plane.
 * The ratio of the areas on the surface and in the plane is taken as linear over an element. The
 * parts are therefore exact on plates and on polar meshes; elsewhere their error is of second order
 * in the size of the elements. A formula is taken as linear on the triangles of a 16 x 16 grid in
 * each element. Where electrodes together cover the whole of an element, their parts add up to 1.
 */
#ifndef OUTLINE_SHARES_H
#define OUTLINE_SHARES_H

#include "scene.h"

/*
 * Return the part of an element that an electrode covers, from 0 to 1, after the scene has been
 * checked.
 */
double outline_share(const scene_outlines *outlines, int electrode, int element);

/*
 * Compute the parts of all elements that the electrodes of one item of the section `patches` cover.
 * Electrodes that leave the surface or their layer are refused. Returns 0, or -1 with error filled.
 */
int outline_find_shares(const scene *scene, scene_patches *patches, char *error);

#endif
