/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Identification of vibration modes from the free vibration that follows steps of the voltages
 * (identify_modes.h). In this file, an interval is a run of samples with constant voltages, and a
 * channel is a weighted sum of the readings of all outputs.
 */
#include "identify_modes.h"
#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/core/linalg.h"
#include "../mesh/invert.h"
#include "../../lib/modes/eigen.h"

enum {
    CHANNELS = 10, /* largest number of channels (weighted sums of the readings) in which
                      frequencies are searched */
    BLOCKS = 9,    /* smallest number of samples of each channel (weighted sum of the readings) in a
                      vector of delayed samples. Such a vector contains samples of all channels at
                      several equally spaced times. The covariance of such vectors yields the
                      frequencies and damping ratios. */
    LEAST_ROWS = 40,    /* smallest number of entries of a vector of delayed samples: number of
                           channels (weighted sums of the readings) times number of samples of each
                           channel */
    LEAST_SAMPLES = 40, /* smallest number of samples of an interval of constant voltages */
    SKIPPED = 4,        /* number of samples left out where an interval of constant voltages begins,
                           because the voltages may act with a delay of up to so many samples */
    SWEEPS = 12, /* number of sweeps of Jacobi's method, which computes the eigenvalues of the
                    covariance of the signals */
    SUBSPACE_ROUNDS = 20,
    ROOT_ROUNDS = 100,
    REFINEMENTS = 30,
    SHAPE_ROUNDS = 60,
    SPARE = 4, /* number of dimensions of the signal subspace in addition to those of the wanted
                  vibration modes */
    PARAMETERS = 2 * IDENTIFIED_MODES,
    BASIS = 2 * IDENTIFIED_MODES + 1, /* largest number of functions that describe a reading in an
                                         interval of constant voltages: cosine and sine of each
                                         vibration mode, and a constant */
    ROOTS = 2 * IDENTIFIED_MODES + SPARE
};

static const double two_pi = 6.283185307179586, largest_damping = 0.3;

/*
 * Limits for a vibration mode; a mode that violates one of them is left out. First: smallest energy
 * of the mode in the readings, relative to the energy that noise alone would give it. Second:
 * largest standard error of its frequency, relative to the frequency.
 */
static const double significant = 10, largest_error = 0.01;

/*
 * Largest frequency of a vibration mode, relative to half the samples in a second. Nearer to it the
 * decaying cosine and sine can hardly be distinguished.
 */
static const double most_turn = 0.98;

/*
 * Two modes whose frequencies differ by less than `near` (relative) are one and the same if one
 * alone fits the readings as well. A mode is a pair of modes of equal frequency if its readings
 * have a second shape of at least the amplitude `second_shape`, relative to the first one; less may
 * be a slight error of the frequency, or damping that turns the phase.
 */
static const double near = 0.02, second_shape = 0.05;

typedef struct interval {
    size_t first, count; /* an interval of constant voltages: index of its first sample, and number
                            of its samples */
} interval;

/*
 * Intermediate results while vibration modes are identified from a record of voltages and sensor
 * readings.
 */
typedef struct fit {
    const pokes *samples;
    double rate;
    size_t intervals, longest, channels;
    size_t blocks; /* number of samples of each channel (weighted sum of the readings) in a vector
                      of delayed samples. Such a vector contains samples of all channels at several
                      equally spaced times. */
    interval *interval; /* [intervals] intervals of constant voltages */
    double *mixer;      /* [channels][outputs] orthonormal weights of the outputs in each channel, a
                           weighted sum of the readings */
    double *signal; /* [channels][samples] signal of each channel (weighted sum of the readings),
                       without its mean in each interval of constant voltages (unit of the readings)
                     */
    double *function, *slope; /* work arrays, whose rows are as long as the longest interval of
                                 constant voltages. function: BASIS rows of orthonormal functions
                                 that span a constant and the modes' decaying cosines and sines,
                                 then rows of derivatives of a fitted signal by each frequency and
                                 damping ratio. slope: derivatives of the cosines and sines by
                                 frequency and damping ratio */
    double *column; /* work vector for one signal in the longest interval of constant voltages */
    int modes;
    double frequency[IDENTIFIED_MODES]; /* present estimates of the angular frequencies of the
                                           vibration modes (rad/s) */
    double damping[IDENTIFIED_MODES];   /* present estimates of the damping ratios of the vibration
                                           modes */
} fit;

static int refuse(char *error, const char *text)
{
    snprintf(error, SCENE_ERROR, "%s", text);
    return -1;
}

static void add(double *to, const double *vector, double factor, size_t count)
{
    for (size_t i = 0; i < count; i++)
        to[i] += factor * vector[i];
}

/* ---- record of voltages and readings ---------------------------------------- */

static bool has_step(const pokes *samples, size_t sample)
{
    const size_t columns = samples->actuators;
    return memcmp(samples->voltage + sample * columns, samples->voltage + (sample - 1) * columns,
                  columns * sizeof(double)) != 0;
}

/*
 * List the intervals of constant voltages. The first samples of an interval are left out, because
 * they may have been read before the step of the voltages acts.
 */
static void list_intervals(fit *fit)
{
    const size_t count = fit->samples->count;
    size_t first = 0;
    for (size_t sample = 1; sample <= count; sample++) {
        if (sample < count && !has_step(fit->samples, sample))
            continue;
        const size_t length = sample - first;
        if (length > LEAST_SAMPLES) {
            fit->interval[fit->intervals++] = (interval){first + SKIPPED, length - SKIPPED};
            fit->longest = length > fit->longest ? length : fit->longest;
        }
        first = sample;
    }
}

/*
 * Mean of a value over an interval of constant voltages with Hann's weights, by which a vibration
 * of several periods cancels out.
 *   value  in  address of the value in the first sample of the interval
 *   count  in  number of samples
 *   stride in  distance between samples in the array
 */
