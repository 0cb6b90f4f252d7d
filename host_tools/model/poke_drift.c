/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Estimation, from shapes measured one after the other, of their drift over time and of the
 * fraction of earlier voltages that still acts, by hysteresis and creep (poke_drift.h).
 */
#include "poke_drift.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "dense.h"
#include "poke_reduction.h"

/*
 * Number of trends that are fitted to the measured shapes: a constant offset and a drift that is
 * linear in the number of the measurement. In the matrix of regressors their two columns come
 * first; the voltages of the preceding measurement follow.
 */
enum { TRENDS = 2 };

/*
 * Number of estimates. The second estimate uses an influence matrix computed from shapes from which
 * the offset and the drift of the first estimate were subtracted.
 */
enum { ROUNDS = 2 };

/*
 * Arrays of one estimate of offset, drift and memory (poke_drift.h), in one allocation that begins
 * at `trend`. `rows` is the number of rows of the reduced measurements that no influence matrix
 * explains (poke_reduction.rest).
 */
typedef struct estimate {
    size_t rows, outputs;
    /*
     * [TRENDS][rows] orthonormal vectors of the two trends, constant and linear drift. The vector
     * of a trend is 0 if the voltages explain the trend
     */
    double *trend;
    double scale[TRENDS]; /* norm of each trend (constant, linear drift) after it was made
                             orthogonal to the voltages and to the trend before it, by which its
                             vector in `trend` was divided; 0: the measurements do not determine the
                             trend */
    double mixed;   /* component of the linear drift (numbers 0, 1, 2 ... of the measurements) along
                       the constant trend, before it was removed to make the two vectors in `trend`
                       orthogonal */
    double *before; /* [rows][outputs] shapes that the influence matrix predicts if every
                       measurement had the voltages of the one before it; what a constant offset and
                       a linear drift explain has been subtracted */
    double *rest; /* [rows][outputs] part of the measured shapes that no influence matrix explains;
                     what a constant offset and a linear drift explain has been subtracted, too */
    /*
     * for the two trends (constant offset, linear drift over the measurements) an array [outputs]:
     * at each output, the scalar product of the trend with the measured shapes
     */
    double *part[TRENDS];
    double *part_before[TRENDS]; /* for the two trends (constant offset, linear drift over the
                                    measurements) an array [outputs]: at each output, the scalar
                                    product of the trend with the predicted shapes in `before` */
} estimate;

/*
 * Fill the regressors of all measurements, [pokes][TRENDS + actuators]: in the row of measurement k
 * the number 1, the number k, and the voltages of measurement k - 1, which are 0 for k = 0.
 */
static void fill_regressors(const pokes *pokes, double *regressor)
{
    const size_t actuators = pokes->actuators;
    for (size_t poke = 0; poke < pokes->count; poke++) {
        double *row = regressor + poke * (TRENDS + actuators);
        row[0] = 1;
        row[1] = (double)poke;
        if (poke > 0)
            memcpy(row + TRENDS, pokes->voltage + (poke - 1) * actuators, actuators * sizeof *row);
    }
}

/*
 * Compute the orthonormal vectors of the two trends, constant and linear drift, by Gram-Schmidt
 * orthogonalisation. A trend that the voltages or the other trend explain up to rounding errors
 * gets the vector 0.
 */
static void fill_trends(estimate *e, const poke_reduction *reduction, size_t pokes, size_t extras)
{
    const double size[TRENDS] = {sqrt((double)pokes), (double)pokes * sqrt((double)pokes / 3)};
    for (size_t k = 0; k < TRENDS; k++) {
        double *trend = e->trend + k * e->rows;
        for (size_t row = 0; row < e->rows; row++)
            trend[row] = reduction->extra[row * extras + k];
        const double mixed = k == 1 ? dense_dot(e->trend, trend, e->rows) : 0;
        for (size_t row = 0; row < e->rows && k == 1; row++)
            trend[row] -= mixed * e->trend[row];
        const double norm = sqrt(dense_dot(trend, trend, e->rows));
        const bool counts = norm > sqrt(DBL_EPSILON) * size[k];
        for (size_t row = 0; row < e->rows; row++)
            trend[row] = counts ? trend[row] / norm : 0;
        e->scale[k] = counts ? norm : 0;
        e->mixed = mixed;
    }
}

