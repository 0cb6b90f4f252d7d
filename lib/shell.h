/*
 * The GEX7P4 element: one table-driven kernel for every formulation.
 *
 * Four nodes, `unknowns` (7 or 6) a node in this order: mean u1 u2 u3, (u+ - u-)/h
 * of u1 u2 u3, (u3M - mean u3)/h. Strains are taken at the four corners in the
 * corner's own frame, as means and differences of the two faces, then turned into
 * the modes 00 01 10 11 of xi1^r1 xi2^r2, of which D keeps 22 components.
 */
#ifndef PZS_SHELL_H
#define PZS_SHELL_H

#include "pzs.h"

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
void shell_force(const pzs_kind *kind, unsigned unknowns, const pzs_real *u, pzs_real *f);

/* Stiffness at rest, column by column from shell_force. k [SHELL_PACKED(4 unknowns)] out, lower triangle. */
void shell_stiffness(const pzs_kind *kind, unsigned unknowns, pzs_real *k);

/*
 * Force of given resultants H0 of actuation or temperature, mode 00:  f = -L_00^T H0.
 *   h0 [10]         in  times the element's area (N m), order of D
 *   f  [4 unknowns] out
 */
void shell_given(const pzs_kind *kind, unsigned unknowns, const pzs_real *h0, pzs_real *f);

#if PZS_NONLINEAR
/*
 * Strains by mode at a displacement, exact to second order.  u [4 unknowns] in, e [4][10] out.
 */
void shell_strains_at(const pzs_kind *kind, unsigned unknowns, const pzs_real *u, pzs_real e[4][10]);

/*
 * Residual side of the virtual work at a displacement:  f = sum_m L_m(u)^T H_m.
 *   h [4][10] in resultants by mode, times area/3^(r1+r2)
 */
void shell_force_at(const pzs_kind *kind, unsigned unknowns, const pzs_real *u, pzs_real h[4][10], pzs_real *f);

/*
 * Tangent at a displacement under resultants h:  K = sum_m L_m^T D_m L_m + H_m A_m.
 *   k [SHELL_PACKED(4 unknowns)] out, lower triangle
 */
void shell_tangent(const pzs_kind *kind, unsigned unknowns, const pzs_real *u, pzs_real h[4][10], pzs_real *k);

/* Resultants by mode h = D e.  e, h [4][10]. */
void shell_resultants(const pzs_kind *kind, pzs_real e[4][10], pzs_real h[4][10]);
#endif

#endif
