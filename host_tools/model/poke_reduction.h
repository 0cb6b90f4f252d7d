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
    pokes pokes; /* reduced pokes (shapes measured under known voltages): voltages R and shapes X,
                    as many as actuators. If there were no more pokes than actuators, they are not
                    reduced */
    size_t left; /* number of rows of `rest` and `extra`: number of pokes (measured shapes) minus
                    number of actuators, or 0 */
    const double *rest; /* [left][outputs] rows of the measured shapes, multiplied by the orthogonal
                           matrix Q' that makes the voltages of these rows 0: no influence matrix
                           can explain what is in them */
    const double *extra; /* [left][extras] further numbers of each poke, a measured shape (argument
                            `regressor` of poke_reduce), multiplied by the orthogonal matrix Q';
                            only the rows in which Q' makes the voltages 0 */
    double *memory;      /* one allocation that holds the arrays of the reduction */
} poke_reduction;

/*
 * Combine the pokes (shapes measured under known voltages) to at most as many as there are
 * actuators, by Householder reflections: their product is the orthogonal matrix Q', which makes all
 * further rows of the voltages 0.
 *   regressor [pokes][extras] in  further numbers of each poke, to which Q' is applied as to the
 *                                 shapes; NULL where extras is 0
 * Returns 0, or -1 where memory runs out. Call poke_reduction_free in either case.
 */
int poke_reduce(poke_reduction *reduction, const pokes *pokes, const double *regressor,
                size_t extras);
void poke_reduction_free(poke_reduction *reduction);

#endif
