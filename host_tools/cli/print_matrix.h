/* SPDX-License-Identifier: BSD-2-Clause */
/* Description of a measured influence matrix on standard output: size, rank, singular values. */
#ifndef PRINT_MATRIX_H
#define PRINT_MATRIX_H

#include "../model/analysis.h"

/* Print the size, the rank and the singular values of the influence matrix of a scene. */
void print_matrix(const analysis *analysis);

/*
 * Write the size, the rank and the singular values of the influence matrix of a scene as members of
 * a JSON object.
 */
void print_matrix_json(json *json, const analysis *analysis);

#endif