static double quiet_mean(const double *value, size_t count, size_t stride)
{
    double sum = 0, weights = 0;
    for (size_t i = 0; i < count; i++) {
        const double weight = 1 - cos(two_pi * ((double)i + 0.5) / (double)count);
        sum += weight * value[i * stride];
        weights += weight;
    }
    return sum / weights;
}

/*
 * Compute the readings of one output without their mean in each interval of constant voltages.
 *   value [samples] out  readings minus means (unit of the readings)
 */
static void centred(const fit *fit, size_t output, double *value)
{
    const size_t outputs = fit->samples->outputs;
    for (size_t index = 0; index < fit->intervals; index++) {
        const interval *interval = &fit->interval[index];
        const double *reading = fit->samples->shape + interval->first * outputs + output;
        const double mean = quiet_mean(reading, interval->count, outputs);
        for (size_t i = 0; i < interval->count; i++)
            value[interval->first + i] = reading[i * outputs] - mean;
    }
}

/*
 * Make the weights of one channel (weighted sum of the readings) orthogonal to those of all
 * channels before it, and scale them to length 1.
 */
static void orthonormalise(const fit *fit, size_t row)
{
    const size_t outputs = fit->samples->outputs;
    double *vector = fit->mixer + row * outputs;
    for (int repeat = 0; repeat < 2; repeat++)
        for (size_t j = 0; j < row; j++)
            add(vector, fit->mixer + j * outputs,
                -pzs_linalg_inner(fit->mixer + j * outputs, vector, (uint32_t)outputs), outputs);
    const double size = sqrt(pzs_linalg_inner(vector, vector, (uint32_t)outputs));
    for (size_t i = 0; i < outputs; i++)
        vector[i] = size > 0 ? vector[i] / size : 0;
}

/*
 * Compute the signals of all channels, which are weighted sums of the readings.
 *   reading [outputs][samples] in  readings without their mean in each interval of constant
 *                                  voltages
 */
static void mix(fit *fit, const double *reading)
{
    const size_t outputs = fit->samples->outputs, count = fit->samples->count;
    memset(fit->signal, 0, fit->channels * count * sizeof *fit->signal);
    for (size_t channel = 0; channel < fit->channels; channel++)
        for (size_t i = 0; i < outputs; i++)
            add(fit->signal + channel * count, reading + i * count,
                fit->mixer[channel * outputs + i], count);
}

/*
 * Choose the weights of the channels (weighted sums of the readings) so that their signals have the
 * largest energy, by subspace iteration, and compute the signals. Returns whether memory sufficed.
 */
static bool choose_channels(fit *fit)
{
    const size_t outputs = fit->samples->outputs, count = fit->samples->count;
    double *reading = calloc(outputs * count, sizeof *reading);
    if (!reading)
        return false;
    for (size_t i = 0; i < outputs; i++)
        centred(fit, i, reading + i * count);
    for (size_t k = 0; k < fit->channels * outputs; k++)
        fit->mixer[k] =
            sin(1 + 1.7 * (double)k + 0.3 * (double)(k % 7)); /* the weights with which the subspace
                                                                 iteration starts are arbitrary, but
                                                                 linearly independent */
    for (int round = 0; round < SUBSPACE_ROUNDS; round++) {
        for (size_t row = 0; row < fit->channels; row++)
            orthonormalise(fit, row);
        mix(fit, reading);
        for (size_t row = 0; row < fit->channels && round + 1 < SUBSPACE_ROUNDS; row++)
            for (size_t i = 0; i < outputs; i++)
                fit->mixer[row * outputs + i] = pzs_linalg_inner(
                    fit->signal + row * count, reading + i * count, (uint32_t)count);
    }
    free(reading);
    return true;
}

/* ---- decaying sinusoids ---------------------------------------------------- */

/*
 * Compute orthonormal functions that span a constant and the decaying cosine and sine of each
 * vibration mode over an interval of constant voltages.
 *   triangle [BASIS][BASIS] out  column k: coefficients of function k (the constant, then cosine
 *       and sine of each mode) in the orthonormal functions
 */
static void fill_functions(const fit *fit, const interval *interval, double triangle[BASIS][BASIS])
{
    const size_t count = interval->count;
    const int functions = 2 * fit->modes + 1;
    memset(triangle, 0, sizeof(double[BASIS][BASIS]));
    for (int k = 0; k < functions; k++) {
        double *function = fit->function + (size_t)k * fit->longest;
        const int mode = (k - 1) / 2;
        for (size_t i = 0; i < count; i++) {
            const double time = (double)i / fit->rate;
            const double decay = k ? exp(-fit->damping[mode] * fit->frequency[mode] * time) : 1;
            const double phase =
                k ? fit->frequency[mode] * sqrt(1 - pow(fit->damping[mode], 2)) * time : 0;
            function[i] = decay * (k % 2 || k == 0 ? cos(phase) : sin(phase));
        }
        const double before = sqrt(pzs_linalg_inner(function, function, (uint32_t)count));
        for (int repeat = 0; repeat < 2; repeat++)
            for (int j = 0; j < k; j++) {
                const double *other = fit->function + (size_t)j * fit->longest;
                const double part = pzs_linalg_inner(other, function, (uint32_t)count);
                triangle[j][k] += part;
                add(function, other, -part, count);
            }
        const double size = sqrt(pzs_linalg_inner(function, function, (uint32_t)count));
        const bool is_new = size > 1e-9 * before;
        triangle[k][k] = is_new ? size : 0;
        for (size_t i = 0; i < count; i++)
            function[i] = is_new ? function[i] / size : 0;
    }
}

/*
 * Fit a constant and the decaying cosine and sine of each vibration mode to a signal in an interval
 * of constant voltages, by least squares.
 *   triangle [BASIS][BASIS] in      coefficients of these functions (fill_functions)
 *   signal   [count]        in/out  the signal, replaced by the residual of the fit
 *   coefficient [BASIS]     out     coefficients of the constant, and of cosine and sine of each
 *       mode
 */
