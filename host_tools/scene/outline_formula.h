/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Electrodes that cover all points at which a formula is positive. Each element is divided into a
 * grid of squares, and the formula is taken to be linear on each of the two triangles of a square.
 */
#ifndef OUTLINE_FORMULA_H
#define OUTLINE_FORMULA_H

#include "outline_cell.h"

/*
 * Grid that divides an element into FORMULA_GRID x FORMULA_GRID squares. A formula_grid holds the
 * values of an electrode's formula at the corners of these squares.
 */
enum { FORMULA_GRID = 16 };
typedef double formula_grid[FORMULA_GRID + 1][FORMULA_GRID + 1];

/*
 * Compute the values of an electrode's formula on the grid of squares of an element. Returns 0, or
 * -1 with error filled where a value is not finite.
 */
int formula_sample(const scene *scene, const outline_cell *cell, const scene_outline *outline,
                   formula_grid value, char *error);

/*
 * Return the fraction of the area of an element, from 0 to 1, in which the formula of an electrode
 * is positive.
 */
double formula_share(const outline_cell *cell, formula_grid value);

/*
 * Draw the areas of an element in which the formula of an electrode is positive, or, if
 * draws_outline is true, the lines on which the formula is 0.
 */
void formula_pieces(formula_grid value, int element, bool draws_outline, outline_draw *draw,
                    void *context);

#endif
