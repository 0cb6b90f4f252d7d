/* SPDX-License-Identifier: BSD-2-Clause */
/* Most likely cause of the critical points of a load path, or of its end before the full load. */
#ifndef PATH_CAUSE_H
#define PATH_CAUSE_H

#include "analysis.h"

/* Size (bytes) of the text that says why a load path ended before the full load. */
enum { PATH_CAUSE_BYTES = 2 * SCENE_ERROR };

/*
 * Return whether the shell is compressed so strongly that its material law softens, at one point of
 * the load path: the first limit point, else the first bifurcation, else the last point.
 */
bool path_is_softened(const load_path *path);

/*
 * Return whether the shell has turned so far from its undeformed normal, at the last point of a
 * load path, that the seventh dof of a node has lost its stiffness. This dof is the displacement of
 * the middle surface along the undeformed normal, relative to both faces.
 */
bool path_has_lost_normal(const load_path *path, const mesh *mesh);

/*
 * Write the most likely cause of the critical points or the end of a load path into `text`, the
 * first of
 *   1. the last status of the solver, for equal load steps or after a solver error
 *   2. a shell that has turned so far that a dof has lost its stiffness (path_has_lost_normal)
 *   3. compression that softens the material law (path_is_softened)
 *   4. a bend too sharp for one element
 */
void path_cause(const load_path *path, const analysis *analysis, char text[PATH_CAUSE_BYTES]);

#endif
