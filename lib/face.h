/*
 * A face of the shell, 0 inner or 1 outer, as loads and contacts see it: at height z = -+ h/2 above the mean of the
 * two faces, so that a displacement of the face is w = mean + z difference/h, in the triad of the node.
 */
#ifndef PZS_FACE_H
#define PZS_FACE_H

#include "pzs.h"

/* Height of a face: -h/2 inner, h/2 outer, 0 for anything else. All elements of a shell share h. */
pzs_real face_height(const pzs_structure *s, unsigned face);

/* w [count][3] = displacement of the face at `count` nodes.  p [dof] in (model_gather) */
void face_gather(const pzs_model *model, const uint16_t *node, unsigned count, pzs_real z, const pzs_real *p,
                 pzs_real (*w)[3]);

/* f [dof] += force [count][3] on the face at height z. */
void face_scatter(const pzs_model *model, const uint16_t *node, unsigned count, pzs_real z, const pzs_real (*force)[3],
                  pzs_real *f);

/*
 * Normal eta = (g_1 + lam_1) x (g_2 + lam_2) of the deformed face at corner r, in the corner's frame; its length is
 * the area there over the reference area.
 *   w     [4][3]  in  displacement of the face at the corners
 *   eta   [3]     out
 *   slope [3][12] out its derivative with respect to w; NULL: not wanted
 */
void face_normal(const pzs_kind *kind, pzs_real z, const pzs_real (*w)[3], unsigned r, pzs_real eta[3],
                 pzs_real (*slope)[12]);

#endif
