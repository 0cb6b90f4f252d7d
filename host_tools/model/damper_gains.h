/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Gains of the control tick that damps vibration (pzs_vibration), from a modal model: propagators
 * of free vibration, observer, and damping term in the gradient of the tick's objective. The
 * observer is a stationary Kalman filter with the covariance P:
 *   P = A P A' - A P C' (C P C' + 1)^-1 C P A' + Q.
 *   states  of each mode: position q, velocity p over angular frequency, static position w under
 *       loads
 *   A       transition matrix: free vibration of p and of the deviation q - g v - w, with the
 *       voltages v and the static coordinate g per volt
 *   C       readings per unit of each state, divided by the noise of their sensors
 *   Q       process noise of p and w
 * All settings are dimensionless: relative to the noise of the sensors, or to the phase angle of a
 * mode in a tick (angular frequency times tick interval, rad).
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
    double damping; /* strength of the damping (dimensionless). In each tick, the voltages move the
                       static equilibrium of a vibration mode by c times the mode's present
                       deviation from its equilibrium. The factor c is `damping` times the phase
                       angle of the mode in a tick (angular frequency times tick interval, rad) */
    double cut; /* phase angle in a tick (angular frequency times tick interval, rad) up to which a
                   vibration mode is damped in full; modes with more than twice this angle are not
                   damped */
    double observed;     /* upper limit of the phase angle in a tick (angular frequency times tick
                            interval, rad) of the vibration modes that the observer estimates */
    double follow;       /* speed at which the voltages approach the statically optimal voltages
                            (dimensionless). In one control tick they cover the fraction f of the
                            distance: f = `follow` times angular frequency of the first vibration
                            mode times tick interval, and at most follow_limit */
    double follow_limit; /* upper limit of the fraction of the distance to the statically optimal
                            voltages that the voltages cover in one control tick */
    double mix;  /* A vibration mode's deviation from its static equilibrium is computed twice: from
                    its position, with the weight 1 - mix, and from the change of its velocity, with
                    the weight mix (0 to 1). */
    double kick; /* root mean square of the random change of the first mode's velocity in one tick
                    that the observer assumes (process noise). The velocity is divided by the
                    angular frequency. The unit is the standard error of the modal coordinate in a
                    fit to the readings of one tick */
    double drift; /* root mean square of the random change of the loads in one tick that the
                     observer assumes (process noise). A load is measured by the static displacement
                     of the first mode that it causes. The unit is the standard error of the modal
                     coordinate in a fit to the readings of one tick */
    double slow;  /* gain, 0 to 1, of the low-pass filter for the residual readings: readings minus
                     those of the observed vibration modes */
    double fading_periods; /* time in which the vibration that the supervisor tolerates after a jump
                              of the target falls by the factor e (periods of the first observed
                              mode) */
    int later; /* number of ticks by which the readings are assumed to be older than the scene file
                  states; the observer tolerates newer readings better than older ones */
    bool is_gradient; /* quantity whose gradient with respect to the voltages damps vibration. true:
                         vibration energy, which decreases even where voltages are at their limits;
                         false: squared error of the shape */
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
    const double *overlap; /* [modes][modes] entry (i, k): product of the readings of modes i and k,
                              summed over the sensors with their inverse noise variances. The
                              reading of a mode is what a sensor shows per unit of its modal
                              coordinate. */
    const double *lift;   /* [inputs][modes] scalar products of each input's column of the influence
                             matrix with each mode shape over the outputs, weighted with the target
                             weights */
    const double *square; /* [modes] squared norm of each mode shape at the outputs, weighted with
                             the target weights */
    double lag; /* tick interval over the time constant of the amplifiers' first-order lag; 0: no
                   lag */
} damper_model;

/*
 * Gains of the control tick that damps vibration, in the layout of pzs_vibration. The caller owns
 * all arrays.
 */
typedef struct damper_gains {
    double *turn; /* [4][modes] propagator of each vibration mode, a 2 x 2 matrix that advances its
                     free vibration by one tick */
    double *observer; /* [3][modes][modes] gains of the observer for three states (first index) of
                         each vibration mode: position, velocity, and the position at which it would
                         rest under the unknown loads. These matrices multiply the vector C' W r. r
                         holds the errors of the predicted readings, W the inverse noise variances,
                         and C the readings per unit of each mode. */
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
    double *lag; /* [2 + 2 modes] lag of the amplifiers, and weights that advance the phase of the
                    damping by that of the lag (pzs_vibration.lag); filled where model->lag is not 0
                  */
} damper_gains;

/*
 * Compute the gains of the control tick that damps vibration. Returns 0, or -1 where memory runs
 * out or the iteration for the Riccati equation of the vibration observer does not converge, for
 * example because a number is not finite.
 */
int damper_compute(damper_gains *gains, const damper_model *model, const damper_settings *settings);

#endif
