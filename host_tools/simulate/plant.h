/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The plant of a simulation: the structure of the scene with material constants, loads and a
 * temperature change that the controller does not know. Ways in which a plant moves
 * (plant_motion.h):
 *   quasi-static  every shape is the static equilibrium
 *   modal         vibration about the static equilibrium in the modes of the undeformed state
 *       (inertia.h); other modes follow the inputs without delay. Valid while the deformation
 *       hardly changes the natural frequencies
 *   nonlinear     all degrees of freedom move with their mass at large rotation (shell_motion.h)
 */
#ifndef PLANT_H
#define PLANT_H

#include "../model/voltages.h"
#include "../model/modal.h"
#include "inertia.h"
#include "shell_motion.h"

struct plant_motion;

typedef struct plant {
    scene scene;  /* copy of the scene in which the material constants are those of the simulated
                     structure */
    expr *kelvin; /* formula of a temperature change of 1 K, which is appended to the loads where
                     events change the temperature; NULL: they do not */
    analysis analysis;
    double *input; /* [inputs] values of the inputs for which the next shape of the plant is
                      computed: voltages, loads and temperature change. A nonlinear structure also
                      has inputs for prescribed displacements and for the motion of a contact's
                      rigid body */
    double *computed_input; /* [inputs] input values of the latest shape of the plant: voltages (V),
                               load factors (dimensionless) and temperature change (K) */
    double *scene_input; /* [inputs] values of all inputs at full load, as given in the scene file,
                            such as loads and support displacements */
    double *value;   /* [outputs of the structure] values of all outputs in the latest shape of the
                        plant */
    int temperature; /* index of the temperature change among the inputs, or -1 if the plant has
                        none */
    bool has_shape;  /* whether at least one shape of the plant has been computed */
    bool is_at_rest; /* true: the plant has just been set to rest, and no time has passed since */
    long linear_solves; /* number of linear solves of the nonlinear equilibrium solver so far */
    const struct plant_motion *motion; /* way in which the motion of the plant is computed:
                                          quasi-static, modal or nonlinear */
    bool has_inertia;
    char reason[SCENE_ERROR]; /* the reason why a plant has no inertia, as text for the report */
    vibration vibration;      /* natural frequencies and mode shapes, for a plant with inertia */
    modal modal;
    inertia inertia;           /* state of a plant that moves in its vibration modes */
    shell_motion shell_motion; /* state of a plant that moves with all degrees of freedom at large
                                  rotation */
    double *modal_input; /* [amplifiers + loads] inputs of the model of vibration modes: voltages
                            (V) and load factors */
    double *deviation;   /* [outputs of the structure] deviation of the outputs, when the shape was
                            last computed, from their values in static equilibrium under the same
                            voltages and loads. Where the motion is nonlinear, one step of Newton's
                            method gives the deviation */
} plant;

/*
 * Build the simulated structure with the material constants and kinematics of the scene's
 * `simulate` section. All loads have the factor 1 (their values in the scene file), and the
 * temperature change is zero. Returns 0, or -1 with error filled and the plant empty.
 */
int plant_open(plant *plant, const design *nominal, char *error);
void plant_close(plant *plant);

/*
 * Set the factor of one of the plant's loads (1: the load given in the scene file), or the plant's
 * temperature change (K).
 */
void plant_load(plant *plant, int load, double factor);
void plant_warm(plant *plant, double kelvin);

/*
 * Set all load factors of the plant to 1 and its temperature change to zero; its next shape is
 * computed from the undeformed state.
 */
void plant_rest(plant *plant);

/*
 * Apply the impulse of a load to the plant at one instant: the force of the load as given in the
 * scene file times `seconds`.
 */
void plant_kick(plant *plant, int load, double seconds);

/*
 * Advance the motion of the plant by a time under constant voltages and its present loads. The call
 * has no effect on a quasi-static plant.
 *   voltage [amplifiers] in  voltages of the amplifiers (V)
 *   seconds              in  time that passes (s)
 * Returns 0, or -1 with error filled where a nonlinear motion could not be computed.
 */
int plant_elapse(plant *plant, const double *voltage, double seconds, char *error);

/*
 * Return the norm, weighted with the output weights of the target, of the difference between the
 * latest shape of the plant and its static equilibrium; 0 for a plant without inertia.
 */
double plant_vibration(const plant *plant);

/*
 * Return the natural period of the first vibration mode of the plant (s); 0 for a plant without
 * inertia.
 */
double plant_period(const plant *plant);

/*
 * Compute the present shape of the plant: the static equilibrium under the given voltages plus the
 * vibration in modes; with nonlinear motion, the shape to which plant_elapse has moved the plant,
 * whatever the voltages.
 *   voltage [amplifiers] in   present voltages of the amplifiers (V)
 *   shape   [targets]    out  displacements
 * Returns 0, or -1 with error filled.
 */
int plant_shape(plant *plant, const double *voltage, double *shape, char *error);

/*
 * Compute the readings, without noise, of the sensors of the scene's `estimate` section in the
 * latest shape, which plant_shape has computed.
 *   reading [sensors] out  reading of each sensor
 * Returns 0, or -1 with error filled.
 */
int plant_readings(plant *plant, double *reading, char *error);

/* Compute the displacement vector of the latest shape of the simulated structure. */
int plant_displacement(plant *plant, double *displacement, char *error);

/*
 * Compute the optimal voltages on the ceramic for a target on this plant under the present loads
 * and temperature, without the step limit.
 *   target          [targets]    in   wanted displacements
 *   lowest, highest [amplifiers] in   range of the voltage that each amplifier can bring to act on
 *                                     the ceramic (V), after hysteresis, creep and faults
 *   best                         out  optimal voltages; release them with voltages_free
 *   shape           [targets]    out  displacements under the optimal voltages
 * Returns 0, or -1 with error filled.
 */
int plant_optimum(plant *plant, const double *target, const double *lowest, const double *highest,
                  voltages *best, double *shape, char *error);

#endif
