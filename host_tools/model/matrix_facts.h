/* SPDX-License-Identifier: BSD-2-Clause */
/* Numbers that describe a measured influence matrix. */
#ifndef MATRIX_FACTS_H
#define MATRIX_FACTS_H

#include "../scene/scene.h"

typedef struct matrix_facts {
    double entry; /* largest absolute entry, length per volt */
    double most;  /* largest singular value */
    double least; /* smallest singular value that is above MATRIX_RANK of the largest */
    int rank;     /* number of such singular values; -1: not computed, too many actuators */
} matrix_facts;

/*
 * A singular value below this part of the largest counts as 0. They are square roots of the
 * eigenvalues of B'B, whose relative rounding error is its square.
 */
#define MATRIX_RANK 1e-7

/* Largest number of actuators for which singular values are computed. */
enum { MATRIX_ACTUATORS = 256 };

/* Returns 0, or -1 where memory runs out. */
int matrix_facts_find(matrix_facts *facts, const scene *scene);

/* Root of the sum of the squares of column k. */
double matrix_column_size(const scene *scene, int k);

#endif
