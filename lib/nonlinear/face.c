/* SPDX-License-Identifier: BSD-2-Clause */
/* Displacement, force and normal of a face of the shell (face.h). */
#include "face.h"
#include "../model/model.h"
#include "../model/shell.h"

#if PZS_NONLINEAR

pzs_real pzs_face_height(const pzs_structure *structure, unsigned face)
{
    const pzs_real half = structure->type[0].thickness / 2;
    if (face == 0)
        return -half;
    return face == 1 ? half : 0;
}

void pzs_face_gather(const pzs_model *model, const uint16_t *node, unsigned count, pzs_real z,
                     const pzs_real *p, pzs_real (*w)[3])
{
    const unsigned dof_per_node = model->state.structure->dof_per_node;
    pzs_real u[SHELL_MAX];
    pzs_model_gather(model, node, count, p, u);
    for (unsigned r = 0; r < count; r++)
        for (unsigned i = 0; i < 3; i++)
            w[r][i] = u[r * dof_per_node + i] + z * u[r * dof_per_node + 3 + i];
}

void pzs_face_scatter(const pzs_model *model, const uint16_t *node, unsigned count, pzs_real z,
                      const pzs_real (*force)[3], pzs_real *f)
{
    const unsigned dof_per_node = model->state.structure->dof_per_node;
    pzs_real part[SHELL_MAX] = {0};
    for (unsigned r = 0; r < count; r++)
        for (unsigned i = 0; i < 3; i++) {
            part[r * dof_per_node + i] = force[r][i];
            part[r * dof_per_node + 3 + i] = z * force[r][i];
        }
    pzs_model_scatter(model, node, count, 1, part, f);
}

void pzs_face_cross(const pzs_real a[3], const pzs_real b[3], pzs_real c[3])
{
    for (int i = 0; i < 3; i++)
        c[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

void pzs_face_base(const pzs_element_type *type, pzs_real z, const pzs_real (*w)[3], unsigned r,
                   pzs_real g[2][3])
{
    const unsigned neighbour[2] = {r ^ 1u, 3u - r};
    for (int a = 0; a < 2; a++)
        for (int i = 0; i < 3; i++) {
            g[a][i] = type->g_mean[r][a][i] + z * type->g_diff[r][a][i];
            for (int j = 0; j < 3; j++)
                g[a][i] += type->s[r][a][i][j] * w[r][j] + type->t[r][a][i][j] * w[neighbour[a]][j];
        }
}

void pzs_face_normal(const pzs_element_type *type, pzs_real z, const pzs_real (*w)[3], unsigned r,
                     pzs_real eta[3])
{
    pzs_real g[2][3];
    pzs_face_base(type, z, w, r, g);
    pzs_face_cross(g[0], g[1], eta);
}

#endif
