/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Check of all electrodes with outlines of any shape in a scene file: computes the part of each
 * element that they cover, and refuses electrodes that overlap (scene_parts.h).
 */
#include "outline_overlap.h"
#include "outline_shares.h"
#include "scene_parts.h"

int check_outlines(scene *scene, char *error)
{
    for (int k = 0; k < scene->patch_grids; k++)
        if (scene->patches[k].outlines &&
            outline_find_shares(scene, &scene->patches[k], error) != 0)
            return -1;
    for (int k = 0; k < scene->patch_grids; k++)
        if (scene->patches[k].outlines && outline_check_overlaps(scene, k, error) != 0)
            return -1;
    return 0;
}
