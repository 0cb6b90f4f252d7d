/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Natural frequencies and mode shapes of a structure in its reference state with short-circuited
 * electrodes: K x = w^2 M x, the lowest ones, by a band Lanczos method on (K + shift M)^-1 M with
 * full reorthogonalisation. The shift is 0 where the supports prevent rigid motions, and positive
 * where they do not. Every result is checked by the number of negative pivots of K - s M just above
 * the last frequency, so that no mode is missing.
 */
#ifndef VIBRATION_H
#define VIBRATION_H

#include "design.h"

typedef struct vibration {
    int count;         /* number of modes */
    int rigid;         /* number of rigid motions, which come first and have frequency 0 */
    int solves;        /* number of linear solves */
    double mass;       /* mass of the whole structure, constrained nodes included */
    double *frequency; /* [count] natural frequency (Hz where the unit of time is the second) */
    double *square;    /* [count] square of the angular frequency (rad^2/s^2) */
    double *shape;     /* [count][free_dof] mode shape x, scaled so that x' M x = 1 */
    double *largest;   /* [count] largest displacement of a node under x */
    double (*effective)[3]; /* [count] effective modal mass for motions along x, y, z */
} vibration;

/*
 * Compute the lowest modes.
 *   number  in  number of modes, reduced to the number of free dof
 *   lumped  in  share of the lumped mass matrix: MASS_LUMPED, or 0 to 1
 * Returns 0, or -1 with error filled and the result empty: a density is missing, the iteration did
 * not converge, or a mode is missing.
 */
int vibration_solve(vibration *vibration, const design *design, int number, double lumped,
                    char *error);
void vibration_free(vibration *vibration);

/* Index of the first mode that is not a rigid motion; vibration->count where there is none. */
int vibration_first(const vibration *vibration);

/*
 * Static response x'f/w^2 of the modal coordinate to a constant unit of an input; NAN for a rigid
 * motion. input in  input of the design's structure Multiplied by the largest displacement of x, it
 * is the static displacement of the input in this mode.
 */
double vibration_static(const vibration *vibration, const design *design, int mode, int input);

#endif
