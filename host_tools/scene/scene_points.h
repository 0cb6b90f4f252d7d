/* SPDX-License-Identifier: BSD-2-Clause */
/* Points of a scene: a list [[x, y], ...], or a file with a row for each point. */
#ifndef SCENE_POINTS_H
#define SCENE_POINTS_H

#include "scene_file.h"

/* Number of coordinates of a point in space. */
enum { SCENE_AXES = 3 };

extern const form scene_points_form;

/*
 * Read points as a table.
 *   table   out  to be released by the caller in either case; entries that a list leaves out are 0
 *   column  out  columns of x, y, z in the table, -1 where a file has none
 * Returns 0, or -1 with the error of the tree filled.
 */
int scene_points_table(reader *reader, int node, number_table *table, int column[SCENE_AXES]);

#endif