static void fit_signal(const fit *fit, size_t count, double triangle[BASIS][BASIS], double *signal,
                       double coefficient[BASIS])
{
    const int functions = 2 * fit->modes + 1;
    for (int k = 0; k < functions; k++) {
        const double *function = fit->function + (size_t)k * fit->longest;
        coefficient[k] = pzs_linalg_inner(function, signal, (uint32_t)count);
        add(signal, function, -coefficient[k], count);
    }
    for (int k = functions - 1; k >= 0; k--) {
        for (int j = k + 1; j < functions; j++)
            coefficient[k] -= triangle[k][j] * coefficient[j];
        coefficient[k] = triangle[k][k] > 0 ? coefficient[k] / triangle[k][k] : 0;
    }
}

/*
 * Compute the derivatives of the decaying cosine and sine of each vibration mode with respect to
 * its angular frequency and its damping ratio. Then make them orthogonal to the functions of the
 * fit (fit->function). Rows 4 k to 4 k + 3 of fit->slope belong to mode k: cosine and sine by
 * frequency, then by damping ratio.
 */
static void fill_slopes(const fit *fit, const interval *interval)
{
    const size_t count = interval->count;
    for (int mode = 0; mode < fit->modes; mode++) {
        const double frequency = fit->frequency[mode], damping = fit->damping[mode],
                     root = sqrt(1 - damping * damping);
        double *row = fit->slope + 4 * (size_t)mode * fit->longest;
        for (size_t i = 0; i < count; i++) {
            const double time = (double)i / fit->rate, decay = exp(-damping * frequency * time),
                         cosine = decay * cos(frequency * root * time),
                         sine = decay * sin(frequency * root * time);
            row[i] = time * (-damping * cosine - root * sine);
            row[fit->longest + i] = time * (-damping * sine + root * cosine);
            row[2 * fit->longest + i] = frequency * time * (-cosine + damping / root * sine);
            row[3 * fit->longest + i] = frequency * time * (-sine - damping / root * cosine);
        }
        for (int k = 0; k < 4; k++)
            for (int j = 0; j < 2 * fit->modes + 1; j++) {
                const double *function = fit->function + (size_t)j * fit->longest;
                double *slope = row + (size_t)k * fit->longest;
                add(slope, function, -pzs_linalg_inner(function, slope, (uint32_t)count), count);
            }
    }
}

/*
 * Normal equations of a step that refines frequencies and damping ratios, and sums of squares of
 * the present fit.
 */
typedef struct normal {
    double matrix[PARAMETERS * PARAMETERS], right[PARAMETERS];
    double squares; /* sum of squares, over all signals (weighted sums of the readings) and samples,
                       of what the fitted vibration modes do not explain (squared unit of the
                       readings) */
    double energy[IDENTIFIED_MODES]; /* energy of each vibration mode: sum of squares, over all
                                        signals (weighted sums of the readings) and samples, of the
                                        mode's decaying vibration (squared unit of the readings) */
    size_t values; /* number of samples of all signals (weighted sums of the readings) minus number
                      of fitted coefficients */
} normal;

/*
 * Add one signal in an interval of constant voltages to the normal equations of a Gauss-Newton step
 * that refines frequencies and damping ratios.
 *   left        [count] in      residual of the fit of the signal (fit_signal)
 *   coefficient [BASIS] in      coefficients of this fit
 *   normal              in/out  the normal equations
 */
static void add_signal(const fit *fit, size_t count, const double *left,
                       const double coefficient[BASIS], normal *normal)
{
    const int parameters = 2 * fit->modes;
    double weight[PARAMETERS][2];
    for (int k = 0; k < parameters; k++)
        for (int part = 0; part < 2; part++)
            weight[k][part] = coefficient[1 + 2 * (k / 2) + part];
    for (int k = 0; k < parameters; k++) {
        const double *own = fit->slope + 2 * (size_t)k * fit->longest;
        double *derivative = fit->function + (size_t)(BASIS + k) * fit->longest;
        for (size_t i = 0; i < count; i++)
            derivative[i] = weight[k][0] * own[i] + weight[k][1] * own[fit->longest + i];
        normal->right[k] += pzs_linalg_inner(derivative, left, (uint32_t)count);
        for (int j = 0; j <= k; j++)
            normal->matrix[k * PARAMETERS + j] += pzs_linalg_inner(
                derivative, fit->function + (size_t)(BASIS + j) * fit->longest, (uint32_t)count);
    }
    normal->squares += pzs_linalg_inner(left, left, (uint32_t)count);
}

/*
 * Add the energy of each vibration mode in one interval of one signal to normal->energy: the sum
 * over the samples of the square of the mode's decaying vibration, computed from its coefficients
 * of cosine and sine.
 */
static void add_energy(const fit *fit, size_t count, const double coefficient[BASIS],
                       normal *normal)
{
    for (int mode = 0; mode < fit->modes; mode++) {
        const double rate = 2 * fit->damping[mode] * fit->frequency[mode] / fit->rate;
        const double duration = -expm1(-rate * (double)count) / -expm1(-rate);
        normal->energy[mode] +=
            duration / 2 * (pow(coefficient[1 + 2 * mode], 2) + pow(coefficient[2 + 2 * mode], 2));
    }
}

/*
 * Fit all signals (weighted sums of the readings) with the present frequencies and damping ratios
 * of the vibration modes.
 *   with_slopes in   whether to compute the normal equations of a refinement step, too
 *   normal      out  sums of squares and normal equations
 */
