/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Vibration of a structure about its static equilibrium: an exact propagator of each mode over time
 * intervals with constant inputs. The state of a mode is the deviation of its modal coordinate from
 * equilibrium, and its velocity over the angular frequency.
 */
#ifndef INERTIA_H
#define INERTIA_H

#include <stdbool.h>
#include "../model/modal_tables.h"

typedef struct inertia {
    const modal *modal;
    double gain; /* ratio of the static responses of the simulated vibration modes to those of the
                    model in `modal` */
    double stretch; /* ratio of the simulated natural frequencies to those of the model in `modal`
                     */
    double *memory; /* one allocated block of memory that holds the arrays `deviation`, `velocity`,
                       `input`, `propagator` and `response`; NULL if the caller provides their
                       memory */
    double *deviation;  /* [modes] deviation of the modal coordinate of each vibration mode from its
                           static equilibrium */
    double *velocity;   /* [modes] velocity of the coordinate of each vibration mode, divided by the
                           angular frequency of the mode */
    double *input;      /* [inputs] present inputs of the structure: voltages (V) and load factors
                           (dimensionless) */
    double *propagator; /* [modes][2][2] propagator of each vibration mode: 2 x 2 matrix that
                           advances its deviation and its scaled velocity by the time `interval` */
    double interval;    /* time interval by which the propagators advance the vibration (s); 0: they
                           are not computed */
    double *response; /* [inputs][modes] coordinate of each simulated vibration mode in equilibrium
                         per unit of each input */
    double response_gain; /* value of `gain` for which `response` is computed; 0: not computed */
} inertia;

/*
 * Number of reals in the memory for the vibration of a structure with given numbers of vibration
 * modes and inputs.
 */
#define INERTIA_REALS(modes, inputs) (6 * (modes) + (inputs) + (modes) * (inputs) + 1)

/*
 * Initialise the vibration of a structure, in the memory of the caller: all inputs are 0, and the
 * structure is at rest in equilibrium.
 *   memory [INERTIA_REALS(modes, inputs)] in  zeros; the memory must outlive `inertia`
 */
void inertia_place(inertia *inertia, const modal *modal, double *memory);

/*
 * Initialise the vibration of a structure, in allocated memory: all inputs are 0, and the structure
 * is at rest in equilibrium. Returns whether memory sufficed; call inertia_close in either case.
 */
bool inertia_open(inertia *inertia, const modal *modal);
void inertia_close(inertia *inertia);

/*
 * Set all vibration modes to rest in the static equilibrium under given inputs.
 *   input [inputs] in  values of the inputs, such as voltages and load factors
 */
void inertia_rest(inertia *inertia, const double *input);

/*
 * Set the inputs to new values at one instant. The modal coordinates do not change, but their
 * static equilibrium moves.
 *   input [inputs] in  values of the inputs, such as voltages and load factors
 */
void inertia_jump(inertia *inertia, const double *input);

/*
 * Apply an impulse to the vibrating structure at one instant: the force that one unit of an input
 * exerts, multiplied by `seconds`.
 */
void inertia_kick(inertia *inertia, size_t input, double seconds);

/* Advance the vibration by the time `interval` (s) under constant inputs. */
void inertia_advance(inertia *inertia, double interval);

/*
 * Compute by how much output values of the structure, such as displacements, deviate from their
 * static values because of vibration.
 *   first      in   index of the first of the outputs that are computed
 *   out [number of outputs] out deviations of these outputs
 */
void inertia_observe(const inertia *inertia, size_t first, size_t rows, double *out);

/*
 * Energy of the vibration: the sum over all vibration modes of w^2 (d^2 + p^2)/2 with angular
 * frequency w, deviation d and scaled velocity p (unit of force times unit of length).
 */
double inertia_energy(const inertia *inertia);

#endif
