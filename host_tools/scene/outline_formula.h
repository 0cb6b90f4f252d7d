/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Electrodes that lie where a formula is positive. In each element the formula is taken to be
 * linear on the two triangles of each square of a grid.
 */
#ifndef OUTLINE_FORMULA_H
#define OUTLINE_FORMULA_H

#include "outline_cell.h"

/* Squares along a side of the grid, and values at its lines. */
enum { FORMULA_GRID = 16 };
typedef double formula_grid[FORMULA_GRID + 1][FORMULA_GRID + 1];

/* Values of a formula on the grid of an element. Returns 0, or -1 with error filled. */
int formula_sample(const scene *scene, const outline_cell *cell, const scene_outline *outline,
                   formula_grid value, char *error);

/* Part of an element in which a formula is positive. */
double formula_share(const outline_cell *cell, formula_grid value);

/* Draw the pieces in which a formula is positive, or the lines on which it is 0. */
void formula_pieces(formula_grid value, int element, bool draws_outline, outline_draw *draw,
                    void *context);

#endif
