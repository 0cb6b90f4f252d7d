/* SPDX-License-Identifier: BSD-2-Clause */
/* Description of a measured influence matrix on standard output: size, rank, singular values. */
#ifndef PRINT_MATRIX_H
#define PRINT_MATRIX_H

#include "../model/analysis.h"

/*
 * Print size, rank and singular values of the measured influence matrix of a scene. Then print
 * which part of the sum of squares of its entries the static responses of the measured vibration
 * modes explain.
 */
void print_matrix(const analysis *analysis);

/*
 * Print how much of a measured influence matrix the static responses of the scene's measured
 * vibration modes explain, as parts of the sum of squares of its entries; nothing where the scene
 * has no measured vibration modes.
 */
void print_matrix_modes(const design *design);

/*
 * Write the size, the rank and the singular values of the influence matrix of a scene as members of
 * a JSON object.
 */
void print_matrix_json(json *json, const analysis *analysis);

#endif