static void assemble(const fit *fit, bool with_slopes, normal *normal)
{
    double triangle[BASIS][BASIS], coefficient[BASIS];
    memset(normal, 0, sizeof *normal);
    for (size_t index = 0; index < fit->intervals; index++) {
        const interval *interval = &fit->interval[index];
        fill_functions(fit, interval, triangle);
        if (with_slopes)
            fill_slopes(fit, interval);
        for (size_t channel = 0; channel < fit->channels; channel++) {
            memcpy(fit->column, fit->signal + channel * fit->samples->count + interval->first,
                   interval->count * sizeof *fit->column);
            fit_signal(fit, interval->count, triangle, fit->column, coefficient);
            add_energy(fit, interval->count, coefficient, normal);
            if (with_slopes)
                add_signal(fit, interval->count, fit->column, coefficient, normal);
            else
                normal->squares +=
                    pzs_linalg_inner(fit->column, fit->column, (uint32_t)interval->count);
            normal->values += interval->count - (size_t)(2 * fit->modes + 1);
        }
    }
    for (int k = 0; k < 2 * fit->modes; k++)
        for (int j = 0; j < k; j++)
            normal->matrix[j * PARAMETERS + k] = normal->matrix[k * PARAMETERS + j];
}

/*
 * Change frequencies and damping ratios by a step of their refinement, within the range that
 * vibration modes can have.
 *   inverse [PARAMETERS][PARAMETERS] in  inverse of the matrix of the normal equations, with two
 *       unknowns (frequency and damping ratio) for each mode
 */
static void take_step(fit *fit, const normal *normal, const double *inverse)
{
    const int parameters = 2 * fit->modes;
    for (int k = 0; k < parameters; k++) {
        double step = 0;
        for (int j = 0; j < parameters; j++)
            step += inverse[k * PARAMETERS + j] * normal->right[j];
        const int mode = k / 2;
        if (k % 2 == 0)
            fit->frequency[mode] *= 1 + fmax(fmin(step / fit->frequency[mode], 0.1), -0.1);
        else
            fit->damping[mode] = fmin(fmax(fit->damping[mode] + step, 1e-6), largest_damping);
    }
}

/*
 * Refine frequencies and damping ratios by least squares over all signals: Gauss-Newton steps with
 * the damping of Levenberg and Marquardt, in which the coefficients of cosine and sine are
 * eliminated. Returns the sum of the squares that the fit leaves.
 */
static double refine(fit *fit, int rounds)
{
    normal now, next;
    double inverse[PARAMETERS * PARAMETERS], damping = 1e-3;
    assemble(fit, true, &now);
    for (int round = 0; round < rounds && damping < 1e6; round++) {
        const struct fit before = *fit;
        memcpy(inverse, now.matrix, sizeof inverse);
        for (int k = 0; k < 2 * fit->modes; k++)
            inverse[k * PARAMETERS + k] *= 1 + damping;
        const bool is_solved = invert(inverse, 2 * fit->modes, PARAMETERS) == 0;
        if (is_solved)
            take_step(fit, &now, inverse);
        assemble(fit, true, &next);
        if (is_solved && next.squares < now.squares) {
            const bool is_done = next.squares > now.squares * (1 - 1e-10);
            now = next;
            damping /= 10;
            if (is_done)
                break;
        } else {
            *fit = before;
            damping *= 10;
        }
    }
    return now.squares;
}

/* ---- first estimates --------------------------------------------------------- */

/*
 * Compute the covariance of the signals of all channels (weighted sums of the readings), each also
 * delayed by 1 to blocks - 1 times the lag.
 *   lag                 in   delay (samples)
 *   matrix [size][size] out  covariance, with size = channels times blocks
 */
static void fill_covariance(const fit *fit, size_t lag, double *matrix)
{
    const size_t size = fit->channels * fit->blocks, count = fit->samples->count;
    memset(matrix, 0, size * size * sizeof *matrix);
    for (size_t index = 0; index < fit->intervals; index++) {
        const interval *interval = &fit->interval[index];
        const size_t window = (fit->blocks - 1) * lag;
        if (interval->count < 2 * window)
            continue;
        for (size_t row = 0; row < size; row++)
            for (size_t column = 0; column <= row; column++)
                matrix[row * size + column] +=
                    pzs_linalg_inner(fit->signal + row % fit->channels * count + interval->first +
                                         row / fit->channels * lag,
                                     fit->signal + column % fit->channels * count +
                                         interval->first + column / fit->channels * lag,
                                     (uint32_t)(interval->count - window));
    }
    for (size_t row = 0; row < size; row++)
        for (size_t column = 0; column < row; column++)
            matrix[column * size + row] = matrix[row * size + column];
}

/*
 * Index of the largest diagonal entry of a square matrix among the entries that are not yet marked
 * as taken.
 */
static size_t next_largest(const double *matrix, size_t size, const bool *is_taken)
{
    size_t best = size;
    for (size_t k = 0; k < size; k++)
        if (!is_taken[k] && (best == size || matrix[k * size + k] > matrix[best * size + best]))
            best = k;
    return best;
}

/*
 * Find the matrix X whose eigenvalues give the frequencies and damping ratios of the vibration
 * modes (subspace method ESPRIT): the least-squares solution of
 *   U X = V.
 *   U, V  dominant eigenvectors of the covariance, as columns, without the rows of the last delay
 *       (U) and of the first delay (V)
 *   matrix [size][size]  in/out  covariance of vectors with one sample of each channel for each
 *       delay; overwritten
 *   vector [size][size]  out     work array: eigenvectors of the covariance
 *   shift [ROOTS][ROOTS] out     the matrix X, which advances vibration by one delay
 * Returns the number of eigenvectors used, or 0 where X is not determined.
 */
