/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Reduction of many pokes (shapes measured under known voltages) by an orthogonal matrix Q:
 *   Q' V = [R; 0],  Q' S = [X; Y].
 * R and X hold all that the pokes tell of the influence matrix, so that later work no longer
 * depends on the number of pokes. Y holds what no influence matrix explains: noise, drift and
 * effects of earlier voltages.
 *   V [pokes][actuators]     voltages, R [actuators][actuators] upper triangular
 *   S [pokes][outputs]       measured shapes, X [actuators][outputs], Y [left][outputs]
 *   left                     number of pokes less number of actuators, or 0
 */
#ifndef POKE_REDUCTION_H
#define POKE_REDUCTION_H

#include "pokes.h"

typedef struct poke_reduction {
    pokes pokes; /* rows R and X of the reduced pokes; with at most as many pokes as actuators the
                    pokes themselves */
    size_t left; /* rows of Y and of the reduced regressors */
    const double *rest;  /* [left][outputs] Y, the part of the shapes that no matrix explains */
    const double *extra; /* [left][extras] the same part of the regressors */
    double *memory;      /* arrays of the reduction, to be freed */
} poke_reduction;

/*
 * Reduce pokes by Householder reflections.
 *   regressor [pokes][extras] in  further columns, reduced like the shapes; NULL where extras is 0
 * Returns 0, or -1 where memory runs out. Call poke_reduction_free in either case.
 */
int poke_reduce(poke_reduction *reduction, const pokes *pokes, const double *regressor,
                size_t extras);
void poke_reduction_free(poke_reduction *reduction);

#endif
