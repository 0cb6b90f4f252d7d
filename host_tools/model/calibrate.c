/* SPDX-License-Identifier: BSD-2-Clause */
/* Influence matrix from measurements (calibrate.h). */
#include "calibrate.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "eigen.h"

/* Eigenvalues of V V' below this part of the largest count as 0. */
static const double negligible = 1e-12;

/*
 * The pokes in the eigenvectors of V V' = Q diag(l) Q': every formula of this file is a sum over
 * them.
 */
typedef struct spectrum {
    size_t pokes, actuators, outputs;
    double *vector;   /* [pokes][pokes] Q, eigenvectors as columns */
    double *value;    /* [pokes] l */
    double *residual; /* [pokes][outputs] R = S - V B0' */
    double *rotated;  /* [pokes][outputs] Q'R */
    double *inverse;  /* [pokes] work */
} spectrum;

static int out_of_memory(char *error)
{
    snprintf(error, SCENE_ERROR, "out of memory");
    return -1;
}

static void spectrum_close(spectrum *s)
{
    free(s->vector);
    free(s->value);
    free(s->residual);
    free(s->rotated);
    free(s->inverse);
}

/* R = S - V B0' */
static void subtract_model(const pokes *pokes, const double *model, double *residual)
{
    memcpy(residual, pokes->shape, pokes->count * pokes->outputs * sizeof *residual);
    for (size_t p = 0; p < pokes->count && model; p++)
        for (size_t i = 0; i < pokes->outputs; i++)
            for (size_t k = 0; k < pokes->actuators; k++)
                residual[p * pokes->outputs + i] -=
                    pokes->voltage[p * pokes->actuators + k] * model[i * pokes->actuators + k];
}

/* Eigenvalues and eigenvectors of V V'. gram [pokes][pokes] work */
static void decompose(spectrum *s, const pokes *pokes, double *gram)
{
    const size_t count = pokes->count, n = pokes->actuators;
    for (size_t p = 0; p < count; p++)
        for (size_t q = 0; q < count; q++) {
            double sum = 0;
            for (size_t k = 0; k < n; k++)
                sum += pokes->voltage[p * n + k] * pokes->voltage[q * n + k];
            gram[p * count + q] = sum;
        }
    eigen_symmetric(gram, s->vector, count, 40, 0);
    for (size_t p = 0; p < count; p++)
        s->value[p] = fmax(gram[p * count + p], 0);
}

static int spectrum_open(spectrum *s, const pokes *pokes, const double *model)
{
    const size_t count = pokes->count, m = pokes->outputs;
    memset(s, 0, sizeof *s);
    s->pokes = count;
    s->actuators = pokes->actuators;
    s->outputs = m;
    s->vector = calloc(count * count + 1, sizeof *s->vector);
    s->value = calloc(count + 1, sizeof *s->value);
    s->residual = calloc(count * m + 1, sizeof *s->residual);
    s->rotated = calloc(count * m + 1, sizeof *s->rotated);
    s->inverse = calloc(count + 1, sizeof *s->inverse);
    double *gram = calloc(count * count + 1, sizeof *gram);
    const bool has_memory =
        s->vector && s->value && s->residual && s->rotated && s->inverse && gram;
    if (has_memory) {
        subtract_model(pokes, model, s->residual);
        decompose(s, pokes, gram);
        for (size_t e = 0; e < count; e++)
            for (size_t p = 0; p < count; p++)
                for (size_t i = 0; i < m; i++)
                    s->rotated[e * m + i] += s->vector[p * count + e] * s->residual[p * m + i];
    }
    free(gram);
    return has_memory ? 0 : -1;
}

static double largest_value(const spectrum *s)
{
    double most = 0;
    for (size_t e = 0; e < s->pokes; e++)
        most = fmax(most, s->value[e]);
    return most;
}

static int rank_of(const spectrum *s)
{
    int rank = 0;
    for (size_t e = 0; e < s->pokes; e++)
        rank += s->value[e] > negligible * largest_value(s);
    return rank;
}

/* Factors 1/(l + q) of the eigenvectors; 0 where l is negligible and q is 0. */
static void invert(spectrum *s, double q)
{
    const double least = negligible * largest_value(s);
    for (size_t e = 0; e < s->pokes; e++) {
        const bool counts = q > 0 || s->value[e] > least;
        s->inverse[e] = counts ? 1 / (s->value[e] + q) : 0;
    }
}

/* Variance of the noise that is most likely for a ratio q: the mean of q R'(V V' + q I)^-1 R. */
static double likely_variance(const spectrum *s, double q)
{
    double sum = 0;
    for (size_t e = 0; e < s->pokes; e++)
        for (size_t i = 0; i < s->outputs; i++)
            sum += q / (s->value[e] + q) * pow(s->rotated[e * s->outputs + i], 2);
    return sum / (double)(s->pokes * s->outputs);
}

/*
 * Negative logarithm of the likelihood of the residuals for a ratio q, with the most likely
 * variance of the noise; constants are left out.
 */
static double unlikelihood(const spectrum *s, double q)
{
    const double least = 1e-300;
    double sum = (double)s->pokes * log(fmax(likely_variance(s, q), least));
    for (size_t e = 0; e < s->pokes; e++)
        sum += log1p(s->value[e] / q);
    return sum * (double)s->outputs / 2;
}

/*
 * The most likely q on a logarithmic grid around the mean of the eigenvalues. Where the smallest q
 * is not significantly less likely, as for no more orthogonal pokes than actuators, the noise
 * cannot be told from errors of the model; then the smallest q trusts the measurements.
 */
