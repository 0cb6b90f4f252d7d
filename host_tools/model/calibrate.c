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

static void spectrum_close(spectrum *spectrum)
{
    free(spectrum->vector);
    free(spectrum->value);
    free(spectrum->residual);
    free(spectrum->rotated);
    free(spectrum->inverse);
}

/* R = S - V B0' */
static void subtract_model(const pokes *pokes, const double *model, double *residual)
{
    memcpy(residual, pokes->shape, pokes->count * pokes->outputs * sizeof *residual);
    for (size_t poke = 0; poke < pokes->count && model; poke++)
        for (size_t i = 0; i < pokes->outputs; i++)
            for (size_t k = 0; k < pokes->actuators; k++)
                residual[poke * pokes->outputs + i] -=
                    pokes->voltage[poke * pokes->actuators + k] * model[i * pokes->actuators + k];
}

/* Eigenvalues and eigenvectors of V V'. gram [pokes][pokes] work */
static void decompose(spectrum *spectrum, const pokes *pokes, double *gram)
{
    const size_t count = pokes->count, actuators = pokes->actuators;
    for (size_t poke = 0; poke < count; poke++)
        for (size_t other = 0; other < count; other++) {
            double sum = 0;
            for (size_t k = 0; k < actuators; k++)
                sum += pokes->voltage[poke * actuators + k] * pokes->voltage[other * actuators + k];
            gram[poke * count + other] = sum;
        }
    eigen_symmetric(gram, spectrum->vector, count, 40, 0);
    for (size_t poke = 0; poke < count; poke++)
        spectrum->value[poke] = fmax(gram[poke * count + poke], 0);
}

static int spectrum_open(spectrum *spectrum, const pokes *pokes, const double *model)
{
    const size_t count = pokes->count, outputs = pokes->outputs;
    memset(spectrum, 0, sizeof *spectrum);
    spectrum->pokes = count;
    spectrum->actuators = pokes->actuators;
    spectrum->outputs = outputs;
    spectrum->vector = calloc(count * count + 1, sizeof *spectrum->vector);
    spectrum->value = calloc(count + 1, sizeof *spectrum->value);
    spectrum->residual = calloc(count * outputs + 1, sizeof *spectrum->residual);
    spectrum->rotated = calloc(count * outputs + 1, sizeof *spectrum->rotated);
    spectrum->inverse = calloc(count + 1, sizeof *spectrum->inverse);
    double *gram = calloc(count * count + 1, sizeof *gram);
    const bool has_memory = spectrum->vector && spectrum->value && spectrum->residual &&
                            spectrum->rotated && spectrum->inverse && gram;
    if (has_memory) {
        subtract_model(pokes, model, spectrum->residual);
        decompose(spectrum, pokes, gram);
        for (size_t index = 0; index < count; index++)
            for (size_t poke = 0; poke < count; poke++)
                for (size_t i = 0; i < outputs; i++)
                    spectrum->rotated[index * outputs + i] +=
                        spectrum->vector[poke * count + index] *
                        spectrum->residual[poke * outputs + i];
    }
    free(gram);
    return has_memory ? 0 : -1;
}

static double largest_value(const spectrum *spectrum)
{
    double most = 0;
    for (size_t index = 0; index < spectrum->pokes; index++)
        most = fmax(most, spectrum->value[index]);
    return most;
}

static int rank_of(const spectrum *spectrum)
{
    int rank = 0;
    for (size_t index = 0; index < spectrum->pokes; index++)
        rank += spectrum->value[index] > negligible * largest_value(spectrum);
    return rank;
}

/* Factors 1/(l + q) of the eigenvectors; 0 where l is negligible and q is 0. */
static void invert(spectrum *spectrum, double ratio)
{
    const double least = negligible * largest_value(spectrum);
    for (size_t index = 0; index < spectrum->pokes; index++) {
        const bool counts = ratio > 0 || spectrum->value[index] > least;
        spectrum->inverse[index] = counts ? 1 / (spectrum->value[index] + ratio) : 0;
    }
}

/* Variance of the noise that is most likely for a ratio q: the mean of q R'(V V' + q I)^-1 R. */
static double likely_variance(const spectrum *spectrum, double ratio)
{
    double sum = 0;
    for (size_t index = 0; index < spectrum->pokes; index++)
        for (size_t i = 0; i < spectrum->outputs; i++)
            sum += ratio / (spectrum->value[index] + ratio) *
                   pow(spectrum->rotated[index * spectrum->outputs + i], 2);
    return sum / (double)(spectrum->pokes * spectrum->outputs);
}

/*
 * Negative logarithm of the likelihood of the residuals for a ratio q, with the most likely
 * variance of the noise; constants are left out.
 */
static double unlikelihood(const spectrum *spectrum, double ratio)
{
    const double least = 1e-300;
    double sum = (double)spectrum->pokes * log(fmax(likely_variance(spectrum, ratio), least));
    for (size_t index = 0; index < spectrum->pokes; index++)
        sum += log1p(spectrum->value[index] / ratio);
    return sum * (double)spectrum->outputs / 2;
}

/*
 * The most likely q on a logarithmic grid around the mean of the eigenvalues. Where the smallest q
 * is not significantly less likely, as for no more orthogonal pokes than actuators, the noise
 * cannot be told from errors of the model; then the smallest q trusts the measurements.
 */
