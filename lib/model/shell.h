/*
 * The GEX7P4 element: one table-driven kernel for every formulation.
 *
 * Four nodes, `unknowns` (7 or 6) a node in this order: mean u1 u2 u3, (u+ - u-)/h
 * of u1 u2 u3, (u3M - mean u3)/h. Strains are taken at the four corners in the
 * corner's own frame, as means and differences of the two faces, then turned into
 * the modes 00 01 10 11 of xi1^r1 xi2^r2, of which D keeps 22 components.
 */
#ifndef PZS_LIB_SHELL_H
#define PZS_LIB_SHELL_H

#include "pzs_model.h"

enum { SHELL_NODES = 4, SHELL_STRAINS = 10, SHELL_MODES = 4, SHELL_MAX = 28 };

/* Entries of a packed lower triangle of n rows. */
#define SHELL_PACKED(n) ((n) * ((n) + 1) / 2)

/*
 * Force at rest, formed from strains:  f = sum_m L_m^T D_m L_m u.
 *   u [4 unknowns] in  (m, 1)
 *   f [4 unknowns] out (N, N m), may be u itself
 * Small strains are differences taken before anything is multiplied by a stiffness, so
 * f keeps the digits that K u loses on thin shells.
 */
void pzs_shell_force(const pzs_element_type *type, unsigned dof_per_node, const pzs_real *u,
                     pzs_real *f);

/* Stiffness at rest, column by column from pzs_shell_force. k [SHELL_PACKED(4 unknowns)] out, lower
 * triangle. */
void pzs_shell_stiffness(const pzs_element_type *type, unsigned dof_per_node, pzs_real *k);

/*
 * Force of given resultants H0 of actuation or temperature, mode 00:  f = -L_00^T H0.
 *   h0 [10]         in  times the element's area (N m), order of D
 *   f  [4 unknowns] out
 */
void pzs_shell_given(const pzs_element_type *type, unsigned dof_per_node, const pzs_real *h0,
                     pzs_real *f);

#if PZS_NONLINEAR
/*
 * The element at a displacement u. Strains e(u) by mode are exact to second order, L(u) is their
 * first variation, A_m their (constant) second. Resultants H go with the modes' kept strains,
 * packed: modes 00 01 10 11, each its kept strains in their order, times area/3^(r1+r2) (N m).
 */
enum { SHELL_RESULTANTS = 22 };

/* Strains by mode.  e [4][10] out, order of D. */
void pzs_shell_strains_at(const pzs_element_type *type, unsigned dof_per_node, const pzs_real *u,
                          pzs_real e[4][10]);

/*
 * One element's part of a mixed Newton system:
 *   f = sum_m L_m^T H_m(u),  H(u) = D e(u) + H0         internal force at the true resultants
 *   K = sum_m L_m^T D_m L_m + (resultants)_m A_m        tangent under the given resultants
 *   given     [10] in   H0 of mode 00, times the element's area (N m), order of D; NULL: none
 *   resultant [22] in   resultants of the geometric part, H0 in them; NULL: H(u) itself
 *   f [4 unknowns] out (N, N m)
 *   k [SHELL_PACKED(4 unknowns)] out, lower triangle
 */
void pzs_shell_system(const pzs_element_type *type, unsigned dof_per_node, const pzs_real *u,
                      const pzs_real *given, const pzs_real *resultant, pzs_real *f, pzs_real *k);

/*
 * Resultants extrapolated along du:  H = D (e(u) + L(u) du) + H0.
 *   du        [4 unknowns] in  NULL: resultants at u itself
 *   given     [10] in          as above
 *   resultant [22] out
 */
void pzs_shell_resultants(const pzs_element_type *type, unsigned dof_per_node, const pzs_real *u,
                          const pzs_real *du, const pzs_real *given, pzs_real *resultant);

/* Force of resultants alone:  f = sum_m L_m(u)^T H_m.  resultant [22] in, f [4 unknowns] out. */
void pzs_shell_force_at(const pzs_element_type *type, unsigned dof_per_node, const pzs_real *u,
                        const pzs_real *resultant, pzs_real *f);
#endif

#endif
