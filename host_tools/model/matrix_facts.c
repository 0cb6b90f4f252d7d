/* SPDX-License-Identifier: BSD-2-Clause */
/* Largest entry, singular values and rank of a measured influence matrix (matrix_facts.h). */
#include "matrix_facts.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/modes/eigen.h"

double matrix_column_size(const scene *scene, int k)
{
    double sum = 0;
    for (int i = 0; i < scene->influence.outputs; i++)
        sum += pow(scene->influence.matrix[(size_t)i * (size_t)scene->amplifiers + (size_t)k], 2);
    return sqrt(sum);
}

/*
 * Product of the transposed influence matrix with the influence matrix.
 *   gram [amplifiers][amplifiers] out  product
 */
static void multiply(const scene_influence *influence, size_t amplifiers, double *gram)
{
    for (size_t i = 0; i < (size_t)influence->outputs; i++) {
        const double *row = influence->matrix + i * amplifiers;
        for (size_t j = 0; j < amplifiers; j++)
            for (size_t k = 0; k < amplifiers; k++)
                gram[j * amplifiers + k] += row[j] * row[k];
    }
}

int matrix_facts_find(matrix_facts *facts, const scene_influence *influence, size_t amplifiers)
{
    memset(facts, 0, sizeof *facts);
    for (size_t i = 0; i < (size_t)influence->outputs * amplifiers; i++)
        facts->entry = fmax(facts->entry, fabs(influence->matrix[i]));
    facts->rank = -1;
    if (amplifiers > MATRIX_ACTUATORS)
        return 0;
    double *gram = calloc(2 * amplifiers * amplifiers, sizeof *gram);
    if (!gram)
        return -1;
    multiply(influence, amplifiers, gram);
    pzs_eigen_symmetric(gram, gram + amplifiers * amplifiers, amplifiers, 30, 0);
    for (size_t k = 0; k < amplifiers; k++)
        facts->most = fmax(facts->most, sqrt(fmax(gram[k * amplifiers + k], 0)));
    facts->rank = 0;
    facts->least = facts->most;
    for (size_t k = 0; k < amplifiers; k++) {
        const double value = sqrt(fmax(gram[k * amplifiers + k], 0));
        if (value <= MATRIX_RANK * facts->most)
            continue;
        facts->rank++;
        facts->least = fmin(facts->least, value);
    }
    free(gram);
    return 0;
}