static size_t shift_matrix(const fit *fit, double *matrix, double *vector, double *shift,
                           size_t wanted)
{
    const size_t size = fit->channels * fit->blocks, rows = fit->channels * (fit->blocks - 1);
    const size_t rank = wanted < rows ? wanted : rows;
    bool is_taken[CHANNELS * BLOCKS] = {false};
    size_t column[ROOTS];
    double gram[ROOTS * ROOTS], product[ROOTS * ROOTS];
    pzs_eigen_symmetric(matrix, vector, size, SWEEPS, 0);
    for (size_t k = 0; k < rank; k++) {
        column[k] = next_largest(matrix, size, is_taken);
        is_taken[column[k]] = true;
    }
    for (size_t i = 0; i < rank; i++)
        for (size_t j = 0; j < rank; j++) {
            gram[i * ROOTS + j] = product[i * ROOTS + j] = 0;
            for (size_t row = 0; row < rows; row++) {
                const double own = vector[row * size + column[i]];
                gram[i * ROOTS + j] += own * vector[row * size + column[j]];
                product[i * ROOTS + j] += own * vector[(row + fit->channels) * size + column[j]];
            }
        }
    if (invert(gram, (int)rank, ROOTS) < 0)
        return 0;
    for (size_t i = 0; i < rank; i++)
        for (size_t j = 0; j < rank; j++) {
            shift[i * ROOTS + j] = 0;
            for (size_t k = 0; k < rank; k++)
                shift[i * ROOTS + j] += gram[i * ROOTS + k] * product[k * ROOTS + j];
        }
    return rank;
}

/*
 * Trace of the inverse of (matrix - root times identity), by Gauss-Jordan elimination with row
 * exchanges. It is the logarithmic derivative of the characteristic polynomial, by which the
 * estimate `root` of an eigenvalue is improved.
 */
static double complex inverse_trace(const double *matrix, size_t rank, double complex root)
{
    double complex work[ROOTS][2 * ROOTS], trace = 0;
    for (size_t i = 0; i < rank; i++)
        for (size_t j = 0; j < rank; j++) {
            work[i][j] = matrix[i * ROOTS + j] - (i == j ? root : 0);
            work[i][rank + j] = i == j;
        }
    for (size_t step = 0; step < rank; step++) {
        size_t best = step;
        for (size_t i = step + 1; i < rank; i++)
            best = cabs(work[i][step]) > cabs(work[best][step]) ? i : best;
        for (size_t j = 0; j < 2 * rank; j++) {
            const double complex swapped = work[step][j];
            work[step][j] = work[best][j];
            work[best][j] = swapped;
        }
        const double complex pivot = cabs(work[step][step]) > 1e-300 ? work[step][step] : 1e-300;
        for (size_t j = 0; j < 2 * rank; j++)
            work[step][j] /= pivot;
        for (size_t i = 0; i < rank; i++) {
            const double complex factor = work[i][step];
            for (size_t j = 0; j < 2 * rank && i != step; j++)
                work[i][j] -= factor * work[step][j];
        }
    }
    for (size_t i = 0; i < rank; i++)
        trace += work[i][rank + i];
    return trace;
}

/*
 * Compute the eigenvalues of a matrix by the method of Aberth and Ehrlich, which improves all
 * estimates together and keeps any two of them apart.
 *   matrix [rank][ROOTS] in   the matrix
 *   root [rank]          out  eigenvalues
 */
static void find_roots(const double *matrix, size_t rank, double complex *root)
{
    double moved = 1;
    for (size_t k = 0; k < rank; k++)
        root[k] = 0.9 * cexp((double complex)I * (two_pi * (double)k / (double)rank + 0.4));
    for (int round = 0; round < ROOT_ROUNDS && moved > 1e-12; round++) {
        moved = 0;
        for (size_t k = 0; k < rank; k++) {
            double complex repelled = -inverse_trace(matrix, rank, root[k]);
            for (size_t j = 0; j < rank; j++)
                if (j != k)
                    repelled -= 1 / (root[k] - root[j]);
            const double complex step = 1 / repelled;
            if (!isfinite(cabs(step)))
                continue;
            root[k] -= step;
            moved = fmax(moved, cabs(step));
        }
    }
}

/*
 * Convert the eigenvalues of the matrix that advances free vibration by one lag (shift_matrix) into
 * frequencies and damping ratios. Keep those that vibration modes can have, up to the largest
 * number of modes (IDENTIFIED_MODES).
 *   lag in  time by which the matrix advances vibration (samples)
 */
static void take_roots(fit *fit, const double complex *root, size_t rank, size_t lag)
{
    const double lowest = 2 * two_pi * fit->rate / (double)fit->longest;
    fit->modes = 0;
    for (size_t k = 0; k < rank && fit->modes < IDENTIFIED_MODES; k++) {
        const double complex pole = clog(root[k]) * fit->rate / (double)lag;
        const double frequency = cabs(pole), damping = -creal(pole) / frequency;
        if (!(cimag(pole) > 0) || !(frequency > lowest) || !(damping < largest_damping) ||
            !(damping > -0.1))
            continue;
        fit->frequency[fit->modes] = frequency;
        fit->damping[fit->modes++] = fmax(damping, 1e-4);
    }
}

static void remove_mode(fit *fit, int mode)
{
    fit->modes--;
    for (int k = mode; k < fit->modes; k++) {
        fit->frequency[k] = fit->frequency[k + 1];
        fit->damping[k] = fit->damping[k + 1];
    }
}

/*
 * Remove the vibration modes with the least energy in the readings until at most `most` modes are
 * left.
 */
static void keep_strongest(fit *fit, int most)
{
    normal normal;
    while (fit->modes > most) {
        int weakest = 0;
        assemble(fit, false, &normal);
        for (int k = 1; k < fit->modes; k++)
            weakest = normal.energy[k] < normal.energy[weakest] ? k : weakest;
        remove_mode(fit, weakest);
    }
}

/*
 * Estimate the vibration modes by a subspace method from vectors of samples at several equal
 * spacings (lags). Each estimate is refined by nonlinear least squares, and the one that fits the
 * signals best is kept. Returns whether memory sufficed.
 */
static bool estimate(fit *fit, int most)
{
    static const size_t lags[] = {1, 2, 4, 8, 16, 32};
    const size_t size = fit->channels * fit->blocks;
    struct fit best = *fit;
    double least = HUGE_VAL, shift[ROOTS * ROOTS];
    double complex root[ROOTS];
    double *matrix = calloc(2 * size * size, sizeof *matrix);
    for (size_t k = 0; k < sizeof lags / sizeof *lags && matrix; k++) {
        if (2 * (fit->blocks - 1) * lags[k] >= fit->longest)
            break;
        fill_covariance(fit, lags[k], matrix);
        const size_t rank =
            shift_matrix(fit, matrix, matrix + size * size, shift, (size_t)(2 * most + SPARE));
        find_roots(shift, rank, root);
        take_roots(fit, root, rank, lags[k]);
        keep_strongest(fit, most);
        const double squares = refine(fit, REFINEMENTS / 3);
        if (fit->modes > 0 && squares < least) {
            least = squares;
            best = *fit;
        }
    }
    *fit = best;
    free(matrix);
    return matrix != NULL;
}

