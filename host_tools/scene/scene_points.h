/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Points in space that a scene gives as a list [[x, y], ...] or as a file with one row for each
 * point.
 */
#ifndef SCENE_POINTS_H
#define SCENE_POINTS_H

#include "bicubic.h"
#include "scene_file.h"

extern const form scene_points_form;

/*
 * Read points in space into a table.
 *   table   out      one row for each point, released by the caller also after an error;
 *                    coordinates that a list leaves out are 0
 *   column  [3] out  number of the column of x, y and z in the table; -1 where a file has none
 * Returns 0, or -1 after writing an error message about the scene file.
 */
int scene_points_table(reader *reader, int node, number_table *table, int column[SCENE_AXES]);

/*
 * Read the points of a surface and fit its height z over x and y to them.
 *   cells    [2] in   numbers of cells of the piecewise bicubic height function along x and
 *                     y; 0: about four points to a cell
 *   function     out  height z over x and y, released by the caller
 * Returns 0, or -1 after writing an error message about the scene file.
 */
int scene_points_fit(reader *reader, int node, const int cells[2], bicubic *function);

#endif
