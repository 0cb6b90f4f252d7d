/*
 * A face of the shell, 0 inner or 1 outer, as loads and contacts see it: at height z = -+ h/2 above
 * the mean of the two faces, so that a displacement of the face is w = mean + z difference/h, in
 * the triad of the node.
 */
#ifndef PZS_LIB_FACE_H
#define PZS_LIB_FACE_H

#include "pzs_nonlinear.h"

/* Height of a face: -h/2 inner, h/2 outer, 0 for anything else. All elements of a shell share h. */
pzs_real pzs_face_height(const pzs_structure *structure, unsigned face);

/* w [count][3] = displacement of the face at `count` nodes.  p [dof] in (pzs_model_gather) */
void pzs_face_gather(const pzs_model *model, const uint16_t *node, unsigned count, pzs_real z,
                     const pzs_real *p, pzs_real (*w)[3]);

/* f [dof] += force [count][3] on the face at height z. */
void pzs_face_scatter(const pzs_model *model, const uint16_t *node, unsigned count, pzs_real z,
                      const pzs_real (*force)[3], pzs_real *f);

/* Base vectors G_a = g_a + lam_a of the deformed face at corner r, in the corner's frame.  w [4][3]
 * in, displacement of the face at the corners */
void pzs_face_base(const pzs_element_type *type, pzs_real z, const pzs_real (*w)[3], unsigned r,
                   pzs_real g[2][3]);

/* Their normal eta = G_1 x G_2; its length is the area there over the reference area. */
void pzs_face_normal(const pzs_element_type *type, pzs_real z, const pzs_real (*w)[3], unsigned r,
                     pzs_real eta[3]);

/* c = a x b */
void pzs_face_cross(const pzs_real a[3], const pzs_real b[3], pzs_real c[3]);

#endif
