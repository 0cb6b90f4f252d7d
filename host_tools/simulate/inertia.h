/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Vibration of a structure about its static equilibrium, mode by mode.
 *
 * The state of a mode is the deviation d = q - q_eq of its coordinate from the equilibrium under
 * the present inputs, and the scaled velocity p = (dq/dt)/w. While the inputs are constant, (d, p)
 * turns and decays by an exact propagator over any interval. An input that jumps leaves q where it
 * is and moves q_eq, so d jumps by the opposite amount.
 */
#ifndef INERTIA_H
#define INERTIA_H

#include "../model/modal.h"

typedef struct inertia {
    const modal *modal;
    double gain;        /* factor of the static response to the inputs, 1: that of `modal` */
    double stretch;     /* factor of all frequencies, 1: those of `modal` */
    double *memory;     /* memory of the arrays below */
    double *deviation;  /* [modes] d, unit of the modal coordinate */
    double *velocity;   /* [modes] p, unit of the modal coordinate */
    double *input;      /* [inputs] present inputs */
    double *propagator; /* [modes][2][2] over `interval`, row d then row p */
    double interval;    /* interval of the propagator (s); 0: none */
} inertia;

/* Start at rest under zero inputs. Returns whether memory sufficed; close in either case. */
bool inertia_open(inertia *inertia, const modal *modal);
void inertia_close(inertia *inertia);

/* Come to rest in the equilibrium under given inputs. input [inputs] in */
void inertia_rest(inertia *inertia, const double *input);

/* Let the inputs jump. input [inputs] in */
void inertia_jump(inertia *inertia, const double *input);

/*
 * Apply the impulse of one input: its unit force during `seconds`, in a time too short for any
 * displacement.
 */
void inertia_kick(inertia *inertia, size_t input, double seconds);

/* Let time pass under constant inputs. */
void inertia_advance(inertia *inertia, double interval);

/* Deviation C d of output rows from the static displacement. out [rows] out, from row `first` */
void inertia_observe(const inertia *inertia, size_t first, size_t rows, double *out);

/* Energy of the vibration, sum of w^2 (d^2 + p^2)/2 (J, unit of force times unit of length). */
double inertia_energy(const inertia *inertia);

#endif
