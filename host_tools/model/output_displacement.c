/* SPDX-License-Identifier: BSD-2-Clause */
/* Outputs that are displacements (output_calls.h). */
#include "design.h"
#include "node_forces.h"
#include "output_calls.h"

static void add_row(const mesh *mesh, const scene_output *output, int node, double *dense)
{
    double weight[7];
    design_output_weights(mesh, node, output->component, output->face, weight);
    node_add(mesh, node, 1, weight, dense);
}

const output_calls displacement_calls = {.add_row = add_row};
