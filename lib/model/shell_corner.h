/* The corners of the GEX7P4 element, for the files that make it up: shell.c, and shell_at.c at a
 * deformed shape. */
#ifndef PZS_LIB_SHELL_CORNER_H
#define PZS_LIB_SHELL_CORNER_H

#include "shell.h"

/* Strains in the order of D. */
enum { E11M, E11D, E22M, E22D, E33M, E33D, E12M, E12D, E13, E23 };

/* Corner on the other side of r along theta1 and theta2. */
static const uint8_t neighbour[4][2] = {{1, 3}, {0, 2}, {3, 1}, {2, 0}};

/* xi1^r1 xi2^r2 at the corners, by mode 00 01 10 11. */
static const pzs_real mode_sign[4][4] = {
    {1, 1, 1, 1}, {-1, -1, 1, 1}, {-1, 1, 1, -1}, {1, -1, 1, -1}};

/* Derivatives of a displacement at a corner: lam mean and difference/h by direction, beta mean, q.
 */
typedef struct corner {
    pzs_real mean[2][3];
    pzs_real diff[2][3];
    pzs_real beta[3];
    pzs_real q;
} corner;

#if PZS_NONLINEAR
/* Shape of the corners at displacement u: base vectors plus derivatives of the displacement. */
void pzs_shell_corners(const pzs_element_type *type, unsigned dof_per_node, const pzs_real *u,
                       corner shape[4]);

/* Stresses at the corners that go with resultants [22], the warp's share included. t [4][10] out,
 * order of D. */
void pzs_shell_stresses(const pzs_element_type *type, const pzs_real *resultant, pzs_real t[4][10]);

/* Force of stresses at corners of a shape.  f [4 unknowns] out. */
void pzs_shell_corner_force(const pzs_element_type *type, unsigned dof_per_node,
                            const corner shape[4], pzs_real t[4][10], pzs_real *f);
#endif

#endif
