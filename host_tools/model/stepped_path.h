/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Computation of the load path of a scene in equal steps of the load factor. Scenes that the
 * arc-length method does not follow need it: those with prescribed displacements, with a contact
 * body that moves, or with a shell that contact alone holds.
 */
#ifndef STEPPED_PATH_H
#define STEPPED_PATH_H

#include "analysis.h"

/*
 * Compute the load path from the reference state to the full load, and append its points to an
 * empty path. The path ends early where no equilibrium is found, as above a limit load. A moved
 * contact body or support lets it continue beyond a maximum of the force.
 *   analysis in/out  with an equilibrium solver in the reference state
 *   reached  out     load factor of the last point
 * Returns 0, or -1 with error filled where memory runs out.
 */
int stepped_path_follow(load_path *path, analysis *analysis, double *reached, char *error);

#endif
