/* SPDX-License-Identifier: BSD-2-Clause */
/* Description of a measured influence matrix on standard output: size, rank, singular values. */
#ifndef PRINT_MATRIX_H
#define PRINT_MATRIX_H

#include "../model/analysis.h"

/*
 * Print the size, the rank and the singular values of the measured influence matrix of a scene, and
 * the shares of the sum of squares of its entries that the static responses of the measured
 * vibration modes explain.
 */
void print_matrix(const analysis *analysis);

/*
 * Print which shares of the sum of squares of a measured influence matrix's entries the static
 * responses of the scene's measured vibration modes explain; nothing where the scene has no
 * measured vibration modes.
 */
void print_matrix_modes(const design *design);

/*
 * Write the size, the rank and the singular values of the influence matrix of a scene as members of
 * a JSON object.
 */
void print_matrix_json(json *json, const analysis *analysis);

#endif
