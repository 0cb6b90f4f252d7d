/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The four-node shell element (called GEX7P4 by its author Plotnikova, 2013). One code serves all
 * formulations of the element, which differ only in their tables.
 *
 * Degrees of freedom of a node (dof_per_node: 6 or 7):
 *   u1 u2 u3  mean displacement of the two faces
 *   u1 u2 u3  difference between outer and inner face, divided by the thickness
 *   q         only if dof_per_node is 7: u3 of the middle surface minus the mean u3 of the faces,
 *             divided by the thickness
 *
 * Strains at the four corners are combined into the strain modes 00, 01, 10 and 11, with ten
 * strains each, of which 22 are taken into account. Mode ab varies as xi1^a xi2^b with the element
 * coordinates xi1, xi2.
 */
#ifndef PZS_LIB_SHELL_H
#define PZS_LIB_SHELL_H

#include "pzs_model.h"

enum { SHELL_NODES = 4, SHELL_STRAINS = 10, SHELL_MODES = 4, SHELL_MAX = 28 };

/* Number of entries of a packed lower triangle of n rows. */
#define SHELL_PACKED(n) ((n) * ((n) + 1) / 2)

/*
 * Internal force of an element in the undeformed state, computed from its strains. Strains are
 * formed as differences before any stiffness multiplies them, so the force keeps digits that a
 * product with the stiffness matrix loses on thin shells.
 *   displacement [4 dof_per_node] in   nodal displacement
 *                                      (m, or 1 for differences over the thickness)
 *   force        [4 dof_per_node] out  nodal force (N and N m); may be the same array as
 *                                      `displacement`
 */
void pzs_shell_force(const pzs_element_type *type, unsigned dof_per_node,
                     const pzs_real *displacement, pzs_real *force);

/*
 * Return twice the strain energy of an element in the undeformed state, from its strains: the sum
 * of strain times stress resultant. All its terms belong to squares of strains, so that it keeps
 * digits that displacement times force would lose.
 *   displacement [4 dof_per_node] in   nodal displacement
 *                                      (m, or 1 for differences over the thickness)
 */
pzs_real pzs_shell_energy(const pzs_element_type *type, unsigned dof_per_node,
                          const pzs_real *displacement);

/*
 * Stiffness matrix of an element in the undeformed state, one column for each call of
 * pzs_shell_force.
 *   stiffness [SHELL_PACKED(4 dof_per_node)] out  packed lower triangle
 */
void pzs_shell_stiffness(const pzs_element_type *type, unsigned dof_per_node, pzs_real *stiffness);

/*
 * Nodal force of prescribed stress resultants (of actuation or temperature) that are constant over
 * an element: minus the internal force of these resultants in the undeformed state.
 *   h0    [10]             in   resultants times the area of the element (N m), in the strain order
 *                               of pzs_element_type.d
 *   force [4 dof_per_node] out  nodal force (N and N m)
 */
void pzs_shell_prescribed_force(const pzs_element_type *type, unsigned dof_per_node,
                                const pzs_real *h0, pzs_real *force);

/*
 * Geometry of a deformed element at one corner, or its change under a displacement.
 *   mean [2][3]  base vectors along the surface coordinates theta1 and theta2, mean of both faces
 *                (dimensionless); change: derivatives of the displacement
 *   diff [2][3]  base vectors of the outer face minus those of the inner face, divided by the
 *                thickness (1/m); change: derivatives of the displacement
 *   beta [3]     director: position of the outer minus that of the inner face, divided by the
 *                thickness (dimensionless)
 *   q            displacement u3 of the middle surface minus the mean of both faces, divided by the
 *                thickness (dimensionless)
 */
typedef struct shell_corner {
    pzs_real mean[2][3];
    pzs_real diff[2][3];
    pzs_real beta[3];
    pzs_real q;
} shell_corner;

#if PZS_NONLINEAR
/*
 * Number of stress resultants of an element: ten in strain mode 00, five in 01, five in 10 and two
 * in 11. A resultant belongs to a stress, integrated over the thickness (N/m), that varies over
 * the element as xi1^a xi2^b in mode ab, with the element coordinates xi1 and xi2. It is the factor
 * of this variation times area/3^(a+b) (N m).
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
 * resultants H that are independent of the displacement u:
 *   f = sum over m of L_m^T H_m,   H = D e(u) + H0
 *   K = sum over m of (L_m^T D_m L_m + G_m A_m)
 *   m        strain mode (constant, linear or bilinear over the element)
 *   e, L, A  strains, their first and second variation
 *   D        stiffness of the strains
 *   H0, G    prescribed resultants; resultants for the geometric part of K
 *   displacement [4 dof_per_node] in   nodal displacement u
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
 * Stress resultants of an element, extrapolated along an increment of the displacement:
 *   stiffness of the strains * (strains + first variation of the strains) + prescribed resultants
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
 * modes, with the corrections for warp and skew.
 *   resultant [22]    in   stress resultants times the area (N m), mode after mode in the order of
 *                          kept_strain
 *   stress    [4][10] out  stresses at each corner times a quarter of the area (N m), in the order
 *                          of pzs_element_type.d
 */
void pzs_shell_stresses(const pzs_element_type *type, const pzs_real *resultant,
                        pzs_real stress[4][10]);

/*
 * Replace the strains of the four strain modes of a skewed element by their stress resultants, in
 * place. Only the strains of kept_strain are read; they must be corrected for the warp of the
 * element.
 *   strain [4][10] in/out  in: strains; out: resultants times the area of the element (N m)
 */
void pzs_shell_skewed_resultants(const pzs_element_type *type, pzs_real strain[4][10]);

/*
 * Internal nodal force of the stresses at the four corners of a deformed element.
 *   shape  [4]              in   deformed base vectors at the corners
 *   stress [4][10]          in   ten stress resultants at each corner times a quarter of the area
 *                                of the element (N m), from pzs_shell_stresses
 *   force  [4 dof_per_node] out  internal force (N and N m)
 */
void pzs_shell_corner_force(const pzs_element_type *type, unsigned dof_per_node,
                            const shell_corner shape[4], pzs_real stress[4][10], pzs_real *force);
#endif

#endif
