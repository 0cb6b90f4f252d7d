/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Checks of a contact beyond its active set of nodes: points between the nodes, the other face of
 * the shell, and the motion of both faces relative to the body during one load step.
 *
 * All bodies are convex. A convex body lies behind each of its tangent planes. Its distance is a
 * convex function of position, also along a straight line, so smallest distances are found by
 * bisection of the slope.
 */
#ifndef PZS_CONTACT_CHECK_H
#define PZS_CONTACT_CHECK_H

#include "pzs.h"

#if PZS_NONLINEAR

/* Largest gap that counts as closed (m). */
pzs_real pzs_contact_closed_gap(const pzs_contact *contact);

/*
 * Half of the longest diagonal of an undeformed element (m). Every point of an element is at most
 * this far from its nearest node.
 */
pzs_real pzs_contact_reach(const pzs_contact *contact, const pzs_structure *structure);

/*
 * Check whether the body penetrates the shell at the present displacement, or has passed through it
 * since the last equilibrium. Returns PZS_OK, PZS_W_BEHIND or PZS_E_PENETRATION; contact->info says
 * where.
 */
pzs_status pzs_contact_check(pzs_contact *contact, const pzs_solver *solver);

/*
 * Largest part of the way from the last equilibrium to the input values that one load step may
 * take, above 0 and at most 1: until the body is closer to a node than the reach of an element, and
 * then by half the smallest radius of the body.
 *   value [inputs] in
 */
pzs_real pzs_contact_largest_part(const pzs_contact *contact, const pzs_solver *solver,
                                  const pzs_real *value);

#endif
#endif