/*
 * Compute the components of the columns of a matrix [rows][outputs] along the two trends (constant
 * and drift), add them to part [TRENDS][outputs], and subtract them from the matrix.
 */
static void split(const estimate *e, double *value, double *const part[TRENDS])
{
    for (size_t k = 0; k < TRENDS; k++) {
        const double *trend = e->trend + k * e->rows;
        for (size_t row = 0; row < e->rows; row++)
            for (size_t i = 0; i < e->outputs; i++)
                part[k][i] += trend[row] * value[row * e->outputs + i];
        for (size_t row = 0; row < e->rows; row++)
            for (size_t i = 0; i < e->outputs; i++)
                value[row * e->outputs + i] -= trend[row] * part[k][i];
    }
}

static int estimate_open(estimate *e, size_t rows, size_t outputs)
{
    memset(e, 0, sizeof *e);
    e->rows = rows;
    e->outputs = outputs;
    e->trend =
        calloc(TRENDS * rows + 2 * rows * outputs + 2 * TRENDS * outputs + 1, sizeof *e->trend);
    e->before = e->trend + TRENDS * rows;
    e->rest = e->before + rows * outputs;
    for (size_t k = 0; k < TRENDS; k++) {
        e->part[k] = e->rest + rows * outputs + k * outputs;
        e->part_before[k] = e->part[k] + TRENDS * outputs;
    }
    return e->trend ? 0 : -1;
}

/*
 * Compute the shapes that an influence matrix predicts for the voltages of the preceding
 * measurements, in the reduced rows of the estimate.
 */
static void fill_before(estimate *e, const poke_reduction *reduction, const double *influence)
{
    const size_t actuators = reduction->pokes.actuators, extras = TRENDS + actuators;
    for (size_t row = 0; row < e->rows; row++)
        for (size_t i = 0; i < e->outputs; i++)
            e->before[row * e->outputs + i] = dense_dot(reduction->extra + row * extras + TRENDS,
                                                        influence + i * actuators, actuators);
}

/*
 * Compute the memory (the fraction of the preceding voltages that still acts), the noise, the
 * offset and the drift from the arrays of the estimate.
 *   size in  sum of squares of the shapes predicted for all measurements, for a test of rounding
 *            errors
 */
static void solve(poke_drift *drift, const estimate *e, double size)
{
    const size_t entries = e->rows * e->outputs;
    const double square = dense_dot(e->before, e->before, entries);
    const bool is_known = square > DBL_EPSILON * size;
    const double memory = is_known ? dense_dot(e->before, e->rest, entries) / square : 0;
    double noise = 0, along = 0;
    for (size_t i = 0; i < entries; i++)
        noise += pow(e->rest[i] - memory * e->before[i], 2);
    noise /= (double)((e->rows - TRENDS) * e->outputs);
    for (size_t i = 0; i < e->outputs; i++) {
        double part[TRENDS];
        for (size_t k = 0; k < TRENDS; k++) {
            part[k] = e->part[k][i] - memory * e->part_before[k][i];
            along += part[k] * part[k];
        }
        drift->slope[i] = e->scale[1] > 0 ? part[1] / e->scale[1] : 0;
        drift->offset[i] =
            e->scale[0] > 0 ? (part[0] - e->mixed * drift->slope[i]) / e->scale[0] : 0;
    }
    drift->trends = (size_t)(e->scale[0] > 0) + (size_t)(e->scale[1] > 0);
    const double expected = (double)(drift->trends * e->outputs);
    drift->drifts = along > noise * (expected + POKE_DRIFT_SIGMAS * sqrt(2 * expected));
    if (e->scale[1] > 0) {
        drift->drift = sqrt(dense_dot(drift->slope, drift->slope, e->outputs) / (double)e->outputs);
        drift->drift_error = sqrt(noise) / e->scale[1];
    }
    if (is_known) {
        drift->memory = memory;
        drift->memory_error = sqrt(noise / square);
        drift->has_memory = fabs(memory) > POKE_DRIFT_SIGMAS * drift->memory_error;
    }
}

