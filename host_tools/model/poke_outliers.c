/* SPDX-License-Identifier: BSD-2-Clause */
/* Single readings of measured shapes that contradict all others (poke_outliers.h). */
#include "poke_outliers.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "dense.h"

/* Functions of time that are fitted beside the voltages: a constant and a linear drift. */
enum { TRENDS = 2 };

/*
 * Norm of a regressor (voltages of one actuator, or a trend) after the parts along all regressors
 * before it are removed, over its norm: below this, it is a combination of those.
 */
static const double distinct = 1e-6;

/* Probability at which chance alone makes an outlier of one of all readings. */
static const double chance = 1e-6;

/* Largest residual that rounding of the readings explains, over the largest reading. */
static const double rounding = 1e-12;

/*
 * Least-squares fit of all shapes to the voltages of the actuators and to the trends.
 */
typedef struct fit {
    const pokes *pokes;
    size_t vectors;   /* number of independent regressors */
    double *basis;    /* [vectors][count] orthonormal basis of the regressors */
    double *free;     /* [count] 1 - h, with the leverage h of each shape */
    double *residual; /* [count] residuals of the readings of one output */
} fit;

static int fit_open(fit *fit, const pokes *pokes)
{
    memset(fit, 0, sizeof *fit);
    fit->pokes = pokes;
    fit->basis = calloc((pokes->actuators + TRENDS + 2) * pokes->count + 1, sizeof *fit->basis);
    fit->free = fit->basis + (pokes->actuators + TRENDS) * pokes->count;
    fit->residual = fit->free + pokes->count;
    return fit->basis ? 0 : -1;
}

/* Remove the parts of a vector [count] along the basis, twice because of rounding. */
static void make_orthogonal(const fit *fit, double *vector)
{
    const size_t count = fit->pokes->count;
    for (int repeat = 0; repeat < 2; repeat++)
        for (size_t k = 0; k < fit->vectors; k++) {
            const double *base = fit->basis + k * count, part = dense_dot(base, vector, count);
            for (size_t i = 0; i < count; i++)
                vector[i] -= part * base[i];
        }
}

/* Add the regressor that stands behind the basis to it, unless it is a combination of others. */
static void add_regressor(fit *fit)
{
    const size_t count = fit->pokes->count;
    double *vector = fit->basis + fit->vectors * count;
    const double before = sqrt(dense_dot(vector, vector, count));
    make_orthogonal(fit, vector);
    const double size = sqrt(dense_dot(vector, vector, count));
    if (!(size > distinct * before))
        return;
    for (size_t i = 0; i < count; i++)
        vector[i] /= size;
    fit->vectors++;
}

/* Value of a regressor for one poke: the voltage of an actuator, then 1, then the number. */
static double regressor(const pokes *pokes, size_t poke, size_t k)
{
    if (k < pokes->actuators)
        return pokes->voltage[poke * pokes->actuators + k];
    return k == pokes->actuators ? 1 : (double)poke;
}

static void fill_basis(fit *fit)
{
    const pokes *pokes = fit->pokes;
    for (size_t k = 0; k < pokes->actuators + TRENDS; k++) {
        double *vector = fit->basis + fit->vectors * pokes->count;
        for (size_t i = 0; i < pokes->count; i++)
            vector[i] = regressor(pokes, i, k);
        add_regressor(fit);
    }
    for (size_t i = 0; i < pokes->count; i++) {
        fit->free[i] = 1;
        for (size_t k = 0; k < fit->vectors; k++)
            fit->free[i] -= pow(fit->basis[k * pokes->count + i], 2);
    }
}

static void add_outlier(poke_outliers *found, const poke_outlier *outlier)
{
    if (found->count < POKE_OUTLIERS)
        found->outlier[found->count] = *outlier;
    found->count++;
}

/* ---- leave-one-out ---------------------------------------------------- */

/*
 * Test the reading of an output that the fit without it misses by most, and store it where it is an
 * outlier.
 */
