/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Reduction of many pokes (shapes measured under known voltages) by an orthogonal matrix Q:
 *   Q' V = [R; 0],  Q' S = [X; Y].
 * R and X contain all information of the pokes on the influence matrix, so that the work of its
 * computation no longer depends on the number of pokes. Y is the part of the shapes that no
 * influence matrix explains: noise, drift and effects of earlier voltages.
 *   V [pokes][actuators]     voltages, R [actuators][actuators] upper triangular
 *   S [pokes][outputs]       measured shapes, X [actuators][outputs], Y [left][outputs]
 *   left                     number of pokes less number of actuators, or 0
 */
#ifndef POKE_REDUCTION_H
#define POKE_REDUCTION_H

#include "pokes.h"

typedef struct poke_reduction {
    pokes pokes; /* reduced pokes (shapes measured under known voltages): voltages R and shapes X;
                    the pokes themselves where there are no more of them than actuators */
    size_t left; /* number of rows of `rest` and `extra`: number of pokes minus number of actuators,
                    or 0 */
    const double *rest;  /* [left][outputs] matrix Y: rows of the transformed shapes that no
                            influence matrix explains */
    const double *extra; /* [left][extras] rows of the transformed regressors (further columns of
                            poke_reduce) that the voltages do not explain */
    double *memory;      /* one allocation that holds the arrays of the reduction */
} poke_reduction;

/*
 * Reduce pokes by Householder reflections.
 *   regressor [pokes][extras] in  further numbers of each poke, to which Q' is applied as to the
 *                                 shapes; NULL where extras is 0
 * Returns 0, or -1 where memory runs out. Call poke_reduction_free in either case.
 */
int poke_reduce(poke_reduction *reduction, const pokes *pokes, const double *regressor,
                size_t extras);
void poke_reduction_free(poke_reduction *reduction);

#endif
