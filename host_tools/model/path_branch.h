/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Change from a load path to the branch that begins at one of its bifurcations. The first step goes
 * along the mode of the bifurcation, the displacement for which the tangent stiffness is 0 there.
 */
#ifndef PATH_BRANCH_H
#define PATH_BRANCH_H

#include "arc_search.h"

/*
 * Leave the load path at its last converged point, which lies at a bifurcation, along the mode of
 * the bifurcation. The mode is the displacement with the smallest eigenvalue of the tangent
 * stiffness, with the sign that makes its largest displacement positive. After success, the first
 * equilibrium on the branch is the present point of `arc_search`, not accepted yet, and `direction`
 * is along the mode.
 *   is_opposite in  whether to leave against the mode
 *   arc         out length of the step that was made
 *   longest     out greatest length that a step on the branch should have: its largest displacement
 *       is a twentieth of the size of the mesh
 * Returns whether an equilibrium near the mode was found.
 */
bool path_branch_enter(arc_search *arc_search, const mesh *mesh, bool is_opposite, double *arc,
                       double *longest);

#endif