/* ---- result -------------------------------------------------------------------- */

/*
 * Remove vibration modes that the noise hides, and refine frequencies and damping ratios of the
 * others again.
 *   inverse [PARAMETERS][PARAMETERS] out  inverse of the matrix of the normal equations after the
 *                                         last refinement
 */
static void keep_significant(fit *fit, normal *normal, double *inverse)
{
    for (bool has_changed = true; has_changed;) {
        has_changed = false;
        (void)refine(fit, REFINEMENTS);
        assemble(fit, true, normal);
        memcpy(inverse, normal->matrix, sizeof normal->matrix);
        const bool is_solved = invert(inverse, 2 * fit->modes, PARAMETERS) == 0;
        const double variance = normal->squares / (double)normal->values,
                     chance = 2 * variance * (double)(fit->channels * fit->intervals);
        for (int k = fit->modes - 1; k >= 0 && !has_changed; k--) {
            const double error =
                is_solved ? sqrt(variance * inverse[2 * k * (PARAMETERS + 1)]) : HUGE_VAL;
            has_changed = normal->energy[k] < significant * chance ||
                          !(error < largest_error * fit->frequency[k]) ||
                          fit->frequency[k] > most_turn * fit->rate * two_pi / 2 ||
                          fit->damping[k] >= largest_damping;
            if (has_changed)
                remove_mode(fit, k);
        }
    }
}

/*
 * Remove a mode beside another one of almost the same frequency, where the other one alone fits the
 * readings as well but for noise. Returns whether a mode was removed.
 *   squares in  sum of the squares that all modes leave
 *   chance  in  squares that noise alone gives a mode
 */
static bool merge_neighbours(fit *fit, double squares, double chance)
{
    for (int k = 0; k < fit->modes; k++)
        for (int other = 0; other < fit->modes; other++) {
            struct fit alone = *fit;
            const double apart = fabs(fit->frequency[k] - fit->frequency[other]);
            if (other == k || !(apart < near * fit->frequency[k]))
                continue;
            remove_mode(&alone, k);
            if (!(refine(&alone, REFINEMENTS) < squares + significant * chance))
                continue;
            *fit = alone;
            return true;
        }
    return false;
}

/* Remove modes until none is hidden by noise, and none is another one a second time. */
static void keep_distinct(fit *fit, normal *normal, double *inverse)
{
    for (bool has_changed = true; has_changed;) {
        keep_significant(fit, normal, inverse);
        const double chance =
            2 * normal->squares / (double)normal->values * (double)(fit->channels * fit->intervals);
        has_changed = merge_neighbours(fit, normal->squares, chance);
    }
}

static void sort_modes(fit *fit)
{
    for (int i = 1; i < fit->modes; i++)
        for (int k = i; k > 0 && fit->frequency[k] < fit->frequency[k - 1]; k--) {
            const double frequency = fit->frequency[k], damping = fit->damping[k];
            fit->frequency[k] = fit->frequency[k - 1];
            fit->damping[k] = fit->damping[k - 1];
            fit->frequency[k - 1] = frequency;
            fit->damping[k - 1] = damping;
        }
}

/*
 * Fit the readings of every output, and store the coefficients of the vibration modes' decaying
 * cosines and sines in every interval of constant voltages.
 *   part [modes][outputs][2 intervals] out  coefficients (unit of the readings)
 */
static void fill_parts(const fit *fit, double *part)
{
    const size_t outputs = fit->samples->outputs, columns = 2 * fit->intervals;
    double triangle[BASIS][BASIS], coefficient[BASIS];
    for (size_t index = 0; index < fit->intervals; index++) {
        const interval *interval = &fit->interval[index];
        fill_functions(fit, interval, triangle);
        for (size_t output = 0; output < outputs; output++) {
            for (size_t i = 0; i < interval->count; i++)
                fit->column[i] = fit->samples->shape[(interval->first + i) * outputs + output];
            fit_signal(fit, interval->count, triangle, fit->column, coefficient);
            for (size_t mode = 0; mode < (size_t)fit->modes; mode++)
                for (size_t k = 0; k < 2; k++)
                    part[(mode * outputs + output) * columns + 2 * index + k] =
                        coefficient[1 + 2 * mode + k];
        }
    }
}

/*
 * Compute the shape of a vibration mode by power iteration. The shape is the vector over the
 * outputs along which the coefficients of the mode have the largest sum of squares.
 *   part [outputs][columns] in   coefficients of the decaying cosine and sine of the mode in all
 *       intervals of constant voltages
 *   along [columns]         out  work array
 *   shape [outputs]         out  shape of the mode, with root mean square 1
 */
static void find_shape(const double *part, size_t outputs, size_t columns, double *along,
                       double *shape)
{
    for (size_t k = 0; k < columns; k++)
        along[k] = 0;
    /*
     * Start vector of the power iteration for the shape of a vibration mode: among the rows of
     * `part` (one for each output), the one with the largest norm.
     */
    for (size_t i = 0; i < outputs; i++)
        if (pzs_linalg_inner(part + i * columns, part + i * columns, (uint32_t)columns) >
            pzs_linalg_inner(along, along, (uint32_t)columns))
            memcpy(along, part + i * columns, columns * sizeof *along);
    for (int round = 0; round < SHAPE_ROUNDS; round++) {
        for (size_t i = 0; i < outputs; i++)
            shape[i] = pzs_linalg_inner(part + i * columns, along, (uint32_t)columns);
        const double size =
            sqrt(pzs_linalg_inner(shape, shape, (uint32_t)outputs) / (double)outputs);
        for (size_t k = 0; k < columns; k++)
            along[k] = 0;
        for (size_t i = 0; i < outputs; i++) {
            shape[i] = size > 0 ? shape[i] / size : 0;
            add(along, part + i * columns, shape[i], columns);
        }
    }
}

