/* SPDX-License-Identifier: BSD-2-Clause */
/* Follows the load path of an analysis by the arc-length method. */
#ifndef FOLLOW_PATH_H
#define FOLLOW_PATH_H

#include "analysis.h"

/*
 * Follow the path from the reference state to the full load, and leave the solver of the analysis
 * at the last point.
 *   analysis in/out  with an equilibrium solver in the reference state; without contact, prescribed
 *                    displacements and open electrodes
 * A path that ends early is kept: is_complete is 0 and error says where it ended. Returns 0, or -1
 * with error filled.
 */
int load_path_follow(load_path *path, analysis *analysis, char *error);

#endif
