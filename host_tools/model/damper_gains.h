/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Gains of the control tick that damps vibration (pzs_vibration), from a modal model: propagators,
 * observer, damping gradient.
 *
 * The observer is a stationary Kalman filter. Its states are, for each mode, the position q, the
 * velocity p over the angular frequency, and the static position w under the loads. Over one tick,
 * p and the deviation d = q - g v - w from the equilibrium follow the propagator of free vibration;
 * g is the coordinate in equilibrium per volt, and v holds the voltages. There is process noise of
 * p and w, and sensor noise of variance 1. The covariance P solves the Riccati equation P = A P A'
 * - A P C' (C P C' + 1)^-1 C P A' + Q by structured doubling, with transition matrix A, readings C
 * per unit of each state and process noise Q.
 *
 * All settings are free of units: they refer to the sensors' noise and to the phase angle of a mode
 * in a tick, its angular frequency times the tick interval.
 */
#ifndef DAMPER_GAINS_H
#define DAMPER_GAINS_H

#include <stdbool.h>
#include <stddef.h>

/*
 * Settings of the control tick that damps vibration. The angle of a vibration mode is its angular
 * frequency times the tick interval.
 */
typedef struct damper_settings {
    double damping; /* damping per radian: in a tick, the voltages move the static equilibrium of a
                       vibration mode by this number x phase angle of the mode in a tick (rad) x
                       deviation of the mode from its equilibrium */
    double cut; /* phase angle of a vibration mode in a tick (rad) up to which the mode is damped in
                   full; modes with more than twice this angle are not damped */
    double observed; /* largest phase angle of an observed vibration mode in a tick (rad) */
    double follow;   /* how far the voltages move in one control tick, as a fraction of the distance
                        to the statically optimal voltages: `follow` times the phase angle of the
                        first vibration mode in a tick (rad) */
    double follow_limit; /* upper limit of the fraction of the distance to the statically optimal
                            voltages that the voltages cover in one control tick */
    double mix;  /* A vibration mode's deviation from its static equilibrium is computed twice: from
                    its position, with the weight 1 - mix, and from the change of its velocity, with
                    the weight mix (0 to 1). */
    double kick; /* process noise of the observer: root mean square random change of the first
                    vibration mode's velocity in a tick, relative to the noise of one sensor */
    double drift; /* process noise of the observer: root mean square random change of the load on
                     the first vibration mode in a tick, relative to the noise of one sensor */
    double slow;  /* gain, 0 to 1, of the low-pass filter for the residual readings: readings minus
                     those of the observed vibration modes */
    int later; /* number of ticks by which the readings are assumed to be older than the scene file
                  states; the observer tolerates newer readings better than older ones */
    bool is_gradient; /* true: damp along the gradient of the vibration energy, which decreases even
                         where voltages are at their limits; false: damp along the gradient of the
                         squared error of the shape */
} damper_settings;

/*
 * Return the default settings of the stage of the control tick that damps vibration. With them the
 * shape settles after fast jumps of the target on every structure of
 * tests/unit/test_vibration_block.c.
 */
damper_settings damper_default_settings(void);

/*
 * Modal model of structure and sensors. Modal coordinates are scaled so that a unit moves the
 * outputs by a root mean square of 1.
 */
typedef struct damper_model {
    size_t modes, inputs, sensors;
    const double *angle;   /* [modes] phase angle of each vibration mode in a tick, ascending (rad):
                              angular frequency times tick interval */
    const double *ratio;   /* [modes] damping ratio of each vibration mode */
    const double *modal;   /* [modes][inputs] coordinate of each vibration mode in equilibrium per
                              volt of each input */
    const double *overlap; /* [modes][modes] products of the readings of every pair of vibration
                              modes, summed over the sensors with their inverse variances */
    const double *lift;   /* [inputs][modes] scalar products of each input's column of the influence
                             matrix with each mode shape over the outputs, weighted with the target
                             weights */
    const double *square; /* [modes] squared norm of each mode shape at the outputs, weighted with
                             the target weights */
} damper_model;

/*
 * Gains of the control tick that damps vibration, in the layout of pzs_vibration. The caller owns
 * all arrays.
 */
typedef struct damper_gains {
    double *turn; /* [4][modes] propagator of each vibration mode, a 2 x 2 matrix that advances its
                     free vibration by one tick */
    double *observer; /* [3][modes][modes] gains of the observer for position, velocity and static
                         position (first index) of the vibration modes: matrices that multiply the
                         errors of the fitted modal coordinates */
    double *explain; /* [modes][modes] inverse of the regularised normal matrix of the least-squares
                        fit of modal coordinates to sensor readings */
    double *damping; /* [modes][inputs] damping gradient (term that the control tick subtracts from
                        the gradient of its objective to damp vibration) per unit of each vibration
                        mode's deviation from its equilibrium */
    double *inverse_angle; /* [modes] reciprocal of the phase angle of each vibration mode in a tick
                              (1/rad) */
    double *covariance;    /* [3 modes][3 modes] covariance of the error of the observer, which
                              estimates the vibration modes, or NULL */
    double share, mix, slow;
} damper_gains;

/*
 * Compute the gains of the control tick that damps vibration. Returns 0, or -1 where memory runs
 * out or the iteration for the Riccati equation of the vibration observer does not converge, for
 * example because a number is not finite.
 */
int damper_compute(damper_gains *gains, const damper_model *model, const damper_settings *settings);

#endif
