/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Pictures of a mesh from a file, whose elements lie in any arrangement. Its maps are seen along
 * the mean normal of the surface; a closed surface, which has none, is seen from above.
 */
#ifndef REPORT_QUADS_H
#define REPORT_QUADS_H

#include "report_picture.h"

/* Set the view of the maps, and their size in pixels. */
void quads_plane(shell_plane *plane, const mesh *mesh);

/* Draw the elements coloured by value [nodes]. Returns 0, or -1: out of memory. */
int quads_surface(const shell *s, const double *value, const draw_scale *scale);

/*
 * Draw the sides of the elements as lines in a style: all of them, or those on free edges alone.
 * Very fine meshes are drawn by their free edges.
 */
void quads_lines(const shell *s, const char *style, bool only_free);
bool quads_is_thinned(const mesh *mesh);

/* Write the direction in which a map is seen. */
void quads_words(const shell *s);

/* Place in the picture of a point of an element. natural [2] in  from -1 to 1; at [2] out  pixels
 */
void quads_inside(const shell *s, int element, const double natural[2], double at[2]);

/* Whether any elements belong to patches of both grids. */
bool quads_overlap(const scene *scene, const scene_patches *x, const scene_patches *y);

/* Draw the elements of one patch, as a path without style, and its outline. */
void quads_patch(const shell *s, const scene_patches *patches, int patch);
void quads_patch_outline(const shell *s, const scene_patches *patches, int patch);

/* Middle of a patch in the picture, and the side of a square of its area (pixels). */
void quads_patch_room(const shell *s, const scene_patches *patches, int patch, double at[2],
                      double *size);

#endif
