/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The ways in which the motion of a simulated plant is computed, one in each row of a table in
 * plant.c, and the functions for the static equilibrium, which all of them use.
 */
#ifndef PLANT_MOTION_H
#define PLANT_MOTION_H

struct plant;

/*
 * One way in which the motion of a plant is computed. The functions that may fail return 0, or -1
 * with error filled. The inputs of the plant (`input`: voltages, loads, temperature) are set before
 * each call.
 */
typedef struct plant_motion {
    const char *name;
    /*
     * open: prepare the computation of the motion, after the vibration modes of the plant have been
     * computed. close: release the memory that `open` has allocated.
     */
    int (*open)(struct plant *plant, char *error);
    void (*close)(struct plant *plant);
    /*
     * Apply the impulse of a load to the plant at one instant: its force multiplied by `seconds`.
     */
    void (*kick)(struct plant *plant, int load, double seconds);
    /*
     * Advance the motion of the plant by a time under its present inputs (voltages, loads and
     * temperature).
     */
    int (*advance)(struct plant *plant, double seconds, char *error);
    /*
     * Compute the shape at this instant and, for a plant with inertia, the deviation of every
     * output row from the static equilibrium.
     *   shape [targets] out  displacements
     */
    int (*shape)(struct plant *plant, double *shape, char *error);
    /*
     * Compute the values of all outputs in the latest shape of the plant, into the member `value`
     * of the plant.
     */
    int (*outputs)(struct plant *plant, char *error);
    /*
     * Compute the displacement vector of the plant in its latest shape.
     *   displacement [free_dof] out  displacement of each free degree of freedom
     */
    int (*displacement)(struct plant *plant, double *displacement, char *error);
} plant_motion;

extern const plant_motion plant_quasi_static, plant_modal, plant_nonlinear;

/*
 * Return the index of the structure's input that belongs to a load. On a nonlinear structure each
 * follower load (load that turns with the surface) has its own input behind those of all loads, in
 * the order of the loads.
 */
int plant_input(const struct plant *plant, int load);

/*
 * Static equilibrium of a plant under its present inputs. Each returns 0, or -1 with error filled.
 *   plant_static_shape         computes the equilibrium and the displacements of the target rows,
 *       shape [targets]; call it first
 *   plant_static_outputs       stores all outputs in this equilibrium in the plant's member `value`
 *   plant_static_displacement  returns the displacement vector [free_dof] of this equilibrium
 */
int plant_static_shape(struct plant *plant, double *shape, char *error);
int plant_static_outputs(struct plant *plant, char *error);
int plant_static_displacement(struct plant *plant, double *displacement, char *error);

#endif
