/* SPDX-License-Identifier: BSD-2-Clause */
/* Reduction of many measured shapes to as many as there are actuators, by Householder reflections
 * (poke_reduction.h). */
#include "poke_reduction.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/*
 * Apply the reflection I - 2 w w'/(w'w) to the columns of a matrix from row `first` on.
 *   w     [rows]          in      vector of the reflection; rows before `first` are not used
 *   value [rows][columns] in/out  matrix
 *   sum   [columns]       out     work array
 */
static void reflect(const double *w, double square, size_t first, size_t rows, double *value,
                    size_t columns, double *sum)
{
    memset(sum, 0, columns * sizeof *sum);
    for (size_t row = first; row < rows; row++)
        for (size_t k = 0; k < columns; k++)
            sum[k] += w[row] * value[row * columns + k];
    for (size_t row = first; row < rows; row++) {
        const double factor = 2 * w[row] / square;
        for (size_t k = 0; k < columns; k++)
            value[row * columns + k] -= factor * sum[k];
    }
}

/*
 * Compute the vector w of the Householder reflection that clears column `pivot` of the matrix of
 * voltages below its diagonal. Returns w'w, or 0 where the column is already zero from the diagonal
 * down.
 */
static double reflection(const double *voltage, size_t actuators, size_t pivot, size_t rows,
                         double *w)
{
    double square = 0;
    for (size_t row = pivot; row < rows; row++) {
        w[row] = voltage[row * actuators + pivot];
        square += w[row] * w[row];
    }
    const double norm = sqrt(square), own = w[pivot];
    w[pivot] += own < 0 ? -norm : norm;
    return 2 * (square + fabs(own) * norm);
}

int poke_reduce(poke_reduction *reduction, const pokes *pokes, const double *regressor,
                size_t extras)
{
    const size_t count = pokes->count, actuators = pokes->actuators, outputs = pokes->outputs;
    const size_t widest = actuators + outputs + extras;
    *reduction = (poke_reduction){.pokes = *pokes};
    if (count <= actuators)
        return 0;
    reduction->memory = calloc(count * (widest + 1) + widest, sizeof *reduction->memory);
    if (!reduction->memory)
        return -1;
    double *voltage = reduction->memory, *shape = voltage + count * actuators,
           *extra = shape + count * outputs, *w = extra + count * extras, *sum = w + count;
    memcpy(voltage, pokes->voltage, count * actuators * sizeof *voltage);
    memcpy(shape, pokes->shape, count * outputs * sizeof *shape);
    if (extras > 0)
        memcpy(extra, regressor, count * extras * sizeof *extra);
    for (size_t pivot = 0; pivot < actuators; pivot++) {
        const double square = reflection(voltage, actuators, pivot, count, w);
        if (!(square > 0))
            continue;
        reflect(w, square, pivot, count, voltage, actuators, sum);
        reflect(w, square, pivot, count, shape, outputs, sum);
        reflect(w, square, pivot, count, extra, extras, sum);
    }
    reduction->pokes.count = actuators;
    reduction->pokes.voltage = voltage;
    reduction->pokes.shape = shape;
    reduction->left = count - actuators;
    reduction->rest = shape + actuators * outputs;
    reduction->extra = extra + actuators * extras;
    return 0;
}

void poke_reduction_free(poke_reduction *reduction)
{
    free(reduction->memory);
    reduction->memory = NULL;
}