/*
 * Remove a shape from the coefficients of a mode.
 *   part [outputs][columns] in/out  coefficients of the mode
 *   shape [outputs]         in      shape of the mode, with root mean square 1
 */
static void remove_shape(double *part, size_t outputs, size_t columns, const double *shape)
{
    for (size_t k = 0; k < columns; k++) {
        double along = 0;
        for (size_t i = 0; i < outputs; i++)
            along += shape[i] * part[i * columns + k] / (double)outputs;
        for (size_t i = 0; i < outputs; i++)
            part[i * columns + k] -= along * shape[i];
    }
}

/* Sum of the squares of a mode's coefficients along a shape. */
static double squares_along(const double *part, size_t outputs, size_t columns, const double *shape)
{
    double sum = 0;
    for (size_t k = 0; k < columns; k++) {
        double along = 0;
        for (size_t i = 0; i < outputs; i++)
            along += shape[i] * part[i * columns + k];
        sum += along * along / (double)outputs;
    }
    return sum;
}

/*
 * Find a second shape in the coefficients of a mode, which vibrates with the same frequency and
 * damping, as the modes of a round mirror do in pairs. Returns whether there is one.
 *   energy           in   energy of the mode in the readings, over that which noise alone gives it
 *   part   [outputs][columns] in   coefficients of the mode
 *   shape  [outputs] in   shape of the mode
 *   rest   [outputs][columns] out  coefficients without this shape
 *   along  [columns] out  work array
 *   second [outputs] out  second shape
 */
static bool find_twin(double energy, const double *part, const double *shape, size_t outputs,
                      size_t columns, double *rest, double *along, double *second)
{
    memcpy(rest, part, outputs * columns * sizeof *rest);
    remove_shape(rest, outputs, columns, shape);
    find_shape(rest, outputs, columns, along, second);
    const double first = squares_along(part, outputs, columns, shape),
                 other = squares_along(rest, outputs, columns, second);
    return other > second_shape * second_shape * first &&
           energy * other / (first + other) > significant;
}

/*
 * Compute the complex amplitudes of the free vibration of all vibration modes in all intervals of
 * constant voltages, and from these the static responses to the voltages.
 *   part [modes][outputs][2 intervals] in  coefficients of cosine and sine of the modes
 * Returns 0, or -1 with error filled.
 */
static int find_responses(identified_modes *result, const fit *fit, const double *part, char *error)
{
    const size_t modes = (size_t)result->modes, outputs = fit->samples->outputs,
                 intervals = fit->intervals;
    double angular[2 * IDENTIFIED_MODES];
    size_t *ends = calloc(2 * intervals + 1, sizeof *ends);
    double complex *amplitude = calloc(modes * intervals + 1, sizeof *amplitude);
    for (size_t i = 0; i < intervals && ends; i++) {
        ends[i] = fit->interval[i].first;
        ends[intervals + i] = fit->interval[i].first + fit->interval[i].count;
    }
    for (size_t row = 0; row < modes * outputs && amplitude; row++)
        for (size_t i = 0; i < intervals; i++)
            amplitude[row / outputs * intervals + i] +=
                result->shape[row] / (double)outputs *
                (part[(row * intervals + i) * 2] -
                 part[(row * intervals + i) * 2 + 1] * (double complex)I);
    for (size_t k = 0; k < modes; k++)
        angular[k] = two_pi * result->frequency[k];
    const free_vibration record = {.samples = fit->samples,
                                   .modes = modes,
                                   .frequency = angular,
                                   .damping = result->damping,
                                   .rate = fit->rate,
                                   .intervals = intervals,
                                   .skipped = SKIPPED,
                                   .first = ends,
                                   .behind = ends + intervals,
                                   .amplitude = amplitude};
    const bool is_done = ends && amplitude && identify_responses(&result->responses, &record);
    free(ends);
    free(amplitude);
    return is_done ? 0 : refuse(error, "out of memory");
}

/* Allocate the arrays of the result for twice the modes of the fit. Returns whether it worked. */
static bool open_result(identified_modes *result, const fit *fit)
{
    const size_t room = 2 * (size_t)fit->modes;
    result->frequency = calloc(room * (4 + fit->samples->outputs) + 1, sizeof *result->frequency);
    result->damping = result->frequency + room;
    result->frequency_error = result->damping + room;
    result->damping_error = result->frequency_error + room;
    result->shape = result->damping_error + room;
    return result->frequency != NULL;
}

/* Whether another mode of the fit has almost the frequency of mode k. */
static bool has_neighbour(const fit *fit, size_t k)
{
    for (size_t other = 0; other < (size_t)fit->modes; other++)
        if (other != k &&
            fabs(fit->frequency[k] - fit->frequency[other]) < near * fit->frequency[k])
            return true;
    return false;
}

/* Store frequency and damping of mode k of the fit as the next mode of the result. */
static void add_mode(identified_modes *result, const fit *fit, size_t k, double variance,
                     const double *inverse)
{
    const int next = result->modes++;
    result->frequency[next] = fit->frequency[k] / two_pi;
    result->damping[next] = fit->damping[k];
    result->frequency_error[next] = sqrt(variance * inverse[2 * k * (PARAMETERS + 1)]) / two_pi;
    result->damping_error[next] = sqrt(variance * inverse[(2 * k + 1) * (PARAMETERS + 1)]);
}

/*
 * Fill the result with all modes, those of equal frequency one after the other.
 *   part [modes][outputs][columns] in   coefficients of the modes of the fit
 *   own  [2 modes][outputs][columns] out  coefficients of the modes of the result
 *   along [columns]                out  work array
 */