/*
 * Return the sum of the squares of the shapes that an influence matrix predicts for the voltages of
 * all measurements.
 */
static double size_of(const pokes *pokes, const double *influence)
{
    double sum = 0;
    for (size_t poke = 0; poke < pokes->count; poke++)
        for (size_t i = 0; i < pokes->outputs; i++)
            sum += pow(calibration_predict(pokes, influence, poke, i), 2);
    return sum;
}

/*
 * Estimate offset, drift and memory from reduced measurements and an influence matrix. Returns 0,
 * or -1 where memory runs out.
 */
static int find(poke_drift *drift, const poke_reduction *reduction, const pokes *pokes,
                const double *influence)
{
    estimate e;
    if (estimate_open(&e, reduction->left, pokes->outputs) < 0)
        return -1;
    memcpy(e.rest, reduction->rest, e.rows * e.outputs * sizeof *e.rest);
    fill_trends(&e, reduction, pokes->count, TRENDS + pokes->actuators);
    fill_before(&e, reduction, influence);
    split(&e, e.rest, e.part);
    split(&e, e.before, e.part_before);
    solve(drift, &e, size_of(pokes, influence));
    free(e.trend);
    return 0;
}

/*
 * Reduce the measurements (poke_reduction.h), and estimate offset, drift and the effect of earlier
 * voltages (hysteresis, creep) from the part of the measured shapes that no influence matrix
 * explains. Nothing is estimated if too few measurements exist.
 *   influence [outputs][actuators] in  influence matrix fitted to the measured shapes by least
 *                                      squares
 * Returns 0, or -1 where memory runs out.
 */
static int find_reduced(poke_drift *drift, const pokes *pokes, const double *influence)
{
    const size_t extras = TRENDS + pokes->actuators;
    double *regressor = calloc(pokes->count * extras + 1, sizeof *regressor);
    poke_reduction reduction = {.memory = NULL};
    int failed = regressor ? 0 : -1;
    if (!failed) {
        fill_regressors(pokes, regressor);
        failed = poke_reduce(&reduction, pokes, regressor, extras);
    }
    if (!failed && reduction.left > TRENDS + 1)
        failed = find(drift, &reduction, pokes, influence);
    poke_reduction_free(&reduction);
    free(regressor);
    return failed;
}

/* Copy the measured shapes to `shape`, without offset and drift if these exceed the noise. */
static void subtract(const poke_drift *drift, const pokes *pokes, double *shape)
{
    memcpy(shape, pokes->shape, pokes->count * pokes->outputs * sizeof *shape);
    for (size_t poke = 0; drift->drifts && poke < pokes->count; poke++)
        for (size_t i = 0; i < pokes->outputs; i++)
            shape[poke * pokes->outputs + i] -= drift->offset[i] + drift->slope[i] * (double)poke;
}

int poke_drift_remove(poke_drift *drift, const pokes *pokes, double *shape)
{
    char error[SCENE_ERROR];
    struct pokes steady = *pokes;
    const double unknown = (double)NAN;
    *drift = (poke_drift){
        .drift = unknown, .drift_error = unknown, .memory = unknown, .memory_error = unknown};
    drift->offset = calloc(2 * pokes->outputs + 1, sizeof *drift->offset);
    drift->slope = drift->offset + pokes->outputs;
    if (!drift->offset)
        return -1;
    steady.shape = shape;
    subtract(drift, pokes, shape);
    for (int round = 0; round < ROUNDS && pokes->count > pokes->actuators; round++) {
        calibration alone;
        const bool is_determined = calibrate(&alone, &steady, NULL, error) == 0;
        const int failed = is_determined ? find_reduced(drift, pokes, alone.influence) : 0;
        calibration_free(&alone);
        if (failed || !is_determined)
            return failed;
        subtract(drift, pokes, shape);
    }
    return 0;
}

void poke_drift_free(poke_drift *drift)
{
    free(drift->offset);
    drift->offset = NULL;
}
