/* SPDX-License-Identifier: BSD-2-Clause */
/* Computation of an influence matrix from shapes measured under known voltages (calibrate.h). */
#include "calibrate.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/modes/eigen.h"
#include "poke_reduction.h"

/*
 * Eigenvalues of V V' below this fraction of the largest one count as 0, where V
 * [measurements][actuators] holds the voltages of all measured shapes and ' is the transpose.
 */
static const double negligible = 1e-12;

/*
 * Measured shapes of a calibration in the basis of the eigenvectors Q of V V' = Q diag(l) Q', with
 * the voltages V [measurements][actuators] and eigenvalues l. In this basis every formula is a sum
 * over the eigenvalues.
 */
typedef struct spectrum {
    size_t pokes, actuators, outputs; /* pokes (shapes measured under known voltages) after
                                         poke_reduction.h has combined them to at most as many as
                                         there are actuators */
    size_t measured; /* pokes (shapes measured under known voltages) as they were measured, before
                        they were combined to fewer ones */
    double rest; /* sum of the squares of the part of the measured shapes that no influence matrix
                    explains */
    double *vector;   /* [measurements][measurements] eigenvectors of V V' as columns, where V
                         [measurements][actuators] holds the voltages of all measured shapes */
    double *value;    /* [measurements] eigenvalues of V V', where V [measurements][actuators] holds
                         the voltages of all measured shapes */
    double *residual; /* [measurements][outputs] measured shapes minus those that the model predicts
                       */
    double *rotated;  /* [measurements][outputs] product of Q' and the residuals (measured minus
                         predicted shapes), with Q the eigenvectors of V V' and V
                         [measurements][actuators] the voltages of all measured shapes */
    double *inverse;  /* [measurements] 1/(eigenvalue + q) for each eigenvalue of V V', or 0 where
                         the eigenvalue counts as 0. V holds the voltages of all measured shapes; q
                         is the variance of the noise over that of the model error */
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

/*
 * Subtract the shapes that a model predicts from the measured shapes.
 *   model    [outputs][actuators] in   influence matrix, or NULL for zeros
 *   residual [measurements][outputs] out differences between measured and predicted shapes
 */
static void subtract_model(const pokes *pokes, const double *model, double *residual)
{
    memcpy(residual, pokes->shape, pokes->count * pokes->outputs * sizeof *residual);
    for (size_t poke = 0; poke < pokes->count && model; poke++)
        for (size_t i = 0; i < pokes->outputs; i++)
            for (size_t k = 0; k < pokes->actuators; k++)
                residual[poke * pokes->outputs + i] -=
                    pokes->voltage[poke * pokes->actuators + k] * model[i * pokes->actuators + k];
}

/*
 * Compute the eigenvalues and eigenvectors of V V', where V [measurements][actuators] holds the
 * voltages of all measured shapes.
 *   gram [measurements][measurements] out  work array
 */
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
    double largest = 0;
    for (size_t poke = 0; poke < count; poke++)
        largest = fmax(largest, gram[poke * count + poke]);
    pzs_eigen_symmetric(gram, spectrum->vector, count, 40, DBL_EPSILON * DBL_EPSILON * largest);
    for (size_t poke = 0; poke < count; poke++)
        spectrum->value[poke] = fmax(gram[poke * count + poke], 0);
}

/*
 * Return the sum of the squares of `rest`, the part of the measured shapes that no influence matrix
 * explains, such as noise.
 */
static double rest_of(const poke_reduction *reduction)
{
    double sum = 0;
    for (size_t i = 0; i < reduction->left * reduction->pokes.outputs; i++)
        sum += reduction->rest[i] * reduction->rest[i];
    return sum;
}

