/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The GEX7P4 element: one table-driven kernel for every formulation.
 *
 * The element has four nodes with `dof_per_node` (7 or 6) dof each, in this order: mean u1 u2 u3 of
 * the two faces, (u+ - u-)/h of u1 u2 u3, (u3M - mean u3)/h. Strains are computed at the four
 * corners, in the frame of the corner, as means and differences of the two faces. They are then
 * combined into the modes 00 01 10 11 of xi1^r1 xi2^r2, of which D keeps 22 components.
 */
#ifndef PZS_LIB_SHELL_H
#define PZS_LIB_SHELL_H

#include "pzs_model.h"

enum { SHELL_NODES = 4, SHELL_STRAINS = 10, SHELL_MODES = 4, SHELL_MAX = 28 };

/* Entries of a packed lower triangle of n rows. */
#define SHELL_PACKED(n) ((n) * ((n) + 1) / 2)

/*
 * Internal force in the undeformed state, computed from strains:  f = sum_m L_m^T D_m L_m u.
 *   displacement [4 dof_per_node] in  (m, 1)
 *   force [4 dof_per_node] out (N, N m), may be u itself
 * The small strains are formed as differences before anything is multiplied by a stiffness, so f
 * keeps the digits that the product K u loses on thin shells.
 */
void pzs_shell_force(const pzs_element_type *type, unsigned dof_per_node,
                     const pzs_real *displacement, pzs_real *force);

/*
 * Stiffness in the undeformed state, one column for each call of pzs_shell_force.
 *   stiffness [SHELL_PACKED(4 dof_per_node)] out, lower triangle
 */
void pzs_shell_stiffness(const pzs_element_type *type, unsigned dof_per_node, pzs_real *stiffness);

/*
 * Force of prescribed resultants H0 (actuation or temperature) of mode 00:  f = -L_00^T H0.
 *   h0 [10]             in  times the element's area (N m), order of D
 *   force  [4 dof_per_node] out (N, N m)
 */
void pzs_shell_prescribed_force(const pzs_element_type *type, unsigned dof_per_node,
                                const pzs_real *h0, pzs_real *force);

/*
 * Derivatives of a displacement at one corner, or the deformed base vectors there, which have the
 * same form: lam_a (mean and difference/h of the faces) in each direction a, beta and q.
 */
typedef struct shell_corner {
    pzs_real mean[2][3];
    pzs_real diff[2][3];
    pzs_real beta[3];
    pzs_real q;
} shell_corner;

#if PZS_NONLINEAR
/*
 * The element at a displacement u. The strains e(u) of each mode are exact to second order, L(u) is
 * their first variation and A_m their (constant) second variation. Resultants H belong to the
 * strains that each mode keeps. They are packed mode by mode (00 01 10 11), in the order of the
 * kept strains, times area/3^(r1+r2) (N m).
 */
enum { SHELL_RESULTANTS = 22 };

/* Strains of each mode at displacement u.  strain [4][10] out, order of D. */
void pzs_shell_strains_at(const pzs_element_type *type, unsigned dof_per_node,
                          const pzs_real *displacement, pzs_real strain[4][10]);

/*
 * Tangent and internal force of one element for Newton's method with independent resultants:
 *   f = sum_m L_m^T H_m(u),  H(u) = D e(u) + H0         internal force, resultants of u
 *   K = sum_m L_m^T D_m L_m + (resultants)_m A_m        tangent, resultants as passed
 *   given     [10] in   H0 of mode 00, times the element's area (N m), order of D; NULL: zero
 *   resultant [22] in   resultants of the geometric part, H0 included; NULL: H(u)
 *   force [4 dof_per_node] out (N, N m)
 *   stiffness [SHELL_PACKED(4 dof_per_node)] out, lower triangle
 */
void pzs_shell_system(const pzs_element_type *type, unsigned dof_per_node,
                      const pzs_real *displacement, const pzs_real *given,
                      const pzs_real *resultant, pzs_real *force, pzs_real *stiffness);

/*
 * Resultants extrapolated along an increment du:  H = D (e(u) + L(u) du) + H0.
 *   du        [4 dof_per_node] in  NULL: resultants of u itself
 *   given     [10]             in  H0 of mode 00, times the element's area (N m); NULL: zero
 *   resultant [22]             out (N m)
 */
void pzs_shell_resultants(const pzs_element_type *type, unsigned dof_per_node,
                          const pzs_real *displacement, const pzs_real *du, const pzs_real *given,
                          pzs_real *resultant);

/* Internal force of prescribed resultants:  f = sum_m L_m(u)^T H_m.
 *   resultant [22] in (N m), force [4 dof_per_node] out (N, N m) */
void pzs_shell_force_at(const pzs_element_type *type, unsigned dof_per_node,
                        const pzs_real *displacement, const pzs_real *resultant, pzs_real *force);

/* Deformed base vectors at the four corners: base vectors plus derivatives of u. */
void pzs_shell_corners(const pzs_element_type *type, unsigned dof_per_node,
                       const pzs_real *displacement, shell_corner shape[4]);

/* Stresses at the corners from resultants [22], the parts of warp and skew included.
 *   stress [4][10] out, order of D */
void pzs_shell_stresses(const pzs_element_type *type, const pzs_real *resultant,
                        pzs_real stress[4][10]);

/*
 * Replace the strains of the modes of a skewed element, warp included, by the resultants of the
 * same modes, in place. The strains that a mode does not keep are not read. strain [4][10] in:
 * strains; out: resultants times the element's area (N m)
 */
void pzs_shell_skewed_resultants(const pzs_element_type *type, pzs_real strain[4][10]);

/* Force of the stresses t at the corners of a deformed shape.  force [4 dof_per_node] out (N, N m).
 */
void pzs_shell_corner_force(const pzs_element_type *type, unsigned dof_per_node,
                            const shell_corner shape[4], pzs_real stress[4][10], pzs_real *force);
#endif

#endif
