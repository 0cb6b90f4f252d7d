/* SPDX-License-Identifier: BSD-2-Clause */
/* Numbers that describe a measured influence matrix (matrix_facts.h). */
#include "matrix_facts.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "eigen.h"

double matrix_column_size(const scene *scene, int k)
{
    double sum = 0;
    for (int i = 0; i < scene->influence.outputs; i++)
        sum += pow(scene->influence.matrix[(size_t)i * (size_t)scene->amplifiers + (size_t)k], 2);
    return sqrt(sum);
}

/* gram [n][n] out: B'B */
static void multiply(const scene *scene, double *gram)
{
    const size_t n = (size_t)scene->amplifiers;
    for (size_t i = 0; i < (size_t)scene->influence.outputs; i++) {
        const double *row = scene->influence.matrix + i * n;
        for (size_t j = 0; j < n; j++)
            for (size_t k = 0; k < n; k++)
                gram[j * n + k] += row[j] * row[k];
    }
}

int matrix_facts_find(matrix_facts *facts, const scene *scene)
{
    const size_t n = (size_t)scene->amplifiers;
    memset(facts, 0, sizeof *facts);
    for (size_t i = 0; i < (size_t)scene->influence.outputs * n; i++)
        facts->entry = fmax(facts->entry, fabs(scene->influence.matrix[i]));
    facts->rank = -1;
    if (n > MATRIX_ACTUATORS)
        return 0;
    double *gram = calloc(2 * n * n, sizeof *gram);
    if (!gram)
        return -1;
    multiply(scene, gram);
    eigen_symmetric(gram, gram + n * n, n, 30, 0);
    for (size_t k = 0; k < n; k++)
        facts->most = fmax(facts->most, sqrt(fmax(gram[k * n + k], 0)));
    facts->rank = 0;
    facts->least = facts->most;
    for (size_t k = 0; k < n; k++) {
        const double value = sqrt(fmax(gram[k * n + k], 0));
        if (value <= MATRIX_RANK * facts->most)
            continue;
        facts->rank++;
        facts->least = fmin(facts->least, value);
    }
    free(gram);
    return 0;
}
