/*
 * Checks of a contact that its active set of nodes cannot make: points between the nodes, the other
 * face of the shell, and the way of both faces relative to the body in one load step.
 *
 * All bodies are convex. A convex body lies behind each of its tangent planes, its distance is a
 * convex function of the place, and so is the distance along a straight line: least distances are
 * found by bisection of the slope.
 */
#ifndef PZS_CONTACT_CHECK_H
#define PZS_CONTACT_CHECK_H

#include "pzs.h"

#if PZS_NONLINEAR

/* Gaps of this size are closed (m). */
pzs_real contact_closed(const pzs_contact *contact);

/* Half of the longest diagonal of an element at rest: no point of an element is farther from its
 * nearest node (m). */
pzs_real contact_reach(const pzs_contact *contact, const pzs_structure *structure);

/*
 * Does the body enter the shell at path->u, or has it passed through since the last equilibrium?
 * PZS_OK or PZS_E_PENETRATION. contact->entered, element, node, spot and depth say where.
 */
pzs_status contact_check(pzs_contact *contact, const pzs_solver *solver);

/*
 * Largest part, at most 1, of the way from the last equilibrium to the amounts that one load step
 * may take: until the body comes as near to a node as an element reaches, and then by half the
 * smallest radius of the body. amount [inputs] in
 */
pzs_real contact_longest(const pzs_contact *contact, const pzs_solver *solver,
                         const pzs_real *amount);

#endif
#endif
