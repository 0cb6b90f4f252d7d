/* SPDX-License-Identifier: BSD-2-Clause */
/* Most likely cause of the critical points of a load path, or of its end before the full load. */
#ifndef PATH_CAUSE_H
#define PATH_CAUSE_H

#include "analysis.h"

/* Size (bytes) of the text that says why a load path ended before the full load. */
enum { PATH_CAUSE_BYTES = 2 * SCENE_ERROR };

/*
 * Return whether the shell is compressed so strongly that its material law softens. This is
 * examined at one point of the load path: at the first limit point; without limit points, at the
 * first bifurcation; with neither limit points nor bifurcations, at the last point.
 */
bool path_is_softened(const load_path *path);

/*
 * Return whether the shell has turned so far from its undeformed normal, at the last point of a
 * load path, that the seventh dof of a node has lost its stiffness. This dof is the displacement of
 * the middle surface along the undeformed normal, relative to both faces.
 */
bool path_has_lost_normal(const load_path *path, const mesh *mesh);

/*
 * Fill a text with the most likely cause of the critical points or the end of a load path:
 *   equal load steps, or a solver error   the last status of the solver
 *   at the last point of the path         a turn of the shell that takes the stiffness of the
 *       seventh dof of a node
 *   at the first limit point, otherwise bifurcation, otherwise the last point   compression that
 *       softens the material law; otherwise a bend too sharp for one element
 */
void path_cause(const load_path *path, const analysis *analysis, char text[PATH_CAUSE_BYTES]);

#endif
