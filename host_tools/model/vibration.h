/*
 * Natural frequencies and mode shapes of a structure in its reference state, electrodes
 * short-circuited:
 *   K x = w^2 M x,
 * the lowest, by a band Lanczos method on (K + shift M)^-1 M with full reorthogonalisation. The
 * shift is 0 where the supports hold the structure; a structure that they leave loose is shifted.
 * Every result is checked by the number of negative pivots of K - s M just above the last
 * frequency: no mode is missed.
 */
#ifndef VIBRATION_H
#define VIBRATION_H

#include "design.h"

typedef struct vibration {
    int count;              /* modes */
    int rigid;              /* the first of them: rigid motions, of frequency 0 */
    int solves;             /* linear solves */
    double mass;            /* of the whole structure, supports included */
    double *frequency;      /* [count] (Hz where the unit of time is the second) */
    double *square;         /* [count] w^2 (rad^2/s^2) */
    double *shape;          /* [count][dof] x, x' M x = 1 */
    double *largest;        /* [count] largest displacement of a node under x */
    double (*effective)[3]; /* [count] mass that takes part in a motion along x, y, z */
} vibration;

/*
 * The lowest modes.
 *   number in  modes wanted, cut to the number of free dof
 *   lumped in  share of the lumped mass matrix: MASS_LUMPED, or 0 to 1
 * Returns 0, or -1 with error filled and *v empty: a density is missing, no convergence, a mode was
 * missed.
 */
int vibration_solve(vibration *vibration, const design *design, int number, double lumped,
                    char *error);
void vibration_free(vibration *vibration);

/* Index of the first mode that is no rigid motion; v->count where there is none. */
int vibration_first(const vibration *vibration);

/*
 * Modal coordinate x'f/w^2 that a unit of an input, held for good, makes; NAN in a rigid motion.
 *   input in  of the design's structure
 * Multiplied by the largest displacement of x it is what that input moves by this mode.
 */
double vibration_static(const vibration *vibration, const design *design, int mode, int input);

#endif
