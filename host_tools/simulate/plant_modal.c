/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Motion of a plant in the vibration modes of its undeformed state, about its static equilibrium
 * (plant_motion.h).
 */
#include <stdlib.h>
#include <string.h>
#include "plant.h"
#include "plant_motion.h"

static int open_modal(plant *plant, char *error)
{
    const design *design = &plant->analysis.design;
    const size_t inputs = (size_t)(design->amplifiers + design->loads);
    plant->modal_input = calloc(inputs + 1, sizeof *plant->modal_input);
    if (!plant->modal_input || !inertia_open(&plant->inertia, &plant->modal))
        return scene_fault(plant->analysis.design.simulate.at, error, "out of memory");
    return 0;
}

static void close_modal(plant *plant)
{
    inertia_close(&plant->inertia);
    free(plant->modal_input);
}

/*
 * Set the inputs (voltages and loads) of the model of vibration modes to their present values. At
 * the first call after plant_rest, which requests a state of rest, the plant is at rest in the
 * equilibrium under these inputs.
 */
static void set_modal_inputs(plant *plant)
{
    const design *design = &plant->analysis.design;
    const size_t amplifiers = (size_t)design->amplifiers;
    memcpy(plant->modal_input, plant->input, amplifiers * sizeof *plant->modal_input);
    for (int k = 0; k < design->loads; k++)
        plant->modal_input[amplifiers + (size_t)k] = plant->input[plant_input(plant, k)];
    if (plant->is_at_rest)
        inertia_rest(&plant->inertia, plant->modal_input);
    else
        inertia_jump(&plant->inertia, plant->modal_input);
    plant->is_at_rest = false;
}

static void kick_modal(plant *plant, int load, double seconds)
{
    inertia_kick(&plant->inertia, (size_t)(plant->analysis.design.amplifiers + load), seconds);
}

static int advance_modal(plant *plant, double seconds, char *error)
{
    (void)error;
    set_modal_inputs(plant);
    inertia_advance(&plant->inertia, seconds);
    return 0;
}

static int modal_shape(plant *plant, double *shape, char *error)
{
    if (plant_static_shape(plant, shape, error) < 0)
        return -1;
    set_modal_inputs(plant);
    inertia_observe(&plant->inertia, 0, plant->modal.rows, plant->deviation);
    for (int i = 0; i < plant->analysis.design.targets; i++)
        shape[i] += plant->deviation[i];
    return 0;
}

static int modal_outputs(plant *plant, char *error)
{
    if (plant_static_outputs(plant, error) < 0)
        return -1;
    for (size_t i = 0; i < plant->modal.rows; i++)
        plant->value[i] += plant->deviation[i];
    return 0;
}

static int modal_displacement(plant *plant, double *displacement, char *error)
{
    const size_t dof = (size_t)plant->analysis.design.mesh.free_dof;
    if (plant_static_displacement(plant, displacement, error) < 0)
        return -1;
    for (size_t i = 0; i < plant->modal.modes; i++) {
        const double *modal_part =
            plant->vibration.shape + ((size_t)plant->vibration.rigid + i) * dof;
        for (size_t k = 0; k < dof; k++)
            displacement[k] += plant->inertia.deviation[i] * modal_part[k];
    }
    return 0;
}

const plant_motion plant_modal = {"modal",       open_modal,  close_modal,   kick_modal,
                                  advance_modal, modal_shape, modal_outputs, modal_displacement};