static void test_residuals(const fit *fit, size_t output, poke_outliers *found)
{
    const pokes *pokes = fit->pokes;
    const double left = (double)(pokes->count - fit->vectors - 1);
    double most = 0, largest = 0;
    size_t worst = 0;
    for (size_t i = 0; i < pokes->count; i++) {
        fit->residual[i] = pokes->shape[i * pokes->outputs + output];
        largest = fmax(largest, fabs(fit->residual[i]));
    }
    make_orthogonal(fit, fit->residual);
    for (size_t i = 0; i < pokes->count; i++) {
        const double square =
            fit->free[i] > distinct ? fit->residual[i] * fit->residual[i] / fit->free[i] : 0;
        worst = square > most ? i : worst;
        most = fmax(most, square);
    }
    const double others = fmax(dense_dot(fit->residual, fit->residual, pokes->count) - most, 0),
                 scatter = others / left + pow(rounding * largest, 2), square = most / scatter;
    const double readings = (double)(pokes->count * pokes->outputs);
    if (left / 2 * log1p(square / left) > log(readings / chance))
        add_outlier(found, &(poke_outlier){worst, output, sqrt(square), false});
}

/* ---- size ------------------------------------------------------------- */

/* Norm of the voltages of one poke, or infinity where all are 0. */
static double strength(const pokes *pokes, size_t poke)
{
    const double *voltage = pokes->voltage + poke * pokes->actuators;
    const double size = sqrt(dense_dot(voltage, voltage, pokes->actuators));
    return size > 0 ? size : HUGE_VAL;
}

/* How many times a reading is larger than all others of its shape and of its output, per volt. */
static double times_others(const pokes *pokes, size_t poke, size_t output)
{
    const double *shape = pokes->shape + poke * pokes->outputs;
    const double own = strength(pokes, poke);
    double most = DBL_MIN;
    for (size_t i = 0; i < pokes->outputs; i++)
        if (i != output)
            most = fmax(most, fabs(shape[i]) / own);
    for (size_t i = 0; i < pokes->count; i++)
        if (i != poke)
            most = fmax(most, fabs(pokes->shape[i * pokes->outputs + output]) / strength(pokes, i));
    return fabs(shape[output]) / own / most;
}

/* Index of the largest reading of a shape. */
static size_t largest_reading(const pokes *pokes, size_t poke)
{
    size_t largest = 0;
    for (size_t i = 1; i < pokes->outputs; i++)
        if (fabs(pokes->shape[poke * pokes->outputs + i]) >
            fabs(pokes->shape[poke * pokes->outputs + largest]))
            largest = i;
    return largest;
}

/*
 * Find readings that are much larger than all others. Where every actuator moves one output alone,
 * as in a segmented mirror, many readings are, and none of them is an outlier.
 */
static void test_sizes(const pokes *pokes, poke_outliers *found)
{
    poke_outliers large = {0};
    for (size_t poke = 0; poke < pokes->count; poke++) {
        const size_t output = largest_reading(pokes, poke);
        const double times = times_others(pokes, poke, output);
        if (times > OUTLIER_SIZE)
            add_outlier(&large, &(poke_outlier){poke, output, times, true});
    }
    if (10 * large.count > pokes->count && large.count > 1)
        return;
    for (size_t k = 0; k < large.count && k < POKE_OUTLIERS; k++)
        add_outlier(found, &large.outlier[k]);
}

int poke_outliers_find(poke_outliers *found, const pokes *pokes)
{
    fit fit;
    memset(found, 0, sizeof *found);
    if (pokes->count < 3 || pokes->outputs < 3)
        return 0;
    if (pokes->count < pokes->actuators + TRENDS + 2) {
        test_sizes(pokes, found);
        return 0;
    }
    if (fit_open(&fit, pokes) < 0)
        return -1;
    fill_basis(&fit);
    for (size_t output = 0; output < pokes->outputs; output++)
        test_residuals(&fit, output, found);
    free(fit.basis);
    if (found->count == 0)
        test_sizes(pokes, found);
    return 0;
}
