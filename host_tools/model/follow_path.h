/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Computation of the load path of a scene: the curve of equilibria from zero to full load. The
 * arc-length method computes it; scenes that this method does not follow take equal steps of the
 * load factor (stepped_path.h).
 */
#ifndef FOLLOW_PATH_H
#define FOLLOW_PATH_H

#include "analysis.h"

/*
 * Compute the load path from the reference state to the full load, and leave the solver of the
 * analysis at the last point. A path that ends early is kept: is_complete is 0, and `error` says
 * where it ended.
 *   analysis in/out  with an equilibrium solver in the reference state
 * Returns 0, or -1 with error filled.
 */
int load_path_follow(load_path *path, analysis *analysis, char *error);

/*
 * Compute the load path as load_path_follow does, but leave it at a bifurcation and follow the
 * branch that begins there.
 *   branch in  number of the bifurcation, 1 for the first. Positive: leave along its mode
 *       (path_branch.h); negative: opposite to its mode; 0: stay on the path
 * If the path has no such bifurcation, or no equilibrium is found along the mode, the path ends
 * early: is_complete is 0, and `error` says why. Returns 0, or -1 with error filled.
 */
int load_path_follow_branch(load_path *path, analysis *analysis, int branch, char *error);

#endif
