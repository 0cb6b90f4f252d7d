/* SPDX-License-Identifier: BSD-2-Clause */
/* Identification of the static responses of vibration modes (identify_responses.h). */
#include "identify_responses.h"
#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../mesh/invert.h"

enum {
    TRIED = 400,    /* number of trial values of the delay with which the voltages act */
    NARROWINGS = 60 /* number of steps that narrow the interval around the delay of the voltages
                       that fits the record best */
};

static const double quarter_turn = 1.5707963267948966; /* phase angle of a quarter of a period of
                                                          vibration (rad) */

/*
 * Threshold for the pivots of the normal matrix of the voltage steps, scaled to diagonal entries of
 * 1. If a pivot is not larger, the record has no independent steps of all actuators, and their
 * responses cannot be distinguished.
 */
static const double independent = 1e-6;

/*
 * Largest part of the free vibration after voltage steps that the fitted static responses may leave
 * unexplained, relative to the whole (root mean square).
 */
static const double most_left = 0.2;

/*
 * Voltage steps of a record of voltages and readings, and the free vibration that each step adds.
 */
typedef struct steps {
    mode_responses *result;
    const free_vibration *record;
    size_t count, actuators;
    size_t *interval; /* [count] number of the interval of constant voltages that each step begins
                       */
    double *voltage;  /* [count][actuators] change of each voltage in each step (V) */
    double *inverse;  /* [actuators][actuators] inverse of the normal matrix of the voltage steps
                         (1/V^2) */
    double *value; /* [count] work vector: change of the static value of a modal coordinate in each
                      voltage step */
    double *projected; /* [2][actuators] work vectors of the least-squares fit of static responses
                        */
} steps;

/* ---- voltage steps -------------------------------------------------------- */

/*
 * List the steps between two intervals of constant voltages that follow each other without a gap.
 */
static void list_steps(steps *steps)
{
    const free_vibration *record = steps->record;
    const size_t actuators = steps->actuators;
    for (size_t i = 1; i < record->intervals; i++) {
        if (record->first[i] != record->behind[i - 1] + record->skipped)
            continue;
        const double *after = record->samples->voltage + record->first[i] * actuators,
                     *before = record->samples->voltage + record->first[i - 1] * actuators;
        for (size_t k = 0; k < actuators; k++)
            steps->voltage[steps->count * actuators + k] = after[k] - before[k];
        steps->interval[steps->count++] = i;
    }
}

/*
 * Find the first actuator whose voltage steps are a linear combination of those of the actuators
 * before it. The test is Cholesky's method on the normal matrix of the steps, scaled to a diagonal
 * of 1.
 *   factor [actuators][actuators] work
 * Returns the number of actuators if there is none.
 */
static size_t find_dependent(const steps *steps, double *factor)
{
    const size_t n = steps->actuators;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++) {
            const double scale = sqrt(steps->inverse[i * (n + 1)] * steps->inverse[j * (n + 1)]);
            double sum = scale > 0 ? steps->inverse[i * n + j] / scale : 0;
            for (size_t k = 0; k < j; k++)
                sum -= factor[i * n + k] * factor[j * n + k];
            if (i == j && !(sum > independent))
                return i;
            factor[i * n + j] = i == j ? sqrt(sum) : sum / factor[j * (n + 1)];
        }
    return n;
}

/*
 * Compute the inverse of the normal matrix of the voltage steps. Returns whether the steps move all
 * actuators independently; if not, the member `reason` of the result is filled.
 */
static bool invert_steps(steps *steps, double *factor)
{
    const size_t n = steps->actuators;
    for (size_t step = 0; step < steps->count; step++)
        for (size_t i = 0; i < n; i++)
            for (size_t j = 0; j < n; j++)
                steps->inverse[i * n + j] +=
                    steps->voltage[step * n + i] * steps->voltage[step * n + j];
    const size_t dependent = find_dependent(steps, factor);
    if (dependent < n)
        snprintf(steps->result->reason, sizeof steps->result->reason,
                 "the %zu steps between held voltages do not move column %zu of the voltages "
                 "independently of the columns before it; step each actuator",
                 steps->count, dependent + 1);
    return dependent == n && invert(steps->inverse, (int)n, (int)n) == 0;
}

/* ---- responses ------------------------------------------------------------ */

/*
 * Compute by how much each voltage step changes the static value of a mode's coordinate: minus the
 * jump of the free vibration, because the coordinate itself does not jump. The changes are real if
 * the assumed delay is right.
 *   delay in          assumed delay with which the voltages act (samples)
 *   value [count] out  real parts of the changes (multiples of the mode's shape)
 *   total in/out      sum to which the squared absolute values of the changes are added
 * Returns the sum of the squares of the imaginary parts.
 */
static double static_values(const steps *steps, size_t mode, double delay, double *value,
                            double *total)
{
    const free_vibration *record = steps->record;
    const double ratio = record->damping[mode], natural = record->frequency[mode],
                 damped = natural * sqrt(1 - ratio * ratio);
    const double complex pole = (-ratio * natural + damped * (double complex)I) / record->rate;
    const double complex begin = (1 - ratio * natural / damped * (double complex)I) *
                                 cexp(pole * ((double)record->skipped - delay));
    const double complex *amplitude = record->amplitude + mode * record->intervals;
    double squares = 0;
    for (size_t step = 0; step < steps->count; step++) {
        const size_t i = steps->interval[step];
        const double samples = (double)(record->first[i] - record->first[i - 1]);
        const double complex jump = amplitude[i] - amplitude[i - 1] * cexp(pole * samples);
        const double complex moved = -jump / begin;
        value[step] = creal(moved);
        squares += pow(cimag(moved), 2);
        *total += pow(cabs(moved), 2);
    }
    return squares;
}