static void fill_modes(identified_modes *result, const fit *fit, const normal *normal,
                       const double *inverse, const double *part, double *own, double *along)
{
    const size_t outputs = fit->samples->outputs, columns = 2 * fit->intervals,
                 entries = outputs * columns;
    const double variance = normal->squares / (double)normal->values,
                 chance = 2 * variance * (double)(fit->channels * fit->intervals);
    for (size_t k = 0; k < (size_t)fit->modes; k++) {
        const size_t next = (size_t)result->modes;
        double *shape = result->shape + next * outputs;
        memcpy(own + next * entries, part + k * entries, entries * sizeof *own);
        find_shape(part + k * entries, outputs, columns, along, shape);
        add_mode(result, fit, k, variance, inverse);
        if (has_neighbour(fit, k) ||
            !find_twin(normal->energy[k] / chance, part + k * entries, shape, outputs, columns,
                       own + (next + 1) * entries, along, shape + outputs))
            continue;
        result->twins++;
        add_mode(result, fit, k, variance, inverse);
    }
}

static int take_result(identified_modes *result, fit *fit, const normal *normal,
                       const double *inverse, char *error)
{
    const size_t modes = (size_t)fit->modes, columns = 2 * fit->intervals,
                 entries = fit->samples->outputs * columns;
    double *part = calloc((3 * modes + 1) * entries + columns + 1, sizeof *part);
    if (!open_result(result, fit) || !part) {
        free(part);
        return refuse(error, "out of memory");
    }
    double energy = 0;
    for (size_t k = 0; k < modes; k++)
        energy += normal->energy[k];
    result->steps = (int)fit->intervals;
    result->noise = sqrt(normal->squares / (double)normal->values);
    result->left = sqrt(normal->squares / energy);
    fill_parts(fit, part);
    double *own = part + modes * entries;
    fill_modes(result, fit, normal, inverse, part, own, own + (2 * modes + 1) * entries);
    const int failed = find_responses(result, fit, own, error);
    free(part);
    return failed;
}

static bool take_memory(fit *fit)
{
    const size_t count = fit->samples->count, outputs = fit->samples->outputs;
    fit->channels = outputs < CHANNELS ? outputs : CHANNELS;
    fit->blocks = LEAST_ROWS / fit->channels + 1;
    fit->blocks = fit->blocks > BLOCKS ? fit->blocks : BLOCKS;
    fit->mixer = calloc(fit->channels * outputs, sizeof *fit->mixer);
    fit->signal = calloc(fit->channels * count, sizeof *fit->signal);
    fit->function = calloc((BASIS + PARAMETERS) * fit->longest, sizeof *fit->function);
    fit->slope = calloc(2 * PARAMETERS * fit->longest, sizeof *fit->slope);
    fit->column = calloc(fit->longest, sizeof *fit->column);
    return fit->mixer && fit->signal && fit->function && fit->slope && fit->column;
}

/*
 * Lowest and highest frequency at which structures vibrate (Hz). If a record can only show
 * frequencies outside this range, the user has stated a wrong sampling rate.
 */
static const double slowest = 1e-3, fastest = 1e7;

/*
 * Determine the range of frequencies that the record of voltages and sensor readings can show, from
 * its length and its sampling rate. Returns 0, or -1 with error filled where the frequencies of
 * real structures lie outside this range.
 */
static int check_range(const fit *fit, identified_modes *result, char *error)
{
    result->shown[0] = 2 * fit->rate / (double)fit->longest;
    result->shown[1] = fit->rate / 2;
    if (result->shown[1] > slowest && result->shown[0] < fastest)
        return 0;
    snprintf(error, SCENE_ERROR,
             "--vibration %g: with %g samples a second voltages held for at most %zu samples show "
             "vibration from %.3g to %.3g Hz, and structures vibrate between %g and %g Hz; write "
             "the samples a second of the record",
             fit->rate, fit->rate, fit->longest, result->shown[0], result->shown[1], slowest,
             fastest);
    return -1;
}

static int run(fit *fit, identified_modes *result, int most, char *error)
{
    normal normal;
    double inverse[PARAMETERS * PARAMETERS];
    list_intervals(fit);
    if (fit->intervals == 0)
        return refuse(error, "no interval of constant voltages has more than 40 samples; step the "
                             "voltages and hold them for several periods of the lowest mode");
    if (check_range(fit, result, error) < 0)
        return -1;
    if (!take_memory(fit) || !choose_channels(fit) || !estimate(fit, most))
        return refuse(error, "out of memory");
    keep_distinct(fit, &normal, inverse);
    if (fit->modes == 0)
        return refuse(error, "no vibration stands out from the noise; step the voltages further, "
                             "and hold them for several periods of the lowest mode");
    sort_modes(fit);
    assemble(fit, true, &normal);
    memcpy(inverse, normal.matrix, sizeof inverse);
    (void)invert(inverse, 2 * fit->modes, PARAMETERS);
    return take_result(result, fit, &normal, inverse, error);
}

int identify_modes(identified_modes *result, const pokes *samples, double rate, int most,
                   char *error)
{
    fit fit = {.samples = samples, .rate = rate};
    memset(result, 0, sizeof *result);
    if (most < 1 || most > IDENTIFIED_MODES) {
        snprintf(error, SCENE_ERROR, "%d modes are out of range (1 to %d)", most, IDENTIFIED_MODES);
        return -1;
    }
    fit.interval = calloc(samples->count / LEAST_SAMPLES + 1, sizeof *fit.interval);
    const int failed =
        fit.interval ? run(&fit, result, most, error) : refuse(error, "out of memory");
    free(fit.interval);
    free(fit.mixer);
    free(fit.signal);
    free(fit.function);
    free(fit.slope);
    free(fit.column);
    return failed;
}

void identified_modes_free(identified_modes *result)
{
    free(result->frequency);
    mode_responses_free(&result->responses);
    memset(result, 0, sizeof *result);
}
