/* SPDX-License-Identifier: BSD-2-Clause */
/* Numbers that describe a measured influence matrix: largest entry, singular values, rank. */
#ifndef MATRIX_FACTS_H
#define MATRIX_FACTS_H

#include "../scene/scene.h"

typedef struct matrix_facts {
    double entry; /* largest absolute entry of the influence matrix (length per volt) */
    double most;  /* largest singular value of the influence matrix */
    double least; /* smallest singular value of the influence matrix that counts as nonzero, because
                     it is above a small fixed fraction (MATRIX_RANK) of the largest one */
    int rank; /* number of singular values of the influence matrix above the fraction MATRIX_RANK of
                 the largest one; -1: not computed because there are too many actuators */
} matrix_facts;

/*
 * Fraction of the largest singular value below which a singular value counts as 0. Singular values
 * are computed as square roots of the eigenvalues of B'B, with influence matrix B; the relative
 * rounding error of these eigenvalues is the square of this fraction.
 */
#define MATRIX_RANK 1e-7

/*
 * Largest number of actuators for which the singular values of the influence matrix are computed.
 */
enum { MATRIX_ACTUATORS = 256 };

/*
 * Compute the numbers that describe a measured influence matrix [outputs][amplifiers]. Returns 0,
 * or -1 where memory runs out.
 */
int matrix_facts_find(matrix_facts *facts, const scene_influence *influence, size_t amplifiers);

/* Euclidean norm of column k of the scene's influence matrix. */
double matrix_column_size(const scene *scene, int k);

#endif
