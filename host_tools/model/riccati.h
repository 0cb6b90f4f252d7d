/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Discrete algebraic Riccati equation by structured doubling, without eigenvalues:
 *   X = A' X (1 + G X)^-1 A + H.
 * With A = transition matrix, G = B R^-1 B' and H = cost of the state, X is the cost to go of the
 * linear quadratic regulator; with A = transposed transition matrix, G = C' R^-1 C and H = process
 * noise, X is the covariance of the Kalman filter's prediction.
 */
#ifndef RICCATI_H
#define RICCATI_H

#include <stddef.h>

/* Matrices [order][order] of a Riccati equation; riccati_solve replaces all of them. */
typedef struct riccati {
    size_t order;
    double *a, *g, *h; /* A, G and H of the equation, zero at first; riccati_solve replaces h by the
                          solution X */
    double *w, *work, *aw, *other; /* work matrices of one iteration of the structured doubling
                                      algorithm. w: inverse of (unit matrix + g h), with the present
                                      iterates g and h; aw: product of the present iterate a and w
                                    */
    double *memory;
} riccati;

/* Allocate the matrices. Returns 0, or -1 where memory runs out; call riccati_close in either case.
 */
int riccati_open(riccati *riccati, size_t order);
void riccati_close(riccati *riccati);

/*
 * Solve the equation: h becomes X. Returns 0, or -1 where the iteration does not converge, for
 * example because a number is not finite.
 */
int riccati_solve(riccati *riccati);

#endif
