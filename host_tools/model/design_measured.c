/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Inputs and outputs of a scene with a measured influence matrix (design.h). The dof are the
 * outputs themselves, so that every output row has one entry; the inputs have no nodal forces.
 */
#include "design.h"
#include <math.h>
#include <stdlib.h>
#include "../data/point_area.h"
#include "vibration.h"

/*
 * Build the output rows of a scene with a measured influence matrix; row i has the single entry 1
 * at dof i. Returns whether memory sufficed.
 */
static bool make_outputs(design *design)
{
    const size_t count = (size_t)design->mesh.free_dof;
    uint32_t *start = calloc(count + 1, sizeof *start);
    uint16_t *dof = calloc(count + 1, sizeof *dof);
    double *value = calloc(count + 1, sizeof *value);
    pzs_rows *rows = &design->structure.output;
    *rows = (pzs_rows){(uint16_t)count, start, dof, value};
    for (size_t i = 0; i < count && start && dof && value; i++) {
        start[i + 1] = (uint32_t)i + 1;
        dof[i] = (uint16_t)i;
        value[i] = 1;
    }
    return start && dof && value;
}

/*
 * Compute the weights of the controlled displacements (target rows): all 1, or by area and scaled
 * to a mean square of 1. Returns 0, or -1 with error filled.
 */
static int make_weights(design *design, char *error)
{
    const scene *scene = design->scene;
    const size_t count = (size_t)design->targets;
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        design->weight[i] = 1;
    if (!scene->target.weight_area)
        return 0;
    if (point_areas(count, scene->influence.place, design->weight) < 0)
        return scene_fault(scene->target.what.at, error, "out of memory");
    for (size_t i = 0; i < count; i++)
        sum += design->weight[i];
    for (size_t i = 0; i < count; i++)
        design->weight[i] = sqrt(design->weight[i] * (double)count / sum);
    return 0;
}

int design_measured(design *design, char *error)
{
    const scene *scene = design->scene;
    const size_t count = scene->target.given ? (size_t)design->mesh.free_dof : 0;
    if (vibration_check_measured(&scene->influence, error) < 0)
        return -1;
    design->amplifiers = scene->amplifiers;
    design->sensor_first = design->amplifiers;
    design->targets = (int)count;
    design->structure.free_dof = (uint16_t)design->mesh.free_dof;
    design->structure.input.count = (uint16_t)design->amplifiers;
    design->structure.scene = scene->hash;
    design->target = calloc(count + 1, sizeof *design->target);
    design->weight = calloc(count + 1, sizeof *design->weight);
    design->target_node = calloc(count + 1, sizeof *design->target_node);
    design->named_first = calloc(1, sizeof *design->named_first);
    design->place_first = calloc(1, sizeof *design->place_first);
    if (!make_outputs(design) || !design->target || !design->weight || !design->target_node ||
        !design->named_first || !design->place_first)
        return scene_fault(scene->influence.at, error, "%zu outputs do not fit into memory", count);
    for (size_t i = 0; i < count; i++)
        design->target_node[i] = (int)i;
    return make_weights(design, error);
}