/*
 * Fit the static responses of one vibration mode to the voltages by least squares. Fitted are the
 * changes of the mode's static coordinate in all voltage steps.
 *   response [actuators] out  static responses (multiples of the mode's shape per volt)
 * Returns the sum of the squares that the fit leaves.
 */
static double fit_response(const steps *steps, double *response)
{
    const size_t n = steps->actuators;
    double squares = 0;
    for (size_t j = 0; j < n; j++) {
        steps->projected[j] = 0;
        for (size_t step = 0; step < steps->count; step++)
            steps->projected[j] += steps->voltage[step * n + j] * steps->value[step];
    }
    for (size_t i = 0; i < n; i++) {
        response[i] = 0;
        for (size_t j = 0; j < n; j++)
            response[i] += steps->inverse[i * n + j] * steps->projected[j];
    }
    for (size_t step = 0; step < steps->count; step++) {
        double left = steps->value[step];
        for (size_t j = 0; j < n; j++)
            left -= steps->voltage[step * n + j] * response[j];
        squares += left * left;
    }
    return squares;
}

/*
 * Return how badly static responses fit a record, for an assumed delay (samples). Each voltage step
 * changes the static coordinate of each vibration mode. These changes are computed as complex
 * numbers from the free vibration; at the right delay they are real, and linear in the voltages.
 * The result is (squared residuals of the linear fit + squared imaginary parts) / (squared
 * changes), summed over steps and modes.
 *   squares  out  the numerator (multiples of the mode shapes, squared)
 */
static double unexplained(const steps *steps, double delay, double *squares)
{
    double total = 0;
    *squares = 0;
    for (size_t mode = 0; mode < steps->record->modes; mode++) {
        *squares += static_values(steps, mode, delay, steps->value, &total);
        *squares += fit_response(steps, steps->projected + steps->actuators);
    }
    return total > 0 ? *squares / total : 1;
}

/*
 * Return the delay with which the voltages act (samples) that best explains the jumps of the free
 * vibration at the voltage steps, from one sample early to a quarter of a period of the lowest mode
 * late. With a longer delay the sign of a single mode would be unknown.
 */
static double find_delay(const steps *steps)
{
    const double quarter = quarter_turn * steps->record->rate / steps->record->frequency[0];
    const double earliest = -fmin(1, quarter), width = (quarter - earliest) / TRIED;
    double best = earliest, least = HUGE_VAL, squares;
    for (int k = 0; k <= TRIED; k++) {
        const double left = unexplained(steps, earliest + k * width, &squares);
        if (left < least) {
            least = left;
            best = earliest + k * width;
        }
    }
    double from = best - width, to = best + width;
    for (int k = 0; k < NARROWINGS; k++) {
        const double third = (to - from) / 3;
        if (unexplained(steps, from + third, &squares) < unexplained(steps, to - third, &squares))
            to -= third;
        else
            from += third;
    }
    return (from + to) / 2;
}

/*
 * Compute the static responses of all vibration modes to the voltages, their standard errors, and
 * the delay with which the voltages act.
 */
static void fill_responses(const steps *steps)
{
    mode_responses *result = steps->result;
    const size_t n = steps->actuators, count = steps->record->modes;
    double squares, total = 0;
    const double delay = find_delay(steps), left = sqrt(unexplained(steps, delay, &squares));
    if (!(left <= most_left)) {
        snprintf(
            result->reason, sizeof result->reason,
            "%.0f%% of the vibration does not begin with the steps of the voltages; write each "
            "voltage from the line of the sample at which it is applied (it may act up to four "
            "samples later), and keep other excitation away",
            100 * left);
        return;
    }
    const double variance =
        squares / (double)(count * (2 * steps->count - n > 1 ? 2 * steps->count - n : 1));
    for (size_t mode = 0; mode < count; mode++) {
        (void)static_values(steps, mode, delay, steps->value, &total);
        (void)fit_response(steps, result->value + mode * n);
        for (size_t i = 0; i < n; i++)
            result->error[mode * n + i] = sqrt(variance * steps->inverse[i * (n + 1)]);
    }
    result->is_found = true;
    result->delay = delay / steps->record->rate;
}

bool identify_responses(mode_responses *result, const free_vibration *record)
{
    const size_t n = record->samples->actuators, intervals = record->intervals;
    steps steps = {.result = result, .record = record, .actuators = n};
    steps.interval = calloc(intervals + 1, sizeof *steps.interval);
    steps.voltage = calloc((intervals + 2 * n + 2) * (n + 1) + intervals, sizeof *steps.voltage);
    result->value = calloc(2 * record->modes * n + 1, sizeof *result->value);
    const bool has_memory = steps.interval && steps.voltage && result->value;
    if (has_memory) {
        result->error = result->value + record->modes * n;
        steps.inverse = steps.voltage + intervals * n;
        double *factor = steps.inverse + n * n;
        steps.projected = factor + n * n;
        steps.value = steps.projected + 2 * n;
        list_steps(&steps);
        if (invert_steps(&steps, factor))
            fill_responses(&steps);
    }
    free(steps.interval);
    free(steps.voltage);
    return has_memory;
}

void mode_responses_free(mode_responses *result)
{
    free(result->value);
    memset(result, 0, sizeof *result);
}
