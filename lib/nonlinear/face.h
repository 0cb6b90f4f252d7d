/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * A face of the shell (0 inner, 1 outer), on which loads and contact act. Its displacement in the
 * local axes of a node is
 *   mean + height * difference
 *   mean        mean displacement of both faces (m)
 *   height      height above the middle between both faces: half the thickness, negative for the
 *               inner face (m)
 *   difference  displacement of the outer minus the inner face, divided by the thickness
 */
#ifndef PZS_LIB_FACE_H
#define PZS_LIB_FACE_H

#include "pzs_nonlinear.h"

/*
 * Return the height of a face above the mean of the two faces (m): minus half the thickness for the
 * inner face, half the thickness for the outer face, 0 for any other number of the face. All
 * elements of a shell have the same thickness.
 */
pzs_real pzs_face_height(const pzs_structure *structure, unsigned face);

/*
 * Compute the displacement of a face of the shell at some of its nodes.
 *   height                  in   height of the face above the mean of the two faces (m)
 *   vector       [free_dof] in   displacement over the free degrees of freedom
 *                                (m, or 1 for differences over the thickness)
 *   displacement [count][3] out  displacement of the face in the frames of the nodes (m)
 */
void pzs_face_gather(const pzs_model *model, const uint16_t *node, unsigned count, pzs_real height,
                     const pzs_real *vector, pzs_real (*displacement)[3]);

/*
 * Add forces that act on some nodes of one face of the shell to a force over the free degrees of
 * freedom.
 *   height             in      height of the face above the mean of the two faces (m)
 *   force  [count][3]  in      forces in the frames of the nodes (N)
 *   vector [free_dof]  in/out  sum (N and N m)
 */
void pzs_face_scatter(const pzs_model *model, const uint16_t *node, unsigned count, pzs_real height,
                      const pzs_real (*force)[3], pzs_real *vector);

/*
 * Compute the base vectors of the deformed face at one corner of an element: its tangents in the
 * two mesh directions xi1 and xi2 of the element. All vectors have components in the orthonormal
 * frame of the corner.
 *   displacement [4][3] in   displacement of the face at the corners (m)
 *   base         [2][3] out  base vectors (dimensionless)
 */
void pzs_face_base(const pzs_element_type *type, pzs_real height, const pzs_real (*displacement)[3],
                   unsigned corner, pzs_real base[2][3]);

/*
 * Compute the normal of the deformed face at one corner of an element, the vector product of its
 * base vectors. Its length is the ratio of deformed to undeformed area.
 *   displacement [4][3] in   displacement of the face at the corners (m)
 *   eta          [3]    out  normal (dimensionless)
 */
void pzs_face_normal(const pzs_element_type *type, pzs_real height,
                     const pzs_real (*displacement)[3], unsigned corner, pzs_real eta[3]);

/* Compute the vector product of two vectors. */
void pzs_face_cross(const pzs_real left[3], const pzs_real right[3], pzs_real product[3]);

#endif
