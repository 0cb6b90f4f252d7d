/* SPDX-License-Identifier: BSD-2-Clause */
/* Recording of the points of a load path (curve of equilibria from zero to full load). */
#ifndef PATH_POINTS_H
#define PATH_POINTS_H

#include "analysis.h"

/*
 * Make a load path empty, with memory for LOAD_PATH_POINTS points. Returns 0, or -1 with error
 * filled.
 */
int path_points_open(load_path *path, const analysis *analysis, char *error);

/*
 * Append the present equilibrium of the equilibrium solver, with the values of the scene's outputs,
 * as a point of a load path.
 *   load_factor in  factor by which all input values of the scene are multiplied there
 *   iterations  in  number of linear solves that led to this point from the one before
 */
void path_points_add(load_path *path, analysis *analysis, double load_factor, int iterations);

/*
 * Append a critical point (limit point, bifurcation or change of stability) between the last two
 * points of a load path, or after the last one while the next is not appended yet. The present
 * equilibrium of the equilibrium solver is that of the critical point.
 *   point in  index of the last point before the critical point
 */
void path_points_event(load_path *path, analysis *analysis, load_path_event_type type, int point,
                       double load_factor);

#endif
