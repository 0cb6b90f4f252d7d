/* SPDX-License-Identifier: BSD-2-Clause */
/* Most likely cause of the critical points of a load path, or of its end before the full load. */
#ifndef PATH_CAUSE_H
#define PATH_CAUSE_H

#include "analysis.h"

/* Bytes of the text that names the cause of the end of a load path. */
enum { PATH_CAUSE_BYTES = 2 * SCENE_ERROR };

/*
 * Return whether the shell is compressed so strongly at the first limit point of a load path, or at
 * its last point where it has no critical point, that the law of the material softens there.
 */
bool path_is_softened(const load_path *path);

/*
 * Return whether a path ends, or has reached the full load, where the seventh degree of freedom of
 * a node has lost its stiffness, because the shell has turned too far from its undeformed normal.
 */
bool path_has_lost_normal(const load_path *path, const mesh *mesh);

/*
 * Fill a text with the most likely cause of the critical points of a load path, or of its end: the
 * last status of the equilibrium solver for a path of equal load steps; otherwise a turn too far
 * for the seventh degree of freedom of a node, a compression in which the law of the material
 * softens, or an element within which the shell bends too sharply, at
 * the first limit point.
 */
void path_cause(const load_path *path, const analysis *analysis, char text[PATH_CAUSE_BYTES]);

#endif
