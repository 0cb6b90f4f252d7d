/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Motion of a nonlinear plant with all degrees of freedom of its mesh, at large rotation
 * (plant_motion.h, shell_motion.h).
 */
#include <string.h>
#include "plant.h"
#include "plant_motion.h"

static int open_nonlinear(plant *plant, char *error)
{
    const design *design = &plant->analysis.design;
    const double interval = 1 / design->control.rate;
    const double step = design->simulate.steps > 0 ? interval / design->simulate.steps
                                                   : shell_motion_step(&plant->vibration, interval);
    return shell_motion_open(&plant->shell_motion, &plant->analysis.equilibrium, &plant->vibration,
                             step, error);
}

static void close_nonlinear(plant *plant)
{
    shell_motion_close(&plant->shell_motion);
}

/*
 * At the first call after plant_rest, which requests a state of rest, set the plant to rest in the
 * equilibrium under the present inputs.
 */
static int settle(plant *plant, char *error)
{
    if (!plant->is_at_rest)
        return 0;
    if (plant_static_shape(plant, plant->deviation, error) < 0)
        return -1;
    shell_motion_rest(&plant->shell_motion, plant->analysis.equilibrium.solver.info.displacement,
                      plant->input);
    plant->is_at_rest = false;
    return 0;
}

static void kick_nonlinear(plant *plant, int load, double seconds)
{
    shell_motion_kick(&plant->shell_motion, (uint32_t)plant_input(plant, load), seconds);
}

static int advance_nonlinear(plant *plant, double seconds, char *error)
{
    const design *design = &plant->analysis.design;
    if (settle(plant, error) < 0)
        return -1;
    if (shell_motion_advance(&plant->shell_motion, plant->input, seconds))
        return 0;
    return scene_fault(design->simulate.at, error,
                       "the motion of the plant does not converge, even with time steps of %.3g of "
                       "a tick; write motion: modal in simulate.plant",
                       plant->shell_motion.step_most * design->control.rate /
                           (1 << SHELL_MOTION_HALVINGS));
}

static int nonlinear_shape(plant *plant, double *shape, char *error)
{
    const design *design = &plant->analysis.design;
    if (settle(plant, error) < 0)
        return -1;
    pzs_observe(&design->structure, shell_motion_deviation(&plant->shell_motion, plant->input),
                plant->deviation);
    design_shape(design, plant->shell_motion.displacement, shape);
    return 0;
}

static int nonlinear_outputs(plant *plant, char *error)
{
    (void)error;
    pzs_observe(&plant->analysis.design.structure, plant->shell_motion.displacement, plant->value);
    return 0;
}

static int nonlinear_displacement(plant *plant, double *displacement, char *error)
{
    (void)error;
    memcpy(displacement, plant->shell_motion.displacement,
           (size_t)plant->analysis.design.mesh.free_dof * sizeof *displacement);
    return 0;
}

const plant_motion plant_nonlinear = {"nonlinear",       open_nonlinear,        close_nonlinear,
                                      kick_nonlinear,    advance_nonlinear,     nonlinear_shape,
                                      nonlinear_outputs, nonlinear_displacement};
