/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Outputs that are rotations of the normal of the shell at nodes (output_calls.h). With the normal
 * D and the difference beta of both faces' displacements over the thickness, the director of the
 * deformed shell is D + beta. The rotation vector is D x beta under linear kinematics. Under
 * nonlinear ones it has the direction of D x (D + beta), and its length is the angle between both.
 */
#include <math.h>
#include "../mesh/springs.h"
#include "../quads/vector.h"
#include "equilibrium.h"
#include "node_forces.h"
#include "output_calls.h"

/* Axis of an output: local axis 1 or 2 of the shell, or a global axis. */
static scene_direction axis_of(const scene_output *output)
{
    static const scene_component axis[] = {COMPONENT_U1, COMPONENT_U2, COMPONENT_X, COMPONENT_Y,
                                           COMPONENT_Z};
    return (scene_direction){.given = true, .component = axis[output->part]};
}

static void add_row(const mesh *mesh, const scene_output *output, int node, double *dense)
{
    const scene_direction axis = axis_of(output);
    double weight[7];
    (void)springs_rotation(&mesh->point[node], &axis, weight);
    node_add(mesh, node, 1, weight, dense);
}

/*
 * Component of the rotation vector along the axis of the output (rad), of the displacement that the
 * nonlinear solver has reached.
 */
static double value(const output_state *state, int k, int i)
{
    const design *design = state->design;
    const int node = design->place_node[design->place_first[k] + i];
    const scene_direction axis = axis_of(&design->output[k]);
    const double *normal = design->mesh.point[node].triad[2];
    double beta[3] = {0, 0, 0}, turn[3], along[3];
    for (int component = 0; component < 3; component++) {
        double weight[7] = {0};
        weight[3 + component] = 1;
        const double size =
            node_sum(&design->mesh, node, weight, state->equilibrium->solver.info.displacement);
        for (int j = 0; j < 3; j++)
            beta[j] += size * design->mesh.point[node].triad[component][j];
    }
    vector_cross(normal, beta, turn);
    springs_direction(&design->mesh.point[node], &axis, along);
    const double sine = vector_length(turn);
    const double angle = atan2(sine, 1 + vector_dot(normal, beta));
    return sine > 0 ? vector_dot(along, turn) * angle / sine : 0;
}

static int check(const mesh *mesh, const scene_output *output, int node, char *error)
{
    const scene_direction axis = axis_of(output);
    double weight[7];
    if (springs_rotation(&mesh->point[node], &axis, weight) == 0)
        return 0;
    return scene_fault(output->at, error,
                       "the axis of rotation '%s' is normal to the shell at %s, which has no "
                       "rotation about its normal; choose another axis or another place",
                       output->name, mesh_node_text(mesh, node).text);
}

const output_calls rotation_calls = {.add_row = add_row, .value = value, .check = check};
