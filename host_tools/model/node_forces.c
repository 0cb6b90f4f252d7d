/* SPDX-License-Identifier: BSD-2-Clause */
/* Displacements and forces at nodes as weighted sums over the dof of the nodes (node_forces.h). */
#include "node_forces.h"
#include <string.h>
#include "../../lib/model/shell.h"

void node_direction(const surface_point *point, scene_component component, double unit[3])
{
    for (int axis = 0; axis < 3; axis++)
        unit[axis] = component <= COMPONENT_U3 ? component - COMPONENT_U1 == (unsigned)axis
                                               : point->triad[axis][component - COMPONENT_X];
}

double node_face_height(scene_face face, double thickness)
{
    if (face == FACE_OUTER)
        return thickness / 2;
    return face == FACE_INNER ? -thickness / 2 : 0;
}

void node_face_weights(const mesh *mesh, scene_face face, const double direction[3],
                       double weight[7])
{
    for (int axis = 0; axis < 3; axis++) {
        weight[axis] = direction[axis];
        weight[3 + axis] = node_face_height(face, mesh->laminate.thickness) * direction[axis];
    }
    weight[6] = 0;
}

void node_add(const mesh *mesh, int node, double factor, const double *weight, double *dense)
{
    double turned[7];
    memcpy(turned, weight, mesh->dof_per_node * sizeof *turned);
    mesh_turn_to_dof(mesh, node, turned);
    for (unsigned i = 0; i < mesh->dof_per_node; i++) {
        const uint16_t dof = mesh->node_dof[(size_t)node * mesh->dof_per_node + i];
        if (dof != PZS_CONSTRAINED)
            dense[dof] += factor * turned[i];
    }
}

double node_sum(const mesh *mesh, int node, const double *weight, const double *displacement)
{
    double turned[7], sum = 0;
    memcpy(turned, weight, mesh->dof_per_node * sizeof *turned);
    mesh_turn_to_dof(mesh, node, turned);
    for (unsigned i = 0; i < mesh->dof_per_node; i++) {
        const uint16_t dof = mesh->node_dof[(size_t)node * mesh->dof_per_node + i];
        if (dof != PZS_CONSTRAINED)
            sum += turned[i] * displacement[dof];
    }
    return sum;
}

void node_add_resultants(const mesh *mesh, int element, const double h0[LAMINATE_STRAINS],
                         double *dense)
{
    double force[SHELL_MAX];
    pzs_shell_prescribed_force(&mesh->type[mesh->element_type[element]], mesh->dof_per_node, h0,
                               force);
    for (int corner = 0; corner < 4; corner++)
        node_add(mesh, mesh->element[element][corner], 1,
                 force + (unsigned)corner * mesh->dof_per_node, dense);
}
