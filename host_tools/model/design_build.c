/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Construction of the design (numerical model of a scene): structure, inputs, outputs and voltage
 * optimisation problem (design_build.h).
 */
#include "design_build.h"
#include <stdlib.h>
#include <string.h>
#include "electrodes.h"

/* Build mesh, inputs and outputs of a scene with a structure. */
static int build_structure(design *design, char *error)
{
    return mesh_build(&design->mesh, design->scene, error) == 0 &&
                   design_structure(design, error) == 0
               ? 0
               : -1;
}

/* Build points, inputs and outputs of a scene with a measured influence matrix. */
static int build_measured(design *design, char *error)
{
    return mesh_points(&design->mesh, design->scene, error) == 0 &&
                   design_measured(design, error) == 0
               ? 0
               : -1;
}

/*
 * Copy the sections of the scene that describe the structure and its parts, such as materials,
 * layers, supports and loads, into its design (numerical model).
 */
static void copy_parts(design *design, const scene *scene)
{
    design->name = scene->name;
    design->about = scene->about;
    design->path = scene->origin ? scene->origin->path : "";
    design->at = scene->at_surface;
    design->at_layers = scene->at_layers;
    design->units = scene->units;
    design->materials = scene->materials;
    design->material = scene->material;
    design->layers = scene->layers;
    design->layer = scene->layer;
    design->patch_grids = scene->patch_grids;
    design->patches = scene->patches;
    design->actuators = scene->actuators;
    design->actuator = scene->actuator;
    design->sensors = scene->sensors;
    design->sensor = scene->sensor;
    design->supports = scene->supports;
    design->support = scene->support;
    design->springs = scene->springs;
    design->spring = scene->spring;
    design->load = scene->load;
    design->outputs = scene->outputs;
    design->output = scene->output;
    design->quads = scene->quads;
    design->measured = scene->influence;
}

/*
 * Copy the settings of the scene that later stages (analysis, control, reports) use into its design
 * (numerical model).
 */
static void copy_tasks(design *design, const scene *scene)
{
    design->kinematics = scene->kinematics;
    design->tolerance = scene->tolerance;
    design->equilibrium = scene->equilibrium;
    design->contact = scene->contact;
    design->limits = scene->limits;
    design->goal = scene->target;
    design->compares = scene->compares;
    design->compare = scene->compare;
    design->estimate = scene->estimate;
    design->simulate = scene->simulate;
    design->dynamics = scene->dynamics;
    design->control = scene->control;
    design->safety = scene->safety;
    design->hysteresis = scene->hysteresis;
}

/*
 * List the names of the amplifiers and of the electrodes of sensors in the design (numerical model
 * of the scene). Returns 0, or -1 with error filled if memory runs out.
 */
static int list_names(design *design, const scene *scene, char *error)
{
    design->amplifier_name = calloc((size_t)scene->amplifiers + 1, sizeof *design->amplifier_name);
    design->electrode_name = calloc((size_t)scene->electrodes + 1, sizeof *design->electrode_name);
    if (!design->amplifier_name || !design->electrode_name)
        return scene_fault(scene->at_surface, error, "out of memory");
    for (int k = 0; k < scene->amplifiers; k++)
        scene_amplifier_name(scene, k, design->amplifier_name[k]);
    for (int k = 0; k < scene->electrodes; k++)
        scene_sensor_name(scene, k, design->electrode_name[k]);
    return 0;
}

int design_vary(const design *design, scene *copy)
{
    return scene_vary(copy, design->scene);
}

int design_build(design *design, const scene *scene, char *error)
{
    memset(design, 0, sizeof *design);
    design->scene = scene;
    copy_parts(design, scene);
    copy_tasks(design, scene);
    if (list_names(design, scene, error) == 0 &&
        (scene->influence.given ? build_measured : build_structure)(design, error) == 0 &&
        design_target_rows(design, error) == 0 && electrodes_build(design, error) == 0)
        return 0;
    design_free(design);
    return -1;
}