static int spectrum_open(spectrum *spectrum, const poke_reduction *reduction, const double *model)
{
    const pokes *pokes = &reduction->pokes;
    const size_t count = pokes->count, outputs = pokes->outputs;
    memset(spectrum, 0, sizeof *spectrum);
    spectrum->pokes = count;
    spectrum->actuators = pokes->actuators;
    spectrum->outputs = outputs;
    spectrum->measured = count + reduction->left;
    spectrum->rest = rest_of(reduction);
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

/*
 * Compute 1/(eigenvalue + ratio) for the eigenvalues of V V', where V holds the voltages of all
 * measured shapes. `ratio` is the variance of the noise over that of the model error. The result is
 * 0 where the eigenvalue is negligible and the ratio is 0.
 */
static void invert(spectrum *spectrum, double ratio)
{
    const double least = negligible * largest_value(spectrum);
    for (size_t index = 0; index < spectrum->pokes; index++) {
        const bool counts = ratio > 0 || spectrum->value[index] > least;
        spectrum->inverse[index] = counts ? 1 / (spectrum->value[index] + ratio) : 0;
    }
}

/*
 * Return the most likely variance of the measurement noise for a ratio q of the variances of noise
 * and model error:
 *   trace(q R'(V V' + q I)^-1 R)/(measurements x outputs).
 *   R  [measurements][outputs] residuals
 *   V  [measurements][actuators] voltages of all measured shapes
 */
static double likely_variance(const spectrum *spectrum, double ratio)
{
    double sum = spectrum->rest;
    for (size_t index = 0; index < spectrum->pokes; index++)
        for (size_t i = 0; i < spectrum->outputs; i++)
            sum += ratio / (spectrum->value[index] + ratio) *
                   pow(spectrum->rotated[index * spectrum->outputs + i], 2);
    return sum / (double)(spectrum->measured * spectrum->outputs);
}

/*
 * Negative log-likelihood of the residuals (measured minus predicted shapes) for a given ratio of
 * two variances, those of noise and model error. The noise has its most likely variance. Terms that
 * do not depend on the ratio are left out.
 */
static double unlikelihood(const spectrum *spectrum, double ratio)
{
    const double least = 1e-300;
    double sum = (double)spectrum->measured * log(fmax(likely_variance(spectrum, ratio), least));
    for (size_t index = 0; index < spectrum->pokes; index++)
        sum += log1p(spectrum->value[index] / ratio);
    return sum * (double)spectrum->outputs / 2;
}

/*
 * Choose the most likely ratio of the variances of measurement noise and model error. Candidates
 * form a logarithmic grid around the mean eigenvalue of V V', with the voltages V
 * [measurements][actuators] of the measured shapes. If the smallest candidate is almost as likely,
 * noise and model error cannot be separated. The smallest one is then chosen, which trusts the
 * measurements.
 *   is_separable out  whether they can be separated; not, for example, with few measured shapes of
 *                     single actuators
 */
static double choose_ratio(const spectrum *spectrum, bool *is_separable)
{
    enum { STEPS = 128 };
    static const double significant = 3; /* smallest difference of negative log-likelihoods at which
                                            one ratio of the variances of noise and model error
                                            counts as significantly less likely than another */
    double mean = 0, least = HUGE_VAL, smallest = 0, chosen = 0;
    for (size_t index = 0; index < spectrum->pokes; index++)
        mean += spectrum->value[index] / (double)spectrum->measured;
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

/*
 * Compute the influence matrix from the measured shapes (formula in calibrate.h), with sums over
 * the eigenvectors of V V', and the root mean square of the differences that are left.
 *   model [outputs][actuators] in  influence matrix of the model, from which only deviations are
 *       fitted; NULL: no model
 */
static void fill_influence(calibration *result, spectrum *spectrum, const pokes *pokes,
                           const double *model)
{
    const size_t count = spectrum->pokes, actuators = spectrum->actuators,
                 outputs = spectrum->outputs;
    for (size_t i = 0; i < outputs * actuators; i++)
        result->influence[i] = model ? model[i] : 0;
    for (size_t index = 0; index < count; index++)
        for (size_t k = 0; k < actuators; k++) {
            double along = 0; /* scalar product of two vectors over all measured shapes: the
                                 voltages of actuator k, and eigenvector `index` of V V' (V
                                 [measurements][actuators]: all voltages) */
            for (size_t poke = 0; poke < count; poke++)
                along +=
                    pokes->voltage[poke * actuators + k] * spectrum->vector[poke * count + index];
            for (size_t i = 0; i < outputs; i++)
                result->influence[i * actuators + k] +=
                    along * spectrum->inverse[index] * spectrum->rotated[index * outputs + i];
        }
    subtract_model(pokes, result->influence, spectrum->residual);
    double sum = spectrum->rest;
    for (size_t i = 0; i < count * outputs; i++)
        sum += spectrum->residual[i] * spectrum->residual[i];
    result->residual = sqrt(sum / (double)(spectrum->measured * outputs));
}

/*
 * Compute the standard error of the entries of column k of the influence matrix. Their variance is
 *   s^2 times the diagonal entry k of (V'V)^-1     without a model,
 *   t^2 (1 - v'(V V' + q I)^-1 v)                  with a model.
 *   V, v  voltages of all pokes (measured shapes), and those of actuator k
 *   s, t  standard deviations of the noise and of the model's entries
 *   q     (s/t)^2
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

/*
 * Compute the influence matrix by least squares without a model. Returns 0, or -1 with error filled
 * where the pokes (shapes measured under known voltages) do not determine every actuator.
 */
static int fit_alone(calibration *result, spectrum *spectrum, const pokes *pokes, char *error)
{
    if (result->rank < (int)pokes->actuators) {
        snprintf(error, SCENE_ERROR,
                 "%lu pokes tell %d of %lu actuators apart; measure more pokes, or give a scene "
                 "with a model of the structure",
                 (unsigned long)spectrum->measured, result->rank, (unsigned long)pokes->actuators);
        return -1;
    }
    invert(spectrum, 0);
    fill_influence(result, spectrum, pokes, NULL);
    const size_t lost = pokes->actuators + pokes->trends,
                 left = spectrum->measured > lost ? spectrum->measured - lost : 0;
    result->noise =
        left > 0 ? result->residual * sqrt((double)spectrum->measured / (double)left) : (double)NAN;
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

/*
 * Compute the influence matrix from pokes (measured shapes) that have been combined to at most as
 * many as there are actuators. Returns 0, or -1 with error filled.
 */
static int fit_reduced(calibration *result, const poke_reduction *reduction, const double *model,
                       char *error)
{
    spectrum spectrum;
    int failed = 0;
    if (spectrum_open(&spectrum, reduction, model) < 0) {
        failed = out_of_memory(error);
    } else {
        result->rank = rank_of(&spectrum);
        if (model)
            fit_with_model(result, &spectrum, &reduction->pokes, model);
        else
            failed = fit_alone(result, &spectrum, &reduction->pokes, error);
    }
    spectrum_close(&spectrum);
    return failed;
}

int calibrate(calibration *result, const pokes *pokes, const double *model, char *error)
{
    poke_reduction reduction;
    memset(result, 0, sizeof *result);
    result->influence = calloc(pokes->outputs * pokes->actuators + 1, sizeof *result->influence);
    result->error = calloc(pokes->actuators + 1, sizeof *result->error);
    int failed = poke_reduce(&reduction, pokes, NULL, 0);
    if (failed || !result->influence || !result->error)
        failed = out_of_memory(error);
    else
        failed = fit_reduced(result, &reduction, model, error);
    poke_reduction_free(&reduction);
    return failed;
}

void calibration_free(calibration *result)
{
    free(result->influence);
    free(result->error);
    memset(result, 0, sizeof *result);
}

double calibration_predict(const pokes *pokes, const double *influence, size_t poke, size_t output)
{
    const double *voltage = pokes->voltage + poke * pokes->actuators;
    const double *row = influence + output * pokes->actuators;
    double sum = 0;
    for (size_t k = 0; k < pokes->actuators; k++)
        sum += voltage[k] * row[k];
    return sum;
}

double calibration_output_noise(const calibration *result, const pokes *pokes, size_t output)
{
    const size_t lost = (size_t)result->rank + pokes->trends;
    if (!isfinite(result->noise) || pokes->count <= lost)
        return result->noise;
    double sum = 0;
    for (size_t poke = 0; poke < pokes->count; poke++)
        sum += pow(pokes->shape[poke * pokes->outputs + output] -
                       calibration_predict(pokes, result->influence, poke, output),
                   2);
    return sqrt((sum + NOISE_POKES * result->noise * result->noise) /
                (double)(pokes->count - lost + NOISE_POKES));
}

double calibration_entry_error(const calibration *result, const pokes *pokes, size_t output,
                               size_t actuator)
{
    if (!(result->noise > 0))
        return result->error[actuator];
    return result->error[actuator] * calibration_output_noise(result, pokes, output) /
           result->noise;
}

double calibration_size(const pokes *pokes, const double *model)
{
    double measured = 0, predicted = 0;
    for (size_t poke = 0; poke < pokes->count; poke++)
        for (size_t i = 0; i < pokes->outputs; i++) {
            measured += pow(pokes->shape[poke * pokes->outputs + i], 2);
            predicted += pow(calibration_predict(pokes, model, poke, i), 2);
        }
    return sqrt(measured / predicted);
}

/* ---- idle and dead actuators --------------------------------------------- */

bool calibration_is_idle(const pokes *pokes, size_t actuator)
{
    for (size_t poke = 0; poke < pokes->count; poke++)
        if (pokes->voltage[poke * pokes->actuators + actuator] != 0)
            return false;
    return true;
}

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
