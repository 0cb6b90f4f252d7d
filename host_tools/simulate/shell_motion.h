/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Motion of a shell with mass at large rotation: time steps of an energy-momentum method for all
 * free dof of the mesh, solved by Newton's method.
 *
 * A step of length h leads from displacement u0 and velocity v0 to u1 and v1:
 *   M (v1 - v0)/h + L(m)' S + damping = F(m),     (u1 - u0)/h = (v0 + v1)/2
 *   m  displacement at half the step, (u0 + u1)/2
 *   M  mass matrix
 *   L  strain-displacement matrix at m
 *   S  mean of the stress resultants at u0 and u1
 *   F  loads at m
 *
 * Properties:
 *   - Without damping and loads a step keeps the energy, and on a free structure both momenta, for
 *       any h. Reason: strains are quadratic in u, so that L(m) (u1 - u0) is exactly their change.
 *   - The energy error of Newton's last force imbalance is removed (balance_energy).
 *   - The error is of second order: periods are too long by about (w h)^2/12, angular frequency w.
 *   - The linear solves use stress resultants extrapolated along the last increment.
 *
 * Damping has three parts, none of which can add energy:
 *   - mass-proportional force a M (u1 - u0)/h, with the coefficient a of the scene (1/s)
 *   - viscosity b (s), which gives the damping ratio b w/2. It adds b/2 times the rate of the
 *       stress resultants to them, and b/2 (v1 - v0)/h to the mean velocity: the first term alone
 *       hardly damps motions much faster than a step.
 *   - damping of each mode that the steps resolve, up to the damping ratio in the scene file
 * If the scene file states damping ratios, a is zero and b is the largest viscosity that gives no
 * resolved mode more than its ratio.
 */
#ifndef SHELL_MOTION_H
#define SHELL_MOTION_H

#include "../model/equilibrium.h"
#include "../model/mass.h"
#include "../model/vibration.h"

/* Number of times that a time step may be halved if Newton's method does not converge. */
enum { SHELL_MOTION_HALVINGS = 6 };

typedef struct shell_motion {
    const vibration *vibration; /* vibration modes of the shell that are damped; NULL: the motion is
                                   not damped */
    mass mass;
    pzs_solver solver; /* solver of the nonlinear equilibrium, whose functions this motion uses with
                          its own arrays: in `displacement` the displacement at half the time step;
                          in `resultant` the stress resultants for the geometric stiffness,
                          extrapolated along the last Newton increment */
    double step_most;  /* longest time step of the motion of the shell (s) */
    double mass_damping, viscosity; /* mass_damping: coefficient a of the damping force a M v, with
                                       mass matrix M and velocity v (1/s). viscosity: coefficient b
                                       of a damping that grows with frequency: damping ratio b w/2
                                       for a mode of angular frequency w (s) */
    size_t modes; /* number of vibration modes that the time steps resolve, each of which is damped
                     individually */
    double *mode_damping; /* [modes] twice the damping ratio times the angular frequency of each
                             individually damped mode, minus the part that viscosity contributes
                             (1/s) */
    double *mode_force;   /* [modes][free_dof] product of the mass matrix and the shape of each
                             individually damped mode */
    double *memory;       /* one allocation that holds all vectors of length free_dof */
    double *displacement; /* [free_dof] present displacement of the shell: translations (m) and
                             dimensionless dof */
    double *velocity;     /* [free_dof] present velocity of the shell (m/s and 1/s) */
    double *acceleration; /* [free_dof] mean acceleration of the shell in the last time step (m/s2
                             and 1/s2) */
    double *half_change;  /* [free_dof] displacement at half the time step minus the displacement at
                             its start: translations (m) and dimensionless dof */
    double *increment;    /* [free_dof] last increment of the displacement by Newton's method:
                             translations (m) and dimensionless dof */
    double *last_increment; /* [free_dof] copy of the last increment of the displacement by Newton's
                               method: translations (m) and dimensionless dof. A small multiple of
                               it is added to the displacement, so that the remaining force
                               imbalance does not change the energy. */
    double *end; /* [free_dof] displacement of the shell at the end of the time step: translations
                    (m) and dimensionless dof */
    double *scratch; /* [free_dof] work array, for example for nodal forces of the loads */
    double (*start_resultant)[22]; /* [elements] stress resultants of each element, times its area,
                                      at the start of the time step (N m) */
    double work; /* scalar product of the force imbalance before the last Newton increment and the
                    change of the displacement in half the time step (N m); a measure of the error
                    of the energy */
    long corrections; /* number of time steps so far in which a correction by a multiple of the last
                         Newton increment removed the error of the energy, so that no further linear
                         solve was needed */
    long steps;       /* number of time steps of the motion of the shell so far */
    long linear_solves;  /* number of linear solves in all time steps of the motion so far */
    long factorisations; /* number of factorisations of the matrix of a time step so far */
    int solves_most;     /* largest number of linear solves that any time step has needed */
} shell_motion;

/*
 * Prepare the motion of a structure, which starts undeformed and at rest.
 *   equilibrium in   nonlinear equilibrium of the structure; must outlive the motion. Motion and
 *                    equilibrium factor their matrices in the same memory: after one of them has
 *                    been used, the other must factor its matrix again
 *   vibration   in   vibration modes to damp; NULL: the motion is not damped
 *   step_most   in   longest time step (s)
 * Returns 0, or -1 with error filled; call shell_motion_close in either case.
 */
int shell_motion_open(shell_motion *motion, const equilibrium *equilibrium,
                      const vibration *vibration, double step_most, char *error);
void shell_motion_close(shell_motion *motion);

/*
 * Return the longest time step (s) that divides the tick interval into equal parts and advances the
 * phase of each controllable mode by at most 0.5 rad (period error up to 2 %). Controllable are the
 * first mode and those whose phase advances by at most 2 rad in a tick.
 *   interval in  time between two ticks (s)
 */
double shell_motion_step(const vibration *vibration, double interval);

/* Set the motion of the shell to a state of rest: a given displacement, with zero velocity. */
void shell_motion_rest(shell_motion *motion, const double *displacement, const double *value);

/*
 * Change the velocity of the shell at one instant by the impulse of one input: the force of one
 * unit of the input at the present displacement, multiplied by `seconds`.
 */
void shell_motion_kick(shell_motion *motion, uint32_t input, double seconds);

/*
 * Advance the motion of the shell by a time (s) under constant input values.
 *   value [inputs] in  input values of the structure: voltages (V), load factors, temperature
 * Returns whether Newton's method has converged in every step. The motion stays at the last
 * converged step otherwise.
 */
bool shell_motion_advance(shell_motion *motion, const double *value, double seconds);

/*
 * Return the deviation of the shell from its static equilibrium under given input values,
 * [free_dof], by one step of Newton's method: exact for small deviations, zero where the tangent
 * stiffness is singular. It is valid until the next call of a function of the motion.
 */
const double *shell_motion_deviation(shell_motion *motion, const double *value);

/*
 * Return the kinetic energy of the shell (shell_motion_kinetic), and the strain energy of its
 * elements and springs (shell_motion_strain_energy) (N m).
 */
double shell_motion_kinetic(shell_motion *motion);
double shell_motion_strain_energy(shell_motion *motion);

/*
 * Return the potential energy (N m) of the loads of constant direction and of the prescribed stress
 * resultants, at the present displacement of the shell and under given input values.
 */
double shell_motion_potential(shell_motion *motion, const double *value);

#endif
