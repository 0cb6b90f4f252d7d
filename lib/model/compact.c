/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Access to the element types of a structure, whose tables may leave out what the library computes
 * from the nodes (compact.h).
 */
#include "compact.h"
#include <string.h>
#include "../core/vector3.h"
#include "shell_corner.h"

void pzs_corner_tables(const pzs_node *corner, const pzs_node *other, pzs_real inverse_length,
                       pzs_real middle, pzs_real s[3][3], pzs_real t[3][3], pzs_real g_mean[3],
                       pzs_real g_diff[3])
{
    pzs_real step[3], turn[3];
    for (int i = 0; i < 3; i++) {
        turn[i] = other->triad[2][i] - corner->triad[2][i];
        step[i] = other->position[i] - corner->position[i] + middle * turn[i];
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            t[i][j] = inverse_length * vector3_dot(corner->triad[i], other->triad[j]);
            s[i][j] = i == j ? -inverse_length : 0;
        }
        g_mean[i] = inverse_length * vector3_dot(corner->triad[i], step);
        g_diff[i] = inverse_length * vector3_dot(corner->triad[i], turn);
    }
}

void pzs_rebuild_type(const pzs_compact_type *compact, const pzs_node *node, pzs_element_type *type)
{
    for (unsigned corner = 0; corner < 4; corner++)
        for (unsigned direction = 0; direction < 2; direction++) {
            /*
             * Sign of the step along one surface coordinate (theta1 for direction 0, theta2 for
             * direction 1) from a corner of the element to its neighbour: 1 towards larger values,
             * -1 towards smaller ones. It is the opposite of the sign that the element coordinate
             * xi1 (or xi2) has at the corner: mode_sign[2] for xi1, mode_sign[1] for xi2.
             */
            const pzs_real sign = -mode_sign[2 - direction][corner];
            const unsigned other = neighbour[corner][direction];
            pzs_corner_tables(&node[compact->corner[corner]], &node[compact->corner[other]],
                              sign * compact->inverse_length[direction], compact->middle,
                              type->s[corner][direction], type->t[corner][direction],
                              type->g_mean[corner][direction], type->g_diff[corner][direction]);
        }
    memcpy(type->d, compact->d, sizeof type->d);
    memcpy(type->warp, compact->warp, sizeof type->warp);
    memcpy(type->skew, compact->skew, sizeof type->skew);
    type->thickness = compact->thickness;
    memcpy(type->height_squared, compact->height_squared, sizeof type->height_squared);
}

bool pzs_structure_has_types(const pzs_structure *structure)
{
    return structure->type != NULL || structure->compact != NULL;
}

pzs_real pzs_structure_thickness(const pzs_structure *structure)
{
    return structure->type != NULL ? structure->type[0].thickness : structure->compact[0].thickness;
}

const pzs_element_type *pzs_model_element_type(const pzs_model *model, uint32_t element)
{
    const pzs_structure *structure = model->state.structure;
    const uint16_t index = structure->element_type[element];
    if (structure->type != NULL)
        return &structure->type[index];
    pzs_rebuild_type(&structure->compact[index], structure->node, model->state.rebuilt);
    return model->state.rebuilt;
}
