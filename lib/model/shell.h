/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The four-node shell element (called GEX7P4 by its author Plotnikova, 2013): one code for all
 * formulations of the element, which differ only in their tables.
 *
 * Each node has dof_per_node (6 or 7) degrees of freedom: the mean displacement u1 u2 u3 of the two
 * faces; the difference of u1 u2 u3 between outer and inner face, divided by the thickness; and, as
 * the seventh, q: the amount by which u3 of the middle surface exceeds the mean of the faces,
 * divided by the thickness. Strains are computed at the four corners, in the frame of the corner,
 * as means and differences of the two faces. They are combined into four strain modes 00, 01, 10
 * and 11; mode r1 r2 varies over the element as xi1^r1 xi2^r2 with the element coordinates xi1 and
 * xi2. Each mode has ten strains; of these 40 strains, 22 are taken into account.
 */
#ifndef PZS_LIB_SHELL_H
#define PZS_LIB_SHELL_H

#include "pzs_model.h"

enum { SHELL_NODES = 4, SHELL_STRAINS = 10, SHELL_MODES = 4, SHELL_MAX = 28 };

/* Number of entries of a packed lower triangle of n rows. */
#define SHELL_PACKED(n) ((n) * ((n) + 1) / 2)

/*
 * Internal force of an element in the undeformed state, computed from its strains.
 *   displacement [4 dof_per_node] in   nodal displacement
 *                                      (m, or 1 for differences over the thickness)
 *   force        [4 dof_per_node] out  nodal force (N and N m); may be the same array as
 *                                      `displacement`
 * The small strains are formed as differences before anything is multiplied by a stiffness, so the
 * force keeps the digits that a product with the stiffness matrix loses on thin shells.
 */
void pzs_shell_force(const pzs_element_type *type, unsigned dof_per_node,
                     const pzs_real *displacement, pzs_real *force);

/*
 * Stiffness matrix of an element in the undeformed state, one column for each call of
 * pzs_shell_force.
 *   stiffness [SHELL_PACKED(4 dof_per_node)] out  packed lower triangle
 */
void pzs_shell_stiffness(const pzs_element_type *type, unsigned dof_per_node, pzs_real *stiffness);

/*
 * Nodal force of prescribed stress resultants (of actuation or temperature) that are constant over
 * an element, in the undeformed state: minus the internal force of these resultants.
 *   h0    [10]             in   resultants times the area of the element (N m), in the strain order
 *                               of pzs_element_type.d
 *   force [4 dof_per_node] out  nodal force (N and N m)
 */
void pzs_shell_prescribed_force(const pzs_element_type *type, unsigned dof_per_node,
                                const pzs_real *h0, pzs_real *force);

/*
 * Geometry of a deformed element at one corner, or a change of this geometry.
 *   mean [2][3]  base vectors along the surface coordinates theta1 and theta2, mean of both faces
 *                (dimensionless)
 *   diff [2][3]  base vectors of the outer face minus those of the inner face, divided by the
 *                thickness (1/m)
 *   beta [3]     director: position of the outer minus that of the inner face, divided by the
 *                thickness (dimensionless)
 *   q            displacement u3 of the middle surface minus the mean of both faces, divided by the
 *                thickness (dimensionless)
 * In a change under a displacement, mean and diff are derivatives of the displacement along the
 * surface, and beta and q are the changes of director and q.
 */
typedef struct shell_corner {
    pzs_real mean[2][3];
    pzs_real diff[2][3];
    pzs_real beta[3];
    pzs_real q;
} shell_corner;

#if PZS_NONLINEAR
/*
 * Number of stress resultants of an element: one for each strain that the element takes into
 * account, ten in strain mode 00, five in 01, five in 10 and two in 11. Strain mode r1 r2 varies
 * over the element as xi1^r1 xi2^r2, with the element coordinates xi1 and xi2. A resultant is the
 * stress that is conjugate to the strain, times area/3^(r1+r2) (N m).
 */
enum { SHELL_RESULTANTS = 22 };

/*
 * Strains of the four strain modes (constant, linear and bilinear over the element) of an element
 * at a displacement.
 *   displacement [4 dof_per_node] in   nodal displacement
 *                                      (m, or 1 for differences over the thickness)
 *   strain       [4][10]          out  ten strains of each mode, in the order of pzs_element_type.d
 */