static double choose_ratio(const spectrum *s, bool *is_separable)
{
    enum { STEPS = 128 };
    static const double significant = 3; /* of logarithms of likelihoods */
    double mean = 0, least = HUGE_VAL, smallest = 0, chosen = 0;
    for (size_t e = 0; e < s->pokes; e++)
        mean += s->value[e] / (double)s->pokes;
    for (int k = 0; k <= STEPS; k++) {
        const double q = mean * pow(10, -10 + 16.0 * k / STEPS), value = unlikelihood(s, q);
        chosen = value < least ? q : chosen;
        least = fmin(least, value);
        smallest = k == 0 ? value : smallest;
    }
    *is_separable = smallest > least + significant;
    return *is_separable ? chosen : mean * 1e-10;
}

/* ---- result ----------------------------------------------------------- */

/* B' = B0' + V' Q diag(inverse) Q'R, and the residual S - V B'. */
static void fill_influence(calibration *result, spectrum *s, const pokes *pokes,
                           const double *model)
{
    const size_t count = s->pokes, n = s->actuators, m = s->outputs;
    for (size_t i = 0; i < m * n; i++)
        result->influence[i] = model ? model[i] : 0;
    for (size_t e = 0; e < count; e++)
        for (size_t k = 0; k < n; k++) {
            double along = 0; /* entry of V'Q */
            for (size_t p = 0; p < count; p++)
                along += pokes->voltage[p * n + k] * s->vector[p * count + e];
            for (size_t i = 0; i < m; i++)
                result->influence[i * n + k] += along * s->inverse[e] * s->rotated[e * m + i];
        }
    subtract_model(pokes, result->influence, s->residual);
    double sum = 0;
    for (size_t i = 0; i < count * m; i++)
        sum += s->residual[i] * s->residual[i];
    result->residual = sqrt(sum / (double)(count * m));
}

/*
 * Standard errors. Without a model the variance is s^2 [(V'V)^-1]_kk; with one it is t^2 (1 -
 * v_k'(V V' + q I)^-1 v_k), v_k the voltages of actuator k.
 */
static void fill_errors(calibration *result, const spectrum *s, const pokes *pokes)
{
    const size_t count = s->pokes, n = s->actuators;
    for (size_t k = 0; k < n; k++) {
        double sum = 0;
        for (size_t e = 0; e < count; e++) {
            double along = 0;
            for (size_t p = 0; p < count; p++)
                along += pokes->voltage[p * n + k] * s->vector[p * count + e];
            sum +=
                result->spread > 0 ? along * along * s->inverse[e] : pow(along * s->inverse[e], 2);
        }
        result->error[k] = result->spread > 0 ? result->spread * sqrt(fmax(1 - sum, 0))
                                              : result->noise * sqrt(sum);
    }
}

/* Least squares without a model. */
static int fit_alone(calibration *result, spectrum *s, const pokes *pokes, char *error)
{
    if (result->rank < (int)pokes->actuators) {
        snprintf(error, SCENE_ERROR,
                 "%lu pokes tell %d of %lu actuators apart; measure more pokes, or give a scene "
                 "with a model of the structure",
                 (unsigned long)pokes->count, result->rank, (unsigned long)pokes->actuators);
        return -1;
    }
    invert(s, 0);
    fill_influence(result, s, pokes, NULL);
    const size_t left = pokes->count - pokes->actuators;
    result->noise =
        left > 0 ? result->residual * sqrt((double)pokes->count / (double)left) : (double)NAN;
    fill_errors(result, s, pokes);
    return 0;
}

static void fit_with_model(calibration *result, spectrum *s, const pokes *pokes,
                           const double *model)
{
    bool is_separable;
    const double q = choose_ratio(s, &is_separable);
    const double noise = sqrt(likely_variance(s, q));
    result->noise = is_separable ? noise : (double)NAN;
    result->spread = noise / sqrt(q);
    invert(s, q);
    fill_influence(result, s, pokes, model);
    fill_errors(result, s, pokes);
}

int calibrate(calibration *result, const pokes *pokes, const double *model, char *error)
{
    spectrum s;
    memset(result, 0, sizeof *result);
    result->influence = calloc(pokes->outputs * pokes->actuators + 1, sizeof *result->influence);
    result->error = calloc(pokes->actuators + 1, sizeof *result->error);
    int failed = spectrum_open(&s, pokes, model);
    if (failed || !result->influence || !result->error) {
        failed = out_of_memory(error);
    } else {
        result->rank = rank_of(&s);
        if (model)
            fit_with_model(result, &s, pokes, model);
        else
            failed = fit_alone(result, &s, pokes, error);
    }
    spectrum_close(&s);
    return failed;
}

void calibration_free(calibration *result)
{
    free(result->influence);
    free(result->error);
    memset(result, 0, sizeof *result);
}

/* ---- dead columns ------------------------------------------------------ */

static double column_rms(const calibration *result, const pokes *pokes, size_t k)
{
    double sum = 0;
    for (size_t i = 0; i < pokes->outputs; i++)
        sum += pow(result->influence[i * pokes->actuators + k], 2);
    return sqrt(sum / (double)pokes->outputs);
}

bool calibration_is_dead(const calibration *result, const pokes *pokes, size_t actuator)
{
    const double own = column_rms(result, pokes, actuator);
    size_t larger = 0;
    for (size_t k = 0; k < pokes->actuators; k++)
        larger += column_rms(result, pokes, k) * 0.05 > own;
    const bool is_significant =
        isfinite(result->error[actuator]) && own > 4 * result->error[actuator];
    return 2 * larger > pokes->actuators && !is_significant;
}