static double choose_ratio(const spectrum *spectrum, bool *is_separable)
{
    enum { STEPS = 128 };
    static const double significant = 3; /* of logarithms of likelihoods */
    double mean = 0, least = HUGE_VAL, smallest = 0, chosen = 0;
    for (size_t index = 0; index < spectrum->pokes; index++)
        mean += spectrum->value[index] / (double)spectrum->pokes;
    for (int k = 0; k <= STEPS; k++) {
        const double ratio = mean * pow(10, -10 + 16.0 * k / STEPS),
                     value = unlikelihood(spectrum, ratio);
        chosen = value < least ? ratio : chosen;
        least = fmin(least, value);
        smallest = k == 0 ? value : smallest;
    }
    *is_separable = smallest > least + significant;
    return *is_separable ? chosen : mean * 1e-10;
}

/* ---- result ----------------------------------------------------------- */

/* B' = B0' + V' Q diag(inverse) Q'R, and the residual S - V B'. */
static void fill_influence(calibration *result, spectrum *spectrum, const pokes *pokes,
                           const double *model)
{
    const size_t count = spectrum->pokes, actuators = spectrum->actuators,
                 outputs = spectrum->outputs;
    for (size_t i = 0; i < outputs * actuators; i++)
        result->influence[i] = model ? model[i] : 0;
    for (size_t index = 0; index < count; index++)
        for (size_t k = 0; k < actuators; k++) {
            double along = 0; /* entry of V'Q */
            for (size_t poke = 0; poke < count; poke++)
                along +=
                    pokes->voltage[poke * actuators + k] * spectrum->vector[poke * count + index];
            for (size_t i = 0; i < outputs; i++)
                result->influence[i * actuators + k] +=
                    along * spectrum->inverse[index] * spectrum->rotated[index * outputs + i];
        }
    subtract_model(pokes, result->influence, spectrum->residual);
    double sum = 0;
    for (size_t i = 0; i < count * outputs; i++)
        sum += spectrum->residual[i] * spectrum->residual[i];
    result->residual = sqrt(sum / (double)(count * outputs));
}

/*
 * Standard errors. Without a model the variance is s^2 [(V'V)^-1]_kk; with one it is t^2 (1 -
 * v_k'(V V' + q I)^-1 v_k), v_k the voltages of actuator k.
 */
static void fill_errors(calibration *result, const spectrum *spectrum, const pokes *pokes)
{
    const size_t count = spectrum->pokes, actuators = spectrum->actuators;
    for (size_t k = 0; k < actuators; k++) {
        double sum = 0;
        for (size_t index = 0; index < count; index++) {
            double along = 0;
            for (size_t poke = 0; poke < count; poke++)
                along +=
                    pokes->voltage[poke * actuators + k] * spectrum->vector[poke * count + index];
            sum += result->spread > 0 ? along * along * spectrum->inverse[index]
                                      : pow(along * spectrum->inverse[index], 2);
        }
        result->error[k] = result->spread > 0 ? result->spread * sqrt(fmax(1 - sum, 0))
                                              : result->noise * sqrt(sum);
    }
}

/* Least squares without a model. */
static int fit_alone(calibration *result, spectrum *spectrum, const pokes *pokes, char *error)
{
    if (result->rank < (int)pokes->actuators) {
        snprintf(error, SCENE_ERROR,
                 "%lu pokes tell %d of %lu actuators apart; measure more pokes, or give a scene "
                 "with a model of the structure",
                 (unsigned long)pokes->count, result->rank, (unsigned long)pokes->actuators);
        return -1;
    }
    invert(spectrum, 0);
    fill_influence(result, spectrum, pokes, NULL);
    const size_t left = pokes->count - pokes->actuators;
    result->noise =
        left > 0 ? result->residual * sqrt((double)pokes->count / (double)left) : (double)NAN;
    fill_errors(result, spectrum, pokes);
    return 0;
}

static void fit_with_model(calibration *result, spectrum *spectrum, const pokes *pokes,
                           const double *model)
{
    bool is_separable;
    const double ratio = choose_ratio(spectrum, &is_separable);
    const double noise = sqrt(likely_variance(spectrum, ratio));
    result->noise = is_separable ? noise : (double)NAN;
    result->spread = noise / sqrt(ratio);
    invert(spectrum, ratio);
    fill_influence(result, spectrum, pokes, model);
    fill_errors(result, spectrum, pokes);
}

int calibrate(calibration *result, const pokes *pokes, const double *model, char *error)
{
    spectrum spectrum;
    memset(result, 0, sizeof *result);
    result->influence = calloc(pokes->outputs * pokes->actuators + 1, sizeof *result->influence);
    result->error = calloc(pokes->actuators + 1, sizeof *result->error);
    int failed = spectrum_open(&spectrum, pokes, model);
    if (failed || !result->influence || !result->error) {
        failed = out_of_memory(error);
    } else {
        result->rank = rank_of(&spectrum);
        if (model)
            fit_with_model(result, &spectrum, pokes, model);
        else
            failed = fit_alone(result, &spectrum, pokes, error);
    }
    spectrum_close(&spectrum);
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
