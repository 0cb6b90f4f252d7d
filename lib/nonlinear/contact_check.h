/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Checks of a contact beyond the nodes that are held on the body: points between the nodes, the
 * other face of the shell, and the motion during a load step. Smallest gaps are found by bisection
 * of the slope, because the gap of a convex body is a convex function.
 */
#ifndef PZS_CONTACT_CHECK_H
#define PZS_CONTACT_CHECK_H

#include "pzs.h"

#if PZS_NONLINEAR

/* Return the largest gap between shell and contact body that counts as closed (m). */
pzs_real pzs_contact_closed_gap(const pzs_contact *contact);

/*
 * Return half of the longest diagonal of the undeformed elements (m). Every point of an element is
 * at most this far from its nearest node.
 */
pzs_real pzs_contact_reach(const pzs_contact *contact, const pzs_structure *structure);

/*
 * Check whether the contact body penetrates the shell at the present displacement, or has passed
 * through it since the last equilibrium. Returns PZS_OK, PZS_W_BEHIND or PZS_E_PENETRATION and
 * describes the penetration in contact->info.
 */
pzs_status pzs_contact_check(pzs_contact *contact, const pzs_solver *solver);

/*
 * Return the largest part (above 0, at most 1) of the way from the last equilibrium to the wanted
 * input values that one load step may take, so that the checks of penetration cannot miss a fast
 * body. A load step ends when the contact body has come as near to a node as half of the longest
 * diagonal of an element. A body that is already nearer moves in a load step by at most half of its
 * smallest radius of curvature.
 *   value [inputs] in  wanted input values
 */
pzs_real pzs_contact_largest_part(const pzs_contact *contact, const pzs_solver *solver,
                                  const pzs_real *value);

#endif
#endif