void pzs_shell_strains_at(const pzs_element_type *type, unsigned dof_per_node,
                          const pzs_real *displacement, pzs_real strain[4][10]);

/*
 * Tangent stiffness K and internal force f of an element, for Newton's method with stress
 * resultants H that are independent of the displacement:
 *   f = sum over m of L_m^T H_m,   H = D e(u) + H0
 *   K = sum over m of (L_m^T D_m L_m + G_m A_m)
 * over the four strain modes m (constant, linear and bilinear over the element), with the strains e
 * at the displacement u, their first variation L and second variation A, the stiffness D, the
 * prescribed resultants H0, and the resultants G for the geometric part of K.
 *   displacement [4 dof_per_node] in   nodal displacement
 *                                      (m, or 1 for differences over the thickness)
 *   given        [10]             in   H0, constant over the element, times its area (N m), in the
 *                                      strain order of pzs_element_type.d; NULL: zero
 *   resultant    [22]             in   G (N m), with H0, in the order of SHELL_RESULTANTS; NULL: H
 *   force        [4 dof_per_node] out  internal force f (N and N m)
 *   stiffness    [SHELL_PACKED(4 dof_per_node)] out  tangent K, packed lower triangle
 */
void pzs_shell_system(const pzs_element_type *type, unsigned dof_per_node,
                      const pzs_real *displacement, const pzs_real *given,
                      const pzs_real *resultant, pzs_real *force, pzs_real *stiffness);

/*
 * Stress resultants of an element, extrapolated along an increment of the displacement: the
 * stiffness of the strains times (strains + their first variation), plus the prescribed resultants.
 *   du        [4 dof_per_node] in   increment (m, or 1 for differences over the thickness); NULL:
 *                                   no extrapolation
 *   given     [10]             in   prescribed resultants, constant over the element, times its
 *                                   area (N m); NULL: zero
 *   resultant [22]             out  stress resultants of all strain modes, times the area (N m)
 */
void pzs_shell_resultants(const pzs_element_type *type, unsigned dof_per_node,
                          const pzs_real *displacement, const pzs_real *du, const pzs_real *given,
                          pzs_real *resultant);

/*
 * Internal nodal force of given stress resultants of an element at a displacement.
 *   resultant [22]             in   stress resultants of all strain modes (constant, linear and
 *                                   bilinear over the element), times the area (N m)
 *   force     [4 dof_per_node] out  internal force (N and N m)
 */
void pzs_shell_force_at(const pzs_element_type *type, unsigned dof_per_node,
                        const pzs_real *displacement, const pzs_real *resultant, pzs_real *force);

/*
 * Compute the deformed base vectors of an element at its four corners, from its nodal displacement.
 */
void pzs_shell_corners(const pzs_element_type *type, unsigned dof_per_node,
                       const pzs_real *displacement, shell_corner shape[4]);

/*
 * Compute the stresses at the four corners of an element from the stress resultants of its strain
 * modes (constant, linear and bilinear over the element), with the corrections for warp and skew.
 *   resultant [22]    in   stress resultants times the area (N m), mode after mode: ten of the
 *                          constant mode 00, five of mode 01, five of mode 10 and two of mode 11,
 *                          in the order of kept_strain
 *   stress    [4][10] out  stresses at each corner times a quarter of the area (N m), one for
 *                          each of the ten strains, in the order of pzs_element_type.d
 */
void pzs_shell_stresses(const pzs_element_type *type, const pzs_real *resultant,
                        pzs_real stress[4][10]);

/*
 * Replace the strains of the four strain modes (constant, linear and bilinear over the element) of
 * a skewed element by their stress resultants, in place. Of the ten strains of each mode, only
 * those that the mode takes into account (kept_strain) are read; they are already corrected for the
 * warp of the element.
 *   strain [4][10] in/out  in: strains; out: resultants times the area of the element (N m)
 */
void pzs_shell_skewed_resultants(const pzs_element_type *type, pzs_real strain[4][10]);

/*
 * Internal nodal force of the stresses at the four corners of a deformed element.
 *   shape  [4]              in   deformed base vectors at the corners
 *   stress [4][10]          in   stresses at each corner, as pzs_shell_stresses returns them (N m)
 *   force  [4 dof_per_node] out  internal force (N and N m)
 */
void pzs_shell_corner_force(const pzs_element_type *type, unsigned dof_per_node,
                            const shell_corner shape[4], pzs_real stress[4][10], pzs_real *force);
#endif

#endif
