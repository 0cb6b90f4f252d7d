/* SPDX-License-Identifier: BSD-2-Clause */
/* Displacement, force, base vectors and normal of a face of the shell (face.h). */
#include "face.h"
#include "../model/compact.h"
#include "../model/model.h"
#include "../model/shell.h"

#if PZS_NONLINEAR

pzs_real pzs_face_height(const pzs_structure *structure, unsigned face)
{
    const pzs_real half = pzs_structure_thickness(structure) / 2;
    if (face == 0)
        return -half;
    return face == 1 ? half : 0;
}

void pzs_face_gather(const pzs_model *model, const uint16_t *node, unsigned count, pzs_real height,
                     const pzs_real *vector, pzs_real (*displacement)[3])
{
    const unsigned dof_per_node = model->state.structure->dof_per_node;
    pzs_real gathered[SHELL_MAX];
    pzs_model_gather(model, node, count, vector, gathered);
    for (unsigned at = 0; at < count; at++)
        for (unsigned i = 0; i < 3; i++)
            displacement[at][i] =
                gathered[at * dof_per_node + i] + height * gathered[at * dof_per_node + 3 + i];
}

void pzs_face_scatter(const pzs_model *model, const uint16_t *node, unsigned count, pzs_real height,
                      const pzs_real (*force)[3], pzs_real *vector)
{
    const unsigned dof_per_node = model->state.structure->dof_per_node;
    pzs_real part[SHELL_MAX] = {0};
    for (unsigned at = 0; at < count; at++)
        for (unsigned i = 0; i < 3; i++) {
            part[at * dof_per_node + i] = force[at][i];
            part[at * dof_per_node + 3 + i] = height * force[at][i];
        }
    pzs_model_scatter(model, node, count, 1, part, vector);
}

void pzs_face_cross(const pzs_real left[3], const pzs_real right[3], pzs_real product[3])
{
    for (int i = 0; i < 3; i++)
        product[i] =
            left[(i + 1) % 3] * right[(i + 2) % 3] - left[(i + 2) % 3] * right[(i + 1) % 3];
}

void pzs_face_base(const pzs_element_type *type, pzs_real height, const pzs_real (*displacement)[3],
                   unsigned corner, pzs_real base[2][3])
{
    const unsigned neighbour[2] = {corner ^ 1u, 3u - corner};
    for (int direction = 0; direction < 2; direction++)
        for (int i = 0; i < 3; i++) {
            base[direction][i] =
                type->g_mean[corner][direction][i] + height * type->g_diff[corner][direction][i];
            for (int j = 0; j < 3; j++)
                base[direction][i] +=
                    type->s[corner][direction][i][j] * displacement[corner][j] +
                    type->t[corner][direction][i][j] * displacement[neighbour[direction]][j];
        }
}

void pzs_face_normal(const pzs_element_type *type, pzs_real height,
                     const pzs_real (*displacement)[3], unsigned corner, pzs_real eta[3])
{
    pzs_real base[2][3];
    pzs_face_base(type, height, displacement, corner, base);
    pzs_face_cross(base[0], base[1], eta);
}

#endif
