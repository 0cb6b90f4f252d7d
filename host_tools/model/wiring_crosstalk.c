/* SPDX-License-Identifier: BSD-2-Clause */
/* Search for cross-talk between amplifiers (crosstalk_find in calibrate.h). */
#include <float.h>
#include <math.h>
#include "calibrate.h"

/*
 * Return the scalar product of column k of matrix x and column `other` of matrix y, both
 * [outputs][actuators].
 */
static double columns(const pokes *size, const double *x, size_t k, const double *y, size_t other)
{
    double sum = 0;
    for (size_t i = 0; i < size->outputs; i++)
        sum += x[i * size->actuators + k] * y[i * size->actuators + other];
    return sum;
}

/*
 * Fit column k of the computed influence matrix by two columns of the model: column k (own) and
 * column `other`.
 *   part   out  factor of column `other` in the fit
 *   alone  out  squared norm of the component of column `other` that is orthogonal to column k
 * Returns by how much the sum of squared residuals falls if column `other` is added to a fit by
 * column k alone.
 */
static double fit_other(const calibration *result, const pokes *size, const double *model, size_t k,
                        size_t other, double *part, double *alone)
{
    const double own = columns(size, model, k, model, k);
    const double mixed = columns(size, model, k, model, other);
    const double square = columns(size, model, other, model, other);
    *alone = square - mixed * mixed / own;
    const double along = columns(size, result->influence, k, model, other) -
                         columns(size, result->influence, k, model, k) * mixed / own;
    if (!(*alone > sqrt(DBL_EPSILON) * square))
        return 0;
    *part = along / *alone;
    return along * along / *alone;
}

/*
 * Find the amplifier on whose electrode the voltage of amplifier k also acts most (cross-talk).
 * Returns whether this effect is large enough to be reported, by the conditions of crosstalk_find.
 */
static bool find_one(crosstalk *found, const calibration *result, const pokes *size,
                     const double *model, size_t k)
{
    const double own = columns(size, model, k, model, k);
    const double gain = columns(size, result->influence, k, model, k);
    const double left =
        columns(size, result->influence, k, result->influence, k) - gain * gain / own;
    double most = 0;
    for (size_t other = 0; own > 0 && other < size->actuators; other++) {
        double part = 0, alone = 0;
        const double taken =
            other == k ? 0 : fit_other(result, size, model, k, other, &part, &alone);
        if (!(taken > most))
            continue;
        most = taken;
        *found = (crosstalk){k, other, part, result->error[k] / sqrt(alone)};
    }
    return most > 0 && most >= CROSSTALK_SHARE * left && fabs(found->part) >= CROSSTALK_PART &&
           fabs(found->part) >= 5 * found->error;
}

int crosstalk_find(crosstalk found[WIRING_FAULTS], const calibration *result, const pokes *size,
                   const double *model)
{
    int count = 0;
    if (!isfinite(result->noise) || result->rank < (int)size->actuators)
        return 0;
    for (size_t k = 0; k < size->actuators && count < WIRING_FAULTS; k++)
        count += find_one(&found[count], result, size, model, k);
    return count;
}
