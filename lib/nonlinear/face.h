/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * A face of the shell (0 inner, 1 outer), to which loads and contact apply. It lies at height z =
 * -h/2 or h/2 above the mean of the two faces. The displacement of the face in the triad of a node
 * is w = mean + z difference/h.
 */
#ifndef PZS_LIB_FACE_H
#define PZS_LIB_FACE_H

#include "pzs_nonlinear.h"

/*
 * Height of a face (m): -h/2 inner, h/2 outer, 0 for any other number. All elements of a shell have
 * the same thickness h.
 */
pzs_real pzs_face_height(const pzs_structure *structure, unsigned face);

/*
 * Displacement displacement [count][3] (m) of the face at height z at `count` nodes.  vector
 * [free_dof] in, displacement
 */
void pzs_face_gather(const pzs_model *model, const uint16_t *node, unsigned count, pzs_real height,
                     const pzs_real *vector, pzs_real (*displacement)[3]);

/* vector [free_dof] += force [count][3] (N) that acts on the face at height z. */
void pzs_face_scatter(const pzs_model *model, const uint16_t *node, unsigned count, pzs_real height,
                      const pzs_real (*force)[3], pzs_real *vector);

/*
 * Base vectors G_a = g_a + lam_a of the deformed face at corner r, in the frame of the corner.
 *   displacement [4][3] in  displacement of the face at the corners (m)
 */
void pzs_face_base(const pzs_element_type *type, pzs_real height, const pzs_real (*displacement)[3],
                   unsigned corner, pzs_real base[2][3]);

/*
 * Normal eta = G_1 x G_2 of the deformed face at corner r. Its length is the deformed area over the
 * reference area.
 *   displacement [4][3] in  displacement of the face at the corners (m)
 */
void pzs_face_normal(const pzs_element_type *type, pzs_real height,
                     const pzs_real (*displacement)[3], unsigned corner, pzs_real eta[3]);

/* Vector product c = a x b. */
void pzs_face_cross(const pzs_real left[3], const pzs_real right[3], pzs_real product[3]);

#endif
